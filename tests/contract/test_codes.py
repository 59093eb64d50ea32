"""Remarks and causes carry codes: the page lists them, files keep them, and no code reads the sentences."""

import ast
import dataclasses
import re
from collections.abc import Iterator
from pathlib import Path

import h5py
import pytest

import rps_exudyn
from reader import filled
from rps_exudyn.parameters.retired import RETIRED_CODES
from rps_exudyn.results import block
from rps_exudyn.results.block import Block, CaseRecord, packed, summaries
from rps_exudyn.results.outcome import Code, Outcome, Remark, Status
from rps_exudyn.results.result import Result, content_of, read_result
from rps_exudyn.scenes.checks.rules import met_limit
from rps_exudyn.scenes.scene_run import SceneRun

PACKAGE = Path(rps_exudyn.__file__).parent
PAGE = Path(__file__).parents[2] / "docs" / "hdf5-format.md"
READERS = {"startswith", "endswith", "find", "index", "partition", "split", "match", "search", "fullmatch"}
SPLIT = {"study/store.py", "study/runner.py", "results/block.py"}
"""Write a message on one line, or each sentence in a row of its own."""
OLD_FILES = "results/outcome.py"  # words of files that have no codes


def test_page_lists_every_code() -> None:
    text = filled(PAGE.read_text(encoding="utf-8")).split("## Codes\n")[1].split("\n#")[0]
    listed = re.findall(r"^\| `([\w-]+)` \| [^|]{10,} \|$", text, re.M)
    assert listed == [code.value for code in Code] + [*RETIRED_CODES]


@pytest.mark.parametrize("code", Code)
def test_every_code_is_used(code: Code) -> None:
    files = (path for path in PACKAGE.rglob("*.py") if path.name != "outcome.py")
    assert any(f"Code.{code.name}" in path.read_text(encoding="utf-8") for path in files)


def remarked(made_up_result: Result) -> Result:
    """Return a result with a remark and its code."""
    message = "yoke.clearance = 20 um is used up, first at 3 deg"
    return dataclasses.replace(
        made_up_result, message=message, codes=(Code.YOKE_STOPPED.value, "of-tomorrow")
    )


def test_codes_come_back_from_a_file_and_a_block(made_up_result: Result, tmp_path: Path) -> None:
    result = remarked(made_up_result)
    result.save(tmp_path / "r.h5")
    (tmp_path / "b.h5").write_bytes(packed([CaseRecord.of("a" * 16, result)]))
    assert read_result(tmp_path / "r.h5").codes == result.codes
    assert Block.read(tmp_path / "b.h5").result("a" * 16).codes == result.codes
    assert summaries(tmp_path / "b.h5")[0].codes == result.codes
    assert met_limit(result.codes)
    assert not met_limit(("of-tomorrow",))


def test_files_of_before_have_the_codes_of_contacts_that_open_or_close(
    made_up_result: Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    result = remarked(made_up_result)
    (tmp_path / "now.h5").write_bytes(content_of(result))
    with h5py.File(tmp_path / "now.h5", "a") as file:
        del file.attrs["codes"]
    assert read_result(tmp_path / "now.h5").codes == (Code.YOKE_STOPPED.value,)
    monkeypatch.setattr(block, "TEXTS", tuple(name for name in block.TEXTS if name != "codes"))
    (tmp_path / "b.h5").write_bytes(packed([CaseRecord.of("a" * 16, result)]))
    assert Block.read(tmp_path / "b.h5").result("a" * 16).codes == (Code.YOKE_STOPPED.value,)
    assert summaries(tmp_path / "b.h5")[0].codes == (Code.YOKE_STOPPED.value,)


def test_a_run_collects_remarks_with_their_codes_and_a_failed_one_keeps_its_cause() -> None:
    lifted, rigid = Remark(Code.FLANK_LIFTED, "lifted"), Remark(Code.RACK_RIGID, "rigid")
    run = SceneRun(Outcome(Status.OK)).noting(None, lifted).noting(rigid, lifted)
    assert run.outcome.message == "lifted; rigid; lifted"
    assert run.outcome.codes == (Code.FLANK_LIFTED, Code.RACK_RIGID)
    failed = run.invalid(Code.WORK_MISSING, "too coarse").noting(lifted)
    assert (failed.outcome.message, failed.outcome.codes) == ("too coarse", (Code.WORK_MISSING,))


def is_message(node: ast.AST) -> bool:
    """Return whether an expression is a message: x.message, message, x["message"]."""
    return (
        (isinstance(node, ast.Attribute) and node.attr == "message")
        or (isinstance(node, ast.Name) and node.id == "message")
        or (isinstance(node, ast.Subscript) and ast.unparse(node.slice) == "'message'")
    )


def readings(tree: ast.AST) -> Iterator[str]:
    """Yield the expressions that look for words in a message."""
    for node in ast.walk(tree):
        found = False
        if isinstance(node, ast.Compare):
            found = any(map(is_message, node.comparators)) and isinstance(node.ops[0], ast.In | ast.NotIn)
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
            found = node.func.attr in READERS and any(map(is_message, [node.func.value, *node.args]))
        if found:
            yield ast.unparse(node)


def test_no_code_looks_for_words_in_a_message() -> None:
    paths = {path.relative_to(PACKAGE).as_posix(): path for path in PACKAGE.rglob("*.py")}
    found = {
        name: list(readings(ast.parse(path.read_text(encoding="utf-8"))))
        for name, path in paths.items()
        if name not in SPLIT | {OLD_FILES}
    }
    assert {name: each for name, each in found.items() if each} == {}


def test_words_looked_for_in_a_message_are_found() -> None:
    code = (
        "if 'lifted' in run.outcome.message or re.search('x', row['message']): pass\nmessage.startswith('a')"
    )
    assert len(list(readings(ast.parse(code)))) == 3
