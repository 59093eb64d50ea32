"""Every picture that a command can make: no data outside its axes, no text over text, no text that is cut.

The commands run once in one folder; each picture is looked at when it is written. A function that returns a
Figure and is called by none of them fails the last test: a new chart needs a command here.
"""

import csv
import dataclasses
import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

import rps_exudyn
from benchmarks.charts import losses_figure, spectrum_figure, torques_figure
from made_up_study import FRICTION, PRELOAD, description, grid_points, make_study, sampled
from picture_album import Album, figure_functions
from rps_exudyn.assessment.validation.compared_rows import Simulated, compared_row
from rps_exudyn.assessment.validation.row import SHIPPED, read_rows
from rps_exudyn.cli.main import main
from rps_exudyn.pages.charts import style
from rps_exudyn.results.outcome import Status
from rps_exudyn.scenes import SCENE_NAMES
from rps_exudyn.study.case_blocks import load
from rps_exudyn.study.definition import Axis
from study_files import TWO
from verification.bench_curves import folder_of

ROOT = Path(__file__).parents[2]
MADE_UP = ROOT / "studies" / "examples" / "measured"
QUICK = ("--fidelity", "quasi-static")
OPTIONS: dict[str, tuple[str, ...]] = {
    "stick-slip": (),
    "yoke-impact": (),
    "rattle": ("--set", "rack.modes=4", "--set", "test.road_phases=1", "--set", "test.road_cycles=1"),
    "steering-torque": (*QUICK, "--set", "test.tyre_stiffness=50 N/mm"),
}
"""Scene -> options of a quick run; those of the others are `QUICK`."""
CLOSE_UP = "a close-up of the impacts, under the whole record in the panel above"
SECTION = "the section around the pitch point; pinion and rack are drawn whole in other pictures"
ZOOMS = {
    "rps_exudyn.pages.charts.scene_figures.impact_figure": {1: CLOSE_UP, 2: CLOSE_UP},
    "rps_exudyn.pages.animation.geometry_figure.geometry_figure": {2: SECTION},
}
LONG = "a_long_name_of_a_file_with_$signs$_2024-04-03_12-00-00_run_17"
SENTENCE = "the rack lies 12.4 mm beyond the teeth of the pinion at 143.2 deg, where no flank touches; " * 3


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    with pytest.MonkeyPatch.context() as patch:
        folder = tmp_path_factory.mktemp("pictures")
        patch.chdir(folder)
        yield folder


@pytest.fixture(scope="module")
def album(place: Path) -> Album:
    """The pictures of all commands."""
    album = Album(ZOOMS)
    for draw in (
        scenes,
        measured,
        failures,
        bands,
        comparisons,
        gears,
        fits,
        validations,
        studies,
        designs,
        others,
    ):
        draw(album)
    return album


def do(album: Album, *arguments: str, status: Iterable[int] = (0,)) -> None:
    """Run a command that draws."""
    with album.looking(" ".join(arguments)):
        assert main([*arguments]) in status
    assert album.pages[" ".join(arguments)]


def scenes(album: Album) -> None:
    for scene in SCENE_NAMES:
        do(album, "run", scene, *OPTIONS.get(scene, QUICK), "--out", f"{scene}.h5")
        do(album, "report", f"{scene}.h5")
    do(album, "show", "free-pinion-torque.h5", "--plot", "zero.svg", "--from-zero")
    do(album, "run", "--fidelity", "closed-form", "--out", "means.h5")
    for path in ("there-and-back", "lock-to-lock"):
        do(album, "run", *QUICK, "--set", f"test.path={path}", "--out", f"{path}.h5")
    do(album, "report", "--contact", "free-pinion-torque.h5")
    do(album, "report", "--contact", "lock-to-lock.h5")


