"""Every benchmark runs at toy size, and every table in a page is what its benchmark writes from the data."""

from pathlib import Path

import pytest
from PIL import Image

from benchmarks.make import main
from benchmarks.pages import pages, regions, written
from benchmarks.published import origins, origins_table, recording, shrink_pictures
from benchmarks.topic import RESULTS
from benchmarks.topics import TOPICS


@pytest.mark.parametrize("name", TOPICS)
def test_topic_runs_at_toy_size_and_writes_its_tables(name: str, tmp_path: Path) -> None:
    topic = TOPICS[name]
    folder = tmp_path / topic.folder
    folder.mkdir(parents=True)
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
    assert shown == {name for topic in TOPICS.values() for name in topic.tables} | {"published"}


def test_every_published_file_has_its_origin() -> None:
    """A file that no command of the repository makes could not be checked by anyone."""
    files = {str(file.relative_to(RESULTS)) for file in RESULTS.rglob("*.*") if file.is_file()}
    texts = {file for file in files if file.endswith(".md")}
    entries = origins(RESULTS)
    assert files - texts - {"published.json"} == set(entries)
    for file, entry in entries.items():
        topic = TOPICS[str(entry["command"]).removeprefix("python benchmarks/make.py ")]
        assert file.startswith(f"{topic.folder}/")


def test_files_that_a_topic_writes_are_recorded_also_if_it_fails(tmp_path: Path) -> None:
    (tmp_path / "geometry").mkdir()
    (tmp_path / "geometry" / "older.json").write_text("{}")

    def stopped() -> None:
        with recording(tmp_path, "geometry", "geometry"):
            (tmp_path / "geometry" / "new.json").write_text("{}")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        stopped()
    assert list(origins(tmp_path)) == ["geometry/new.json"]
    assert "| geometry" in origins_table(tmp_path)


def test_published_results_stay_small() -> None:
    """Above that, a clone and a reader wait for what nobody looks at."""
    files = [file for file in RESULTS.rglob("*") if file.is_file()]
    assert sum(file.stat().st_size for file in files) < 6e6
    for file in files:
        if file.suffix == ".png":
            with Image.open(file) as picture:
                assert picture.mode == "P", f"{file.name}: `make.py` writes pictures with a palette"


def test_pictures_are_written_with_a_palette(tmp_path: Path) -> None:
    file = tmp_path / "a.png"
    Image.linear_gradient("L").convert("RGBA").resize((600, 600)).save(file)
    shrink_pictures(tmp_path)
    with Image.open(file) as picture:
        assert (picture.mode, picture.size) == ("P", (600, 600))
        assert abs(picture.convert("L").getpixel((300, 300)) - 127) < 3


def test_without_a_topic_all_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    main([])
    listed = capsys.readouterr().out
    assert all(name in listed and topic.shows in listed for name, topic in TOPICS.items())


def test_toy_runs_never_touch_published_results(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["geometry", "--toy"])
    assert "--toy needs --out" in capsys.readouterr().err
