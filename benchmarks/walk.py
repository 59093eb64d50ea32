"""Count how a run moves through the package: `python benchmarks/walk.py`.

A free-pinion-torque by equilibria on both levels, the second one of a process.
"""

import sys
from collections import Counter
from pathlib import Path
from types import FrameType
from typing import Any

ROOT = Path(__file__).parents[1]
if not __package__:  # run as a script: its checkout holds the package
    sys.path[0] = str(ROOT)

PACKAGE = f"{ROOT / 'rps_exudyn'}/"


class Walk:
    """Calls of the package's frames, counted as a function of `sys.setprofile`; its methods count none."""

    def __init__(self) -> None:
        self.calls: Counter[tuple[str, str]] = Counter()  # by file and function
        self.moves: Counter[tuple[str, str]] = Counter()  # by the files of the caller and of the called
        self.files: list[str] = []  # of the package's frames that are open, outermost first
        self.deepest = 0

    def __call__(self, frame: FrameType, event: str, _: Any) -> None:
        """Count a call; a generator's frame is called each time it goes on."""
        if event not in ("call", "return") or not frame.f_code.co_filename.startswith(PACKAGE):
            return
        if event == "return":
            if self.files:
                self.files.pop()
            return
        file = frame.f_code.co_filename.removeprefix(PACKAGE)
        self.calls[file, frame.f_code.co_qualname] += 1
        if self.files and self.files[-1] != file:
            self.moves[self.files[-1], file] += 1
        self.files.append(file)
        self.deepest = max(self.deepest, len(self.files))


def walked() -> Walk:
    """Return what the second of two equal runs counted."""
    from rps_exudyn.parameters.gear import SteeringGear
    from rps_exudyn.simulate.run import simulate

    walk = Walk()
    for profile in (None, walk):
        sys.setprofile(profile)
        simulate("free-pinion-torque", SteeringGear(), "quasi-static")
        sys.setprofile(None)
    return walk


def main() -> None:
    """Print the counts, and the ways and functions that most of them come from."""
    walk = walked()
    print(f"calls of package frames   {walk.calls.total():6d}")
    print(f"files touched             {len({file for file, _ in walk.calls}):6d}")
    print(f"moves between files       {walk.moves.total():6d}")
    print(f"greatest depth of frames  {walk.deepest:6d}")
    for title, counts, sign in (("moves", walk.moves, "->"), ("calls", walk.calls, ":")):
        print(f"\nMost {title}")
        for (begin, end), number in counts.most_common(40):
            print(f"{number:6d}  {begin} {sign} {end}")


if __name__ == "__main__":
    main()
