"""Each public name has an example in its docstring, and it runs as printed."""

import doctest
import inspect
import re
from pathlib import Path

import numpy as np
import pytest

import rps_exudyn as rps
from made_up_study import make_study
from rps_exudyn import scenes


@pytest.mark.parametrize("name", rps.__all__)
def test_example_runs_as_printed(
    name: str, made_up_result: rps.Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(scenes, "_OWN", {})
    monkeypatch.chdir(tmp_path)
    make_study(tmp_path / "preload-study", made_up_result)
    one = getattr(rps, name)
    known = {"rps": rps, "np": np}
    example = doctest.DocTestParser().get_doctest(inspect.getdoc(one) or "", known, name, None, None)
    assert example.examples, "its docstring has no example"
    said: list[str] = []
    doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(example, out=said.append)
    assert not said, "".join(said)


@pytest.mark.parametrize("name", [name for name in rps.__all__ if inspect.isfunction(getattr(rps, name))])
def test_docstring_of_a_function_explains_each_argument(name: str) -> None:
    """Where there are several; the name of a single one explains it."""
    one = getattr(rps, name)
    arguments = list(inspect.signature(one).parameters)
    explained = re.findall(r"^    (\w+): ", inspect.getdoc(one) or "", re.M)
    assert len(arguments) == 1 or set(arguments) <= set(explained)


@pytest.mark.parametrize("one", [rps.Batch, rps.Fit, rps.Result, rps.Scene])
def test_docstring_of_a_record_explains_each_field(one: type) -> None:
    explained = re.findall(r"^    (\w+): ", inspect.getdoc(one) or "", re.M)
    assert set(one.__dataclass_fields__) <= set(explained)  # type: ignore[attr-defined]
