"""The explorer's answers to random states of its sliders, and how long each slider and each scene takes."""

import json
from collections import Counter
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from time import process_time

import numpy as np

from benchmarks.topic import Topic, load_data, markdown, save_data
from rps_exudyn.pages.explore.sliders import SLIDERS, SLOW, Slider, Wish, answer, scenes
from rps_exudyn.parameters.gear import SteeringGear

DATA = "explorer.json"
TIMES = "median ms", "95 % within ms", "largest ms"
KINDS = ("values", "a sentence, the gear's geometry beside it", "a refusal")
FEW = 3  # sliders that half of the states move; the other half moves any number
FREE = Wish({})
REMARKABLE = 0.5  # CPU time of an answer that is printed [s]
LOADED = {"test.tyre_stiffness": "50 N/mm"}  # what a scene needs that the default gear has not


def run(folder: Path, states: int = 200, moves: int = 20) -> None:
    """Answer random states of several sliders, then moves of each slider alone, then moves of one slider in
    every scene of equilibria; keep kinds and times."""
    gear, rng = SteeringGear().replace(LOADED), np.random.default_rng(20)
    answer(gear, Wish({}))  # compiles
    answers = []
    for at in range(states):
        count = int(rng.integers(1, len(SLIDERS) + 1)) if at % 2 else FEW
        moved = [SLIDERS[i] for i in rng.choice(len(SLIDERS), count, replace=False)]
        answers.append(asked(gear, moved, rng))
    kinds = Counter(kind for kind, _ in answers)
    single = {each.path: spread(asked(gear, [each], rng) for _ in range(moves)) for each in SLIDERS}
    by_scene: dict[str, dict[str, dict[str, float]]] = {}
    for scene in (name for name, each in scenes().items() if not each["dynamic"]):
        for is_draft in (False, True):
            wish = Wish({}, scene, is_draft=is_draft)
            answer(gear, wish)  # compiles
            moved = [slider for slider in SLIDERS for _ in range(max(1, moves // 5))]
            found = spread(asked(gear, [slider], rng, wish) for slider in moved)
            by_scene.setdefault(scene, {})["draft" if is_draft else "answer"] = found
            print(scene, is_draft, found, flush=True)
            if found.get("largest", 0.0) <= SLOW:
                break
    content = {"kinds": kinds, "random": spread(answers), "sliders": single, "scenes": by_scene}
    save_data(folder / DATA, content)


def asked(
    gear: SteeringGear, sliders: list[Slider], rng: np.random.Generator, wish: Wish = FREE
) -> tuple[str, float]:
    """Draw a state of these sliders; return the kind of its answer, which must be JSON, and CPU time [s]."""
    state = {each.path: drawn(each, rng) for each in sliders}
    began = process_time()
    found = answer(gear, replace(wish, state=state))
    seconds = process_time() - began
    if seconds > REMARKABLE:
        print(f"{seconds:.1f} s", wish.scene, state, found.get("problems"), flush=True)
    json.dumps(found, allow_nan=False)
    if "curves" in found:
        return KINDS[0], seconds
    return KINDS[1] if "gear" in found else KINDS[2], seconds


def drawn(slider: Slider, rng: np.random.Generator) -> float:
    """Return one of the slider's steps, in its unit."""
    steps = round((slider.high - slider.low) / slider.step)
    return float(min(slider.low + rng.integers(0, steps + 1) * slider.step, slider.high))


def spread(answers: Iterable[tuple[str, float]]) -> dict[str, float]:
    """Median, 95th percentile and largest CPU time of those that have values [s]."""
    times = [seconds for kind, seconds in answers if kind == KINDS[0]]
    if not times:
        return {}
    return dict(zip(("median", "p95", "largest"), np.quantile(times, [0.5, 0.95, 1.0]).tolist(), strict=True))


def times_table(folder: Path) -> str:
    """CPU time of an answer: the slowest slider alone, and several at random, with the kinds of answers."""
    data = load_data(folder / DATA)
    path, slowest = max(data["sliders"].items(), key=lambda each: each[1].get("largest", 0.0))
    rows = [
        [f"the slowest of {len(data['sliders'])}, `{path}`", *_shown(slowest)],
        ["several at random", *_shown(data["random"])],
    ]
    table = markdown(["sliders moved", *TIMES], rows)
    curves, sentences, refusals = (data["kinds"].get(kind, 0) for kind in KINDS)
    return f"{table}\n\nAt random: {curves} curves, {sentences} sentences, {refusals} refusals."


def _shown(found: dict[str, float]) -> list[str]:
    return [f"{1e3 * found[name]:.0f}" if name in found else "-" for name in ("median", "p95", "largest")]


def scenes_table(folder: Path) -> str:
    """CPU time of an answer of each scene of equilibria, one slider moved, and of drafts of slow scenes."""
    scenes = load_data(folder / DATA)["scenes"]
    rows = [
        [f"`{scene}`", *_shown(found["answer"]), *_shown(found.get("draft", {}))[1:2]]
        for scene, found in scenes.items()
        if found["answer"]
    ]
    return markdown(["scene, any one slider moved", *TIMES, "drafts: 95 % within ms"], rows)


TOPIC = Topic(
    "3 min",
    "first_use",
    run,
    {"states": 4, "moves": 1},
    {"explorer_times": times_table, "explorer_scenes": scenes_table},
)
