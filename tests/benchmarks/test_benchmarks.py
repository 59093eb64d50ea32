"""Every benchmark runs at toy size, and every table in a page is what its benchmark writes from the data."""

from pathlib import Path

import pytest

from benchmarks.make import main
from benchmarks.pages import pages, regions, written
from benchmarks.topics import TOPICS


@pytest.mark.parametrize("name", TOPICS)
def test_topic_runs_at_toy_size_and_writes_its_tables(name: str, tmp_path: Path) -> None:
    topic = TOPICS[name]
    folder = tmp_path / topic.folder
    folder.mkdir()
    topic.run(folder, **topic.toy)
    assert any(folder.iterdir())
    for table in topic.tables.values():
        head, rule, *_ = [line for line in table(folder).splitlines() if line.startswith("|")]
        assert head.count("|") == rule.count("|")


@pytest.mark.parametrize("page", pages(), ids=lambda page: "/".join(page.parts[-2:]))
def test_tables_of_a_page_are_those_of_the_data_files(page: Path) -> None:
    """After a change: `python benchmarks/make.py --tables`."""
    text = page.read_text(encoding="utf-8")
    assert written(text, TOPICS) == text


def test_every_table_is_shown() -> None:
    shown = {name for page in pages() for name in regions(page.read_text(encoding="utf-8"))}
    assert shown == {name for topic in TOPICS.values() for name in topic.tables}


def test_without_a_topic_all_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    main([])
    listed = capsys.readouterr().out
    assert all(name in listed and topic.shows in listed for name, topic in TOPICS.items())


def test_toy_runs_never_touch_published_results(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["geometry", "--toy"])
    assert "--toy needs --out" in capsys.readouterr().err
