"""The command `rerun`: what a result holds, simulated again."""

import sys
from collections.abc import Mapping
from contextlib import redirect_stdout
from dataclasses import replace
from pathlib import Path
from typing import Any

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import RESULT_FILES, check_writable
from rps_exudyn.base.screen import shown_progress
from rps_exudyn.cli.options import All, Json
from rps_exudyn.cli.output import note, print_json, put, put_table


def rerun(file: Path, /, *, out: Path | None = None, every: All = False, json: Json = False) -> int:
    """Repeat the simulation of a result from the parameters in its file, and compare both.

    Args:
        file: HDF5 file that `run` or `study` wrote; it is not changed.
        out: HDF5 file of the new result; default: none is written.
    """
    from rps_exudyn.analysis.result_comparison import differing_numbers, largest_difference
    from rps_exudyn.cli.printed import print_result, result_as_dict, verdict
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
    differing, largest = differing_numbers(old, new), largest_difference(old, new)
    files = [out] if out else []
    if json:
        print_json(result_as_dict(new, files) | {"differing": differing, "largest": largest})
    else:
        if every:
            print_result(new, files)
        print_differing(differing, largest, str(file), every)
    return verdict(new)


def print_differing(
    differing: Mapping[str, tuple[Any, Any]], largest: tuple[str, float], name: str, every: bool = True
) -> None:
    """Print how many numbers of a repeated simulation differ from the file `name`, or `every` one of them,
    and the `largest` difference."""
    if not differing:
        put(f"Every number equals that of {name}, bit for bit.")
        return
    rows = [(what, *map(str, pair)) for what, pair in differing.items()]
    if every:
        put_table(("differs", name, "now"), rows)
    quantity, size = largest
    largest_words = f"The largest relative difference is {size:.2g}{f', of {quantity}' if quantity else ''}."
    put(f"{len(rows)} numbers differ from {name}{'' if every else ' (--all: which)'}. {largest_words}")
