"""Answers of Exudyn's general contact, MuJoCo, Drake and Newton to problems of friction with known answers.

Each program runs by the settings listed here, all of which are shown; some were added after first trials.
They run alternately, twice unless they are slow, and the least CPU time of the loop counts.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from benchmarks.peers.rounds import installed, versions
from benchmarks.topic import Topic, begun, digits, load_data, markdown, save_data
from benchmarks.truth.by_drake import Drake
from benchmarks.truth.by_exudyn import Exudyn
from benchmarks.truth.by_mujoco import MuJoCo
from benchmarks.truth.by_newton import Newton
from benchmarks.truth.problems import PROBLEMS
from benchmarks.truth.score import errors

DATA = "entries.json"
SETTINGS: Mapping[str, Any] = {
    "Exudyn, zone 10 mm/s": Exudyn(zone=1e-2),
    "Exudyn, zone 1 mm/s": Exudyn(),
    "Exudyn, zone 0.1 mm/s": Exudyn(zone=1e-4),
    "MuJoCo, defaults": MuJoCo(),
    "MuJoCo, step 1 ms, contact 2 ms, impratio 100": MuJoCo(1e-3, "elliptic", 100.0, 2e-3),
    "MuJoCo, step 0.5 ms, contact 1 ms, impratio 1000": MuJoCo(5e-4, "elliptic", 1000.0, 1e-3),
    "MuJoCo, step 0.1 ms, contact 0.2 ms, impratio 1000": MuJoCo(1e-4, "elliptic", 1000.0, 2e-4),
    "Drake, lagged, step 1 ms": Drake(),
    "Drake, lagged, step 1 ms, stiction 0.1 mm/s": Drake(stiction=1e-4),
    "Drake, SAP, step 1 ms": Drake(approximation="sap"),
    "Drake, SAP, step 0.1 ms": Drake(step=1e-4, approximation="sap"),
    "Drake, lagged, step 1 ms, stiction 0.1 mm/s, feet 10 kN/mm": Drake(stiction=1e-4, stiffness=1e7),
    "Drake, lagged, step 0.1 ms, stiction 0.001 mm/s, feet 100 kN/mm": Drake(1e-4, "lagged", 1e8, 1e-6),
    "Newton, zone 10 mm/s": Newton(zone=1e-2, share=0.5),
    "Newton, zone 1 mm/s": Newton(share=0.5),
}
SLOW = 20.0  # CPU time [s] from which a problem is not run again


def run(
    folder: Path,
    settings: Sequence[str] = tuple(SETTINGS),
    problems: Sequence[str] = tuple(PROBLEMS),
    rounds: int = 2,
) -> None:
    """Run all settings that can be run here; an entry of a former run is replaced."""
    kept = {(entry["problem"], entry["settings"]): entry for entry in begun(folder / DATA).get("entries", [])}
    for number in range(rounds):
        for name in settings:
            if installed(name):
                for problem in problems:
                    before = kept.get((problem, name)) if number else None
                    if before and before.get("cpu_seconds", SLOW) >= SLOW:
                        continue
                    kept[problem, name] = made(problem, name, before)
                    print(kept[problem, name], flush=True)
        known = begun(folder / DATA).get("versions", {})
        save_data(folder / DATA, {"versions": known | versions(), "entries": list(kept.values())})


def made(problem: str, name: str, before: dict[str, Any] | None = None) -> dict[str, Any]:
    """Run a problem; return the entry: the message of what failed, or answers and least CPU time so far."""
    method, asked = SETTINGS[name], PROBLEMS[problem]
    entry = {"problem": problem, "settings": name, "values": asdict(method)}
    try:
        found = {scene.name: method.run(scene) for scene in asked.scenes}
    except (ArithmeticError, RuntimeError, ValueError) as error:
        return entry | {"message": str(error)}
    spent = sum(seconds for _, seconds in found.values())
    if before:
        spent = min(spent, before.get("cpu_seconds", spent))
    return entry | {
        "answers": asked.answers({scene: motion for scene, (motion, _) in found.items()}),
        "cpu_seconds": spent,
    }


def entries_table(folder: Path) -> str:
    """Errors [%] of each answer, and CPU time of all problems."""
    entries = load_data(folder / DATA)["entries"]
    asked = {problem: ", ".join(each.truths).replace("_", " ") for problem, each in PROBLEMS.items()}
    head = ["settings", *(f"{problem}: {names}" for problem, names in asked.items()), "CPU s"]
    rows = []
    for settings in dict.fromkeys(entry["settings"] for entry in entries):
        own = {entry["problem"]: entry for entry in entries if entry["settings"] == settings}
        off = {problem: errors(entry) for problem, entry in own.items() if "answers" in entry}
        cells = [
            ", ".join(f"{error:+.2g}" for error, _ in off[problem].values())
            if problem in off
            else own.get(problem, {}).get("message", "-")
            for problem in PROBLEMS
        ]
        rows.append([settings, *cells, digits(sum(entry.get("cpu_seconds", 0.0) for entry in own.values()))])
    return markdown(head, rows)


TOPIC = Topic(
    "12 min",
    "truth",
    run,
    {"settings": ("Exudyn, zone 10 mm/s",), "problems": ("incline", "screw"), "rounds": 1},
    {"truth": entries_table},
)
