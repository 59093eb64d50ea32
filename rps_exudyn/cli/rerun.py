"""The command `rerun`: what a result holds, simulated again."""

import sys
from contextlib import redirect_stdout
from dataclasses import replace
from pathlib import Path

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
        return verdict(new)
    if every:
        print_result(new, files)
    if not differing:
        put(f"Every number equals that of {file}, bit for bit.")
        return verdict(new)
    if every:
        put_table(
            ("differs", str(file), "now"), [(what, *map(str, pair)) for what, pair in differing.items()]
        )
    quantity, size = largest
    words = f"The largest relative difference is {size:.2g}{f', of {quantity}' if quantity else ''}."
    put(f"{len(differing)} numbers differ from {file}{'' if every else ' (--all: which)'}. {words}")
    return verdict(new)
