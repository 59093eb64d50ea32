"""The explorer's answers to random states of its sliders, and how long each slider takes."""

import json
from collections import Counter
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

from benchmarks.topic import Topic, load_data, markdown, save_data
from rps_exudyn.pages.explore.sliders import SLIDERS, Slider, Wish, answer
from rps_exudyn.parameters.gear import SteeringGear

DATA = "explorer.json"
KINDS = ("values", "a sentence, the gear's geometry beside it", "a refusal")
FEW = 3  # sliders that half of the states move; the other half moves any number


def run(folder: Path, states: int = 1000, moves: int = 20) -> None:
    """Answer random states of several sliders, then moves of each slider alone; keep kinds and times."""
    gear, rng = SteeringGear(), np.random.default_rng(20)
    answer(gear, Wish({}))  # compiles
    kinds: Counter[str] = Counter()
    times: list[float] = []
    for at in range(states):
        count = int(rng.integers(1, len(SLIDERS) + 1)) if at % 2 else FEW
        kind, seconds = asked(gear, [SLIDERS[i] for i in rng.choice(len(SLIDERS), count, replace=False)], rng)
        kinds[kind] += 1
        if kind == KINDS[0]:
            times.append(seconds)
    single = {}
    for slider in SLIDERS:
        tried = [asked(gear, [slider], rng) for _ in range(moves)]
        known = [seconds for kind, seconds in tried if kind == KINDS[0]]
        single[slider.path] = {"refused": len(tried) - len(known), **spread(known)}
    save_data(folder / DATA, {"kinds": dict(kinds), "random": spread(times), "sliders": single})


def asked(gear: SteeringGear, sliders: list[Slider], rng: np.random.Generator) -> tuple[str, float]:
    """Draw a state of these sliders; return the kind of its answer, which must be JSON, and CPU time [s]."""
    state = {each.path: drawn(each, rng) for each in sliders}
    began = process_time()
    found = answer(gear, Wish(state))
    seconds = process_time() - began
    json.dumps(found, allow_nan=False)
    if "torque" in found:
        return KINDS[0], seconds
    return KINDS[1] if "gear" in found else KINDS[2], seconds


def drawn(slider: Slider, rng: np.random.Generator) -> float:
    """Return one of the slider's steps, in its unit."""
    steps = round((slider.high - slider.low) / slider.step)
    return float(min(slider.low + rng.integers(0, steps + 1) * slider.step, slider.high))


def spread(times: list[float]) -> dict[str, float]:
    """Median, 95th percentile and largest of CPU times [s]."""
    if not times:
        return {}
    return dict(zip(("median", "p95", "largest"), np.quantile(times, [0.5, 0.95, 1.0]).tolist(), strict=True))


def kinds_table(folder: Path) -> str:
    """How many states ended how."""
    data = load_data(folder / DATA)
    rows: list[list[Any]] = [[kind, data["kinds"].get(kind, 0)] for kind in KINDS]
    return markdown(["answer", "states"], rows)


def times_table(folder: Path) -> str:
    """CPU time of an answer: the slowest slider alone, and several at random."""
    data = load_data(folder / DATA)
    path, slowest = max(data["sliders"].items(), key=lambda each: each[1].get("largest", 0.0))
    refused = sum(found["refused"] for found in data["sliders"].values())
    rows = [
        [f"the slowest of {len(data['sliders'])}, `{path}`", *_shown(slowest), refused],
        ["several at random", *_shown(data["random"]), ""],
    ]
    head = ["sliders moved", "median ms", "95 % within ms", "largest ms", "moves of one refused"]
    return markdown(head, rows)


def _shown(found: dict[str, float]) -> list[str]:
    return [f"{1e3 * found[name]:.0f}" if name in found else "-" for name in ("median", "p95", "largest")]


TOPIC = Topic(
    "answers of the explorer to random states, and their time",
    "3 min",
    "first_use",
    run,
    {"states": 4, "moves": 1},
    {"explorer_kinds": kinds_table, "explorer_times": times_table},
)
