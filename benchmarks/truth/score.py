"""Errors of an entry of the truth set: python score.py ENTRY.json [PROBLEM]

ENTRY.json is an object, or a list of objects, like

    {"problem": "wedge", "settings": "...", "answers": {"force_in": 49.1, "force_out": -13.7}}

For each answer it prints the error and the reference's uncertainty, both in % of the size that
`reference.json` states; "within" stands where the error is at most the uncertainty or 0.1 %. Problems are the
folders beside this file. Needs numpy alone.
"""

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

FOLDER = Path(__file__).parent
WITHIN = 0.1  # [%]


def errors(entry: dict[str, Any], folder: Path = FOLDER) -> dict[str, tuple[float, float]]:
    """Return the error of each answer and the reference's uncertainty [% of the stated size].

    Raises:
        ValueError: there is no such problem, or an answer is missing.
    """
    file = folder / str(entry.get("problem")) / "reference.json"
    if not file.is_file():
        raise ValueError(f"{entry.get('problem')!r} is no folder of {folder} with a reference.json")
    found = {}
    for name, right in json.loads(file.read_text(encoding="utf-8")).items():
        if name not in entry.get("answers", {}):
            raise ValueError(f"{entry['problem']}: the entry has no answer {name}")
        off = (np.float64(entry["answers"][name]) - right["value"]) / right["size"]
        found[name] = float(100 * off), float(100 * right["uncertainty"] / right["size"])
    return found


def main(arguments: list[str]) -> int:
    """Print the errors of a file's entries; return 0 if all could be scored."""
    if len(arguments) not in (1, 2):
        print(__doc__, file=sys.stderr)
        return 2
    try:
        entries = json.loads(Path(arguments[0]).read_text(encoding="utf-8"))
        entries = entries.get("entries", [entries]) if isinstance(entries, dict) else entries
        for entry in entries:
            if arguments[1:] and entry["problem"] != arguments[1]:
                continue
            for name, (error, uncertainty) in errors(entry).items():
                within = "  within" if abs(error) <= max(uncertainty, WITHIN) else ""
                where = f"{entry['problem']}, {entry.get('settings', '')}"
                print(f"{where}: {name} {error:+.3g} % (uncertainty {uncertainty:.2g} %){within}")
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
