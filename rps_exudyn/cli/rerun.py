"""The command `rerun`: what a result holds, simulated again."""

import sys
from collections.abc import Iterator
from contextlib import redirect_stdout
from dataclasses import replace
from pathlib import Path

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import RESULT_FILES, check_writable
from rps_exudyn.base.screen import shown_progress
from rps_exudyn.cli.options import All, Json
from rps_exudyn.cli.output import note, present, verdict
from rps_exudyn.results.sheet import Block, Grid, Sheet, Text


def rerun(file: Path, /, *, out: Path | None = None, every: All = False, json: Json = False) -> int:
    """Repeat the simulation of a result from the parameters in its file, and compare both.

    Args:
        file: HDF5 file that `run` or `study` wrote; it is not changed.
        out: HDF5 file of the new result; default: none is written.
    """
    from rps_exudyn.analysis.result_comparison import differing_numbers, largest_difference
    from rps_exudyn.pages.report.result_sheet import result_as_dict, result_text
    from rps_exudyn.parameters.fidelity import Fidelity
    from rps_exudyn.parameters.gear import SteeringGear
    from rps_exudyn.parameters.retired import gone
    from rps_exudyn.simulate.run import simulate
    from rps_exudyn.study.case_blocks import load

    if out and check_writable(out, RESULT_FILES).resolve() == file.resolve():
        raise InputError(f"--out {out} is the result that is simulated again; name another file.")
    old = load(file)
    gear = SteeringGear.from_tables(old.gear.model_dump(), where=str(file))
    fidelity = Fidelity.from_tables(old.fidelity, where=str(file))
    for sentence in gone(old.fidelity, "fidelity"):
        note(sentence)
    with redirect_stdout(sys.stderr), shown_progress(asked=False):
        new = simulate(old.scene, gear, fidelity)
    new = replace(new, measured=old.measured)
    if out:
        new.save(out)
    differing, (quantity, size) = differing_numbers(old, new), largest_difference(old, new)

    def compared() -> Iterator[Block]:
        if not differing:
            yield Text(f"Every number equals that of {file}, bit for bit.")
            return
        if every:
            rows = [(what, *map(str, pair)) for what, pair in differing.items()]
            yield Grid(("differs", str(file), "now"), rows)
        words = f"The largest relative difference is {size:.2g}{f', of {quantity}' if quantity else ''}."
        yield Text(
            f"{len(differing)} numbers differ from {file}{'' if every else ' (--all: which)'}. {words}"
        )

    def data() -> dict[str, object]:
        return result_as_dict(new) | {"differing": differing, "largest": (quantity, size)}

    text = [*(result_text(new) if every else ()), *compared()]
    files = [out] if out and (every or json) else []
    present(Sheet(text=text, data=data), files, json=json)
    return verdict(new)
