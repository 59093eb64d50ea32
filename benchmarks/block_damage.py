"""Blocks of cases, killed and damaged: nothing lost, nothing wrong, nothing double.

One study of real equilibria is done undisturbed, another one under SIGKILLs of its parent and its workers.
Then bytes anywhere in the blocks are changed, one after the other, and the same command mends the study.
"""

import random
import tempfile
from pathlib import Path

from benchmarks.study_runner import compared, grid, killed, watched, written
from benchmarks.topic import Topic, load_data, markdown, save_data
from rps_exudyn.study.store import Store

DATA = "block_damage.json"
PAUSE = (1.0, 4.0)  # [s] between kills: time enough for the processes to start and do some cases
SETTINGS = '[set]\npinion.runout = "10 um"\nfidelity.step_angle = "0.25 deg"'


def run(
    folder: Path, sides: tuple[int, int, int] = (16, 12, 10), kills: int = 25, flips: int = 50, mends: int = 3
) -> None:
    """Disturb a study of so many cases.

    Args:
        folder: where the data go.
        sides: cases along the three axes of the grid.
        kills: number of SIGKILLs.
        flips: number of changed bytes, each of which has to be noticed.
        mends: for how many of them the study is run again, too.
    """
    rows = []
    with tempfile.TemporaryDirectory() as temporary:
        place = Path(temporary)
        text = f"{grid(sides, samples=61, settings=SETTINGS)}blocks = true\n"
        file = written(place, "blocks", text)
        watched(file, place / "undisturbed", 2)
        seen = killed(file, place / "disturbed", kills, PAUSE)
        cases = sides[0] * sides[1] * sides[2]
        victims = f"{seen['parent']} kills of the parent, {seen['worker']} of a worker"
        what = f"{cases} cases in blocks after {victims}"
        rows.append((what, compared(place / "undisturbed", place / "disturbed")))
        rows.append(("blocks left by it", str(len(Store.open(place / "disturbed").blocks.paths))))
        rows.append((f"{flips} changed bytes, one at a time", noticed(place / "disturbed", flips)))
        rows.append((f"{mends} of them, the study run again", mended(file, place, mends)))
        print(*rows, sep="\n", flush=True)
    save_data(folder / DATA, {"rows": rows})


def noticed(folder: Path, flips: int) -> str:
    """Change bytes, one at a time and anywhere; count what is named, and rows that then differ."""
    chance, named, wrong, lost = random.Random(2), 0, 0, 0
    whole = {row.hash: row for _, row in Store.open(folder).rows()}
    for _ in range(flips):
        store = Store.open(folder)
        path = chance.choice(store.blocks.paths)
        content = path.read_bytes()
        path.write_bytes(_changed(content, chance))
        rows = {row.hash: row for _, row in store.rows()}
        path.write_bytes(content)
        named += [skipped for skipped, _ in store.skipped] == [path]
        wrong += sum(row != whole[name] for name, row in rows.items())
        lost = max(lost, len(whole) - len(rows))
    return f"{named} named, {wrong} rows differ, at most {lost} cases to be done again"


def mended(file: Path, place: Path, mends: int) -> str:
    """Damage a block, run the study again, and compare every number with the undisturbed one."""
    chance, found = random.Random(3), set()
    for _ in range(mends):
        path = chance.choice(Store.open(place / "disturbed").blocks.paths)
        path.write_bytes(_changed(path.read_bytes(), chance))
        watched(file, place / "disturbed", 2)
        found.add(compared(place / "undisturbed", place / "disturbed"))
    return "; ".join(found)


def _changed(content: bytes, chance: random.Random) -> bytes:
    changed = bytearray(content)
    changed[chance.randrange(len(changed))] ^= chance.randrange(1, 256)
    return bytes(changed)


def table(folder: Path) -> str:
    """All that was found."""
    return markdown(("what", "found"), load_data(folder / DATA)["rows"])


TOPIC = Topic(
    "blocks of a study, killed and damaged",
    "10 min",
    "study_runner",
    run,
    {"sides": (2, 2, 2), "kills": 0, "flips": 2, "mends": 0},
    {"block_damage": table},
)
