"""Which kernels a work compiles where nothing was compiled before, and how long each takes.

`python benchmarks/make.py kernel_table` measures it, with an empty cache for each work. Works are the scenes
with each preset, some models beside these, and commands that compile more than one run does.
"""

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

TABLE = Path(__file__).with_name("kernel_table.json")


@dataclass(frozen=True)
class KernelTable:
    """Kernels of works; many works need the same."""

    seconds: Mapping[str, float]  # kernel -> time of compiling it, without those that it calls [s]
    sets: Sequence[Counter[str]]  # of kernels; one that is compiled for two kinds of arguments counts twice
    works: Mapping[str, int]  # name -> place of its set

    @classmethod
    def of(cls, seconds: Mapping[str, float], works: Mapping[str, Counter[str]]) -> "KernelTable":
        """Return the table of what works have compiled."""
        sets: list[Counter[str]] = []
        for kernels in works.values():
            if kernels not in sets:
                sets.append(kernels)
        return cls(seconds, sets, {name: sets.index(kernels) for name, kernels in works.items()})

    def kernels(self, work: str) -> Counter[str]:
        """Return the kernels of a work; those of its preset for a model that is not in the table, and none
        for an unknown work."""
        place = self.works.get(work, self.works.get(work.partition(" with ")[0]))
        return Counter() if place is None else self.sets[place]

    def likeliest(self, seen: Counter[str], expected: Counter[str]) -> Counter[str] | None:
        """Return the set with all kernels seen that shares most with the one expected; None without one."""
        fitting = [each for each in self.sets if seen <= each]
        return max(fitting, key=lambda each: (each & expected).total(), default=None)

    def as_dict(self) -> dict[str, Any]:
        """Return the content of the table's file; a set holds the places of its kernels among the times."""
        names = sorted(self.seconds)
        places = {name: place for place, name in enumerate(names)}
        return {
            "seconds": {name: round(self.seconds[name], 3) for name in names},
            "sets": [" ".join(str(places[name]) for name in sorted(each.elements())) for each in self.sets],
            "works": dict(sorted(self.works.items())),
        }

    @classmethod
    def from_dict(cls, content: Mapping[str, Any]) -> "KernelTable":
        """Return the table in a file's content."""
        names = list(content["seconds"])
        sets = [Counter(names[int(place)] for place in each.split()) for each in content["sets"]]
        return cls(content["seconds"], sets, content["works"])


@cache
def kernel_table() -> KernelTable:
    """Return the package's table."""
    return KernelTable.from_dict(json.loads(TABLE.read_text(encoding="utf-8")))
