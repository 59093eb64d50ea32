"""The command `schema`: the JSON schema by which an editor completes and checks files."""

from pathlib import Path
from typing import Literal

from rps_exudyn.base.files import check_writable, write_json
from rps_exudyn.cli.output import DONE, print_json


def schema(kind: Literal["gear", "study", "optimise"] = "gear", /, *, out: Path | None = None) -> int:
    """Print the JSON schema of gear, study or optimisation files, with which editors complete and check them.

    Args:
        kind: Kind of file.
        out: File (.json) to write; name it in the first line of a TOML file: #:schema FILE.
    """
    from rps_exudyn.optimisation.file_kinds import SCHEMAS

    if out is None:
        print_json(SCHEMAS[kind]())
    else:
        write_json(check_writable(out, (".json",)), SCHEMAS[kind]())
        print(f"written: {out}")
    return DONE