def measured_file(
    name: str, ways: Sequence[int], level: float = 0.62, turns: tuple[int, int] = (-180, 180)
) -> str:
    """A made-up curve in these directions, one after the other."""
    rising = np.linspace(*turns, 181)
    with Path(f"{name}.csv").open("w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["pinion_angle [deg]", "pinion_torque [N m]"])
        for way in ways:
            for angle in rising[::way]:
                rows.writerow([f"{angle:.2f}", f"{way * level + 0.02 * np.cos(np.radians(6 * angle)):.5f}"])
    return f"{name}.csv"


def measured(album: Album) -> None:
    both = measured_file("both", (1, -1))
    files = [
        both,
        measured_file("forth", (1,)),
        measured_file("back", (-1,)),
        measured_file("small", (1, -1), 0.02),
        measured_file("large", (1, -1), 30.0),
        measured_file("several_turns", (1,), turns=(-900, 1200)),
        measured_file(LONG, (1, -1)),
    ]
    run = ("--out", "m.h5", "--measured")
    for file in files:
        do(album, "run", *QUICK, *run, file)
    for setting in ("test.direction=-1", "test.path=one-way", "test.turns=0.2"):
        do(album, "run", *QUICK, "--set", setting, *run, both)
        do(album, "run", *QUICK, "--set", setting, *run, files[1])
    for scene in SCENE_NAMES:
        do(album, "run", scene, *OPTIONS.get(scene, QUICK), *run, both)
    for scene in ("free-pinion-torque", "load-test", "reversal", "steering-feel"):
        do(album, "run", scene, *QUICK, *run, files[3])
        do(album, "report", "m.h5")


def failures(album: Album) -> None:
    for scene in SCENE_NAMES:
        result = load(f"{scene}.h5")
        with album.looking(f"failed {scene}"):
            dataclasses.replace(result, status=Status.DIVERGED, message=SENTENCE).plot("failed.png")


def bands(album: Album) -> None:
    unsure = ("--set", "yoke.preload=300 N +- 10 %", "--set", "yoke.clearance=uniform(30 um, 60 um)")
    do(album, "run", "--fidelity", "closed-form", "--band", "64", *unsure, "--out", "b.h5")
    do(album, "run", "--band", "--out", "b.h5")
    for scene in ("load-test", "rack-push", "reversal", "rack-lift", "radial-play", "input-shaft-play"):
        do(album, "run", scene, *QUICK, "--band", "8", "--out", "b.h5")


def comparisons(album: Album) -> None:
    load("means.h5").save(f"{LONG}.h5")
    for other in ("free-pinion-torque.h5", f"{LONG}.h5", "load-test.h5"):
        do(album, "diff", "free-pinion-torque.h5", other, "--plot", "d.png")


def gears(album: Album) -> None:
    for settings in (
        (),
        ("--set", "pinion.teeth=12", "--set", "pinion.profile_shift=0.2"),
        ("--set", "pinion.profile_shift=0", "--force"),
        ("--set", "pinion.normal_module=2.5 mm"),
    ):
        do(album, "geometry", *settings, "--out", "g.png")


def fits(album: Album) -> None:
    free, without = str(MADE_UP / "made_up_free.csv"), f"yoke-out={MADE_UP / 'made_up_yoke_out.csv'}"
    lines = Path(free).read_text(encoding="utf-8").splitlines()
    spiked = [f"{line.partition(';')[0]};99,00" if i % 60 == 9 else line for i, line in enumerate(lines)]
    Path("spiked.csv").write_text("\n".join(spiked), encoding="utf-8")
    written = ("--single-law", "--plot", "fit.png", "--report", "fit.html")
    for files in ((free, without), ("spiked.csv",), (without, "--free", "bush.drag")):
        do(album, "fit", *files, *written)
    Path("line").mkdir()
    folder_of(Path("line"), 6, 4.0)
    for more in ((), ("--tolerance", "0.5 N*m to 0.9 N*m")):
        do(album, "judge-batch", "line", "--plot", "drift.png", *more)


def validations(album: Album) -> None:
    """The shipped rows as they were published, and parts of them."""
    published = json.loads((ROOT / "results" / "validation" / "validation.json").read_text())["rows"]
    found = {row["name"]: row for row in published}
    compared = [compared_row(row, _simulated(found[row.name])) for row in read_rows(SHIPPED)]
    none = [each for each in compared if each.row.not_comparable]
    for rows in (compared, compared[:1], none[:1]):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(
                "rps_exudyn.assessment.validation.compared_rows.compare_rows",
                lambda *_, rows=rows, **__: rows,
            )
            do(album, "validate", "--out", f"validation_{len(rows)}.html")


def _simulated(row: dict[str, object]) -> Simulated:
    low, high = row["band"] or (None, None)
    values = (row["S"], row["u_num"], row["u_input"], low, high)
    return Simulated(*(np.nan if value is None else float(value) for value in values))


def studies(album: Album) -> None:
    result = load("free-pinion-torque.h5")
    kept = {name: result[name] for name in ("time", "pinion_angle", "pinion_torque", "rack_y")}
    result = dataclasses.replace(result, signals=kept)
    many = dataclasses.replace(PRELOAD, values=tuple(np.linspace(100.0, 400.0, 40).tolist()))
    uneven = dataclasses.replace(PRELOAD, values=(100.0, 101.0, 102.0, 110.0, 400.0))
    close = dataclasses.replace(PRELOAD, values=(300.0, 300.001, 300.002))
    paths = Axis("path", ("test.path",), "", ("one-way", "there-and-back", "lock-to-lock"), "grid")
    random = np.random.default_rng(0)
    drawn = [
        {"preload": float(preload), "friction": float(friction)}
        for preload, friction in zip(random.uniform(100, 400, 60), random.uniform(0.05, 0.2, 60), strict=True)
    ]
    described = {
        "few": sampled(drawn[:5]),
        "sampled": sampled(drawn),
        "words": description(
            [{**point, "path": path} for point in grid_points() for path in paths.values or ()],
            axes=(PRELOAD, FRICTION, paths),
        ),
    }
    for name, axis in {"grid": PRELOAD, "many": many, "uneven": uneven, "close": close}.items():
        axes = (axis, FRICTION)
        described[name] = description(grid_points(axes), axes=axes)
    for name, study in described.items():
        remarks = {0: "limited: the yoke stops at its nut"} if name == "grid" else {}
        make_study(Path(name), result, study, remarks=remarks)
        do(album, "report", name)


def designs(album: Album) -> None:
    Path("wish.toml").write_text('free_torque.most = "0.7 N*m"\n')
    do(album, "window", "yoke.preload", "--limits", "wish.toml", "--samples", "16", "--out", "window.png")
    Path("two.toml").write_text(TWO)
    do(album, "optimise", "two.toml", "--jobs", "1")
    worn = str(ROOT / "studies" / "gears" / "worn_rack.toml")
    do(album, "run", *QUICK, "--gear", worn, "--set", "test.turns=0.2", "--out", "worn.h5")


def others(album: Album) -> None:
    """Charts that benchmarks draw, and no command."""
    result, unlike = load("there-and-back.h5"), load("lock-to-lock.h5")
    both = {"there and back": result, LONG: unlike}
    figures: dict[str, Callable[[], Figure]] = {
        "losses": lambda: losses_figure(result),
        "spectrum": lambda: spectrum_figure(both),
        "several": lambda: torques_figure(both, "Free pinion torque", load("m.h5").measured),
    }
    for name, figure in figures.items():
        with album.looking(name):
            style.save(figure(), f"{name}.png")


# --- the tests ---------------------------------------------------------------------------------


def test_no_picture_has_data_outside_its_axes_or_texts_that_overlap_or_are_cut(album: Album) -> None:
    assert sum(map(len, album.pages.values())) > 100
    assert album.faults() == []


def test_every_function_that_returns_a_figure_was_looked_at(album: Album) -> None:
    looked_at = {name for page in album.pages.values() for drawn in page for name in drawn.functions}
    declared = figure_functions(rps_exudyn, without=("rps_exudyn.__main__",))
    assert declared - looked_at == set()
    assert ZOOMS.keys() <= declared
