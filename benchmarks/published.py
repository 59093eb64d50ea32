"""Origin of every published file: command, commit, machine, date and CPU time, kept beside the results."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from resource import RUSAGE_CHILDREN, RUSAGE_SELF, getrusage

from PIL import Image

from benchmarks.topic import begun, markdown
from rps_exudyn.base.files import replacing, write_json
from rps_exudyn.results.provenance import provenance

FILE = "published.json"
"""In the results' folder: path of a published file -> its origin."""

COLOURS_OF_A_PICTURE = 256

BOTH = RUSAGE_SELF, RUSAGE_CHILDREN
Stamps = dict[str, tuple[int, int]]


@contextmanager
def recording(results: Path, name: str, folder: str) -> Iterator[None]:
    """Keep the origin of every file that a topic writes in its folder within the block, also if it fails.

    A topic that goes on where it was stopped counts the CPU time of its last run.
    """
    made = provenance()  # before the topic writes into the checkout
    before, began = _stamps(results / folder), cpu_time_of(*BOTH)
    try:
        yield
    finally:
        after = _stamps(results / folder)
        entry = {
            "command": f"python benchmarks/make.py {name}",
            "commit": made["git_hash"],
            "date": made["date"],
            "machine": made["machine"],
            "cpu_time": round(cpu_time_of(*BOTH) - began, 1),
        }
        entries = origins(results)
        entries |= {f"{folder}/{file}": entry for file, stamp in after.items() if before.get(file) != stamp}
        write_json(results / FILE, dict(sorted(entries.items())))


def shrink_pictures(folder: Path) -> None:
    """Write the folder's PNG pictures with a palette, which takes a third of the bytes; others stay."""
    for file in sorted(folder.rglob("*.png")):
        with Image.open(file) as picture:
            if picture.mode == "P":
                continue
            pixels = Image.new("RGBA", picture.size, "white")
            pixels.alpha_composite(picture.convert("RGBA"))
        reduced = pixels.convert("RGB").quantize(COLOURS_OF_A_PICTURE, dither=Image.Dither.NONE)
        with replacing(file) as partial:
            reduced.save(partial, "PNG", optimize=True)


def origins(results: Path) -> dict[str, dict[str, object]]:
    """Path below the results' folder -> origin of every published file."""
    found: dict[str, dict[str, object]] = begun(results / FILE)
    return found


def origins_table(results: Path) -> str:
    """One row per date, the newest last: topics, and the commit they were run from."""
    runs: dict[tuple[str, str], set[str]] = {}
    for entry in origins(results).values():
        commit, _, dirty = str(entry["commit"]).partition("-")
        made = str(entry["date"])[:10], f"`{commit[:7]}`{' with edits' if dirty else ''}"
        runs.setdefault(made, set()).add(str(entry["command"]).rpartition(" ")[2])
    dates: dict[str, list[str]] = {}
    for (date, commit), topics in sorted(runs.items()):
        dates.setdefault(date, []).append(f"{', '.join(sorted(topics))} ({commit})")
    rows = [(date, "; ".join(commits)) for date, commits in dates.items()]
    return markdown(["date", "topics (commit)"], rows)


def _stamps(folder: Path) -> Stamps:
    """Path of a file in the folder or below -> time of its last change [ns] and size."""
    stats = {file.relative_to(folder): file.stat() for file in folder.rglob("*") if file.is_file()}
    return {path.as_posix(): (stat.st_mtime_ns, stat.st_size) for path, stat in stats.items()}


def cpu_time_of(*whose: int) -> float:
    """CPU time of this process (`RUSAGE_SELF`), or of all that it has started and seen ending [s]."""
    return sum(used.ru_utime + used.ru_stime for used in map(getrusage, whose))
