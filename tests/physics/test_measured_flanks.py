"""Flanks as measured against closed forms, brute force and conservation."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import rps_exudyn as rps
from flank_points import line_wrench_by_points
from flank_poses import POSES, difference, state
from measured_grids import pinion_axes, rack_axes, write_grid
from rps_exudyn.gears.flank_grid import measured_flanks
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.tooth_contact.flank_data import pack
from rps_exudyn.tooth_contact.measured_flank import pooled_grids
from rps_exudyn.tooth_contact.spheres import contact_data
from rps_exudyn.tooth_contact.wrench import ELASTIC_ENERGY, FORCE, NORMAL_DRIVE, TORQUE
from verification.contact_at import flank_contact

LINE = SteeringGear().replace({"mesh.law": "line", "mesh.friction": 0.0, "mesh.damping": 0.0})
PAIR = GearPair.of(LINE)
FLANK = Flank(PAIR, 0, -1)
Q_FORM, Q_TIP, HALF_FACE = FLANK.form_tangent_length, FLANK.tip_tangent_length, PAIR.face_width / 2
NORMAL = np.cos(PAIR.beta_b)  # of a surplus along the transverse tangent


def wrench(gear: SteeringGear, *args: object, along: int = 16) -> np.ndarray:
    """The wrench of law "line"."""
    return flank_contact(*args, pack(gear, along=along), pool=pooled_grids(measured_flanks(gear))[2])


def waves(seed: int, size: float = 2e-6, shortest: float = 8e-3) -> Callable[..., np.ndarray]:
    """A smooth surface of some waves in both directions."""
    rng = np.random.default_rng(seed)
    numbers = rng.uniform(-1, 1, (5, 2)) * 2 * np.pi / shortest
    phases = rng.uniform(0, 2 * np.pi, 5)
    return lambda u, w: (
        size / 2 * sum(np.sin(a * u + b * w + c) for (a, b), c in zip(numbers, phases, strict=True))
    )


FORMS = {
    "slope": ({"pinion.profile_slope": 21e-6}, lambda q, z: 21e-6 * (q - Q_FORM) / (Q_TIP - Q_FORM)),
    "crowning": ({"pinion.crowning": 15e-6}, lambda q, z: -15e-6 * (z / HALF_FACE) ** 2),
    "relief": (
        {"pinion.tip_relief": 20e-6, "pinion.tip_relief_length": 2e-3},
        lambda q, z: -20e-6 * np.maximum(1 - (Q_TIP - q) / 2e-3, 0) ** 2,
    ),
}


@pytest.mark.parametrize("form", FORMS)
def test_grid_of_a_closed_form_is_the_parameter(form: str, tmp_path: Path) -> None:
    """The curvature of a relief begins at once, that of a spline within a step of its places."""
    (settings, surface), limit = FORMS[form], 1e-3 if form == "relief" else 1e-4
    file = write_grid(tmp_path / "form.csv", pinion_axes(LINE, 97), lambda q, z: NORMAL * surface(q, z))
    by_grid, by_parameter = LINE.replace({"pinion.deviation": file}), LINE.replace(settings)
    for angle in (0.1, 0.4, 0.9):
        args = state(LINE, angle, press=30e-6, turn=(2e-4, 3e-4, -2e-4))
        assert difference(wrench(by_grid, *args), wrench(by_parameter, *args), LINE) < limit
    runs = [
        rps.run("free-pinion-torque", gear.replace({"mesh.friction": 0.1}), fidelity="quasi-static", level=3)
        for gear in (by_grid, by_parameter)
    ]
    means = [run.summary["torque_mean"] for run in runs]
    assert means[0] == pytest.approx(means[1], rel=1e-4)


@pytest.mark.parametrize("pose", POSES)
def test_contact_is_that_of_points_on_the_measured_flanks(pose: str, tmp_path: Path) -> None:
    """Other waves on each tooth and flank of pinion and rack; the deepest of 1000 points in 200 sections.

    On plane racks these leave 0.1 to 0.2 %. The law ends a line where its middle leaves a flank, points where
    the deepest one does.
    """
    flanks = ("drive", "coast")
    of_pinion = {(str(t), flank): waves(2 * t + k) for t in range(6) for k, flank in enumerate(flanks)}
    rack_teeth = RackBar.of(LINE).teeth
    on_rack = {(str(t), flank): waves(100 + 2 * t + k) for t in rack_teeth for k, flank in enumerate(flanks)}
    gear = LINE.replace(
        {
            "pinion.deviation": write_grid(tmp_path / "pinion.csv", pinion_axes(LINE, 41, 65), of_pinion),
            "rack.deviation": write_grid(tmp_path / "rack.csv", rack_axes(LINE, 41, 65), on_rack),
        }
    )
    for angle in (0.25, 0.75):
        args = state(gear, angle, **POSES[pose])
        expected = line_wrench_by_points(gear, *args, shape=(1000, 200))
        errors = [difference(wrench(gear, *args, along=n), expected, gear) for n in (8, 32)]
        assert errors[0] < 1e-2
        assert errors[1] < 6e-3


def test_even_surplus_is_a_rack_that_stands_closer(tmp_path: Path) -> None:
    """All flanks of the rack by d thicker: the rack by d / sin alpha_n closer, but for the tips' and the
    bar's place."""
    d = 4e-6
    file = write_grid(tmp_path / "even.csv", rack_axes(LINE), lambda y, z: d)
    thicker = LINE.replace({"rack.deviation": file})
    for angle in (0.2, 0.6):
        args = state(LINE, angle, press=20e-6)
        closer = list(args)
        closer[2] = args[2] - np.array([0.0, d / np.sin(PAIR.alpha_n), 0.0])
        assert difference(wrench(thicker, *args), wrench(LINE, *closer), LINE) < 2e-3


def test_forces_are_the_slope_of_the_energy(tmp_path: Path) -> None:
    """Without friction: torque and force are minus the derivatives of the stored energy."""
    file = write_grid(tmp_path / "waves.csv", pinion_axes(LINE, 41, 65), waves(7))
    rack = write_grid(tmp_path / "rack.csv", rack_axes(LINE, 41, 65), waves(8))
    gear, step = LINE.replace({"pinion.deviation": file, "rack.deviation": rack}), 1e-6
    args = list(state(gear, 0.3, press=25e-6))
    here = wrench(gear, *args, along=32)

    def energy(turn: float, move: float) -> float:
        moved = [args[0] + turn, args[1], args[2] + np.array([0.0, move, 0.0]), *args[3:]]
        return float(wrench(gear, *moved, along=32)[ELASTIC_ENERGY])

    load = here[NORMAL_DRIVE]
    by_turn = (energy(step, 0) - energy(-step, 0)) / (2 * step)
    by_move = (energy(0, 1e-8) - energy(0, -1e-8)) / 2e-8
    assert here[TORQUE] == pytest.approx(-by_turn, abs=1e-3 * load * PAIR.base_radius)
    assert here[FORCE][1] == pytest.approx(-by_move, abs=1e-3 * load)


def test_spheres_stand_on_the_measured_flank(tmp_path: Path) -> None:
    file = write_grid(
        tmp_path / "crown.csv", pinion_axes(LINE), lambda q, z: NORMAL * FORMS["crowning"][1](q, z)
    )
    sizes = {"profile": 12, "axial": 8, "friction_zone": 1e-3}
    centres = [
        contact_data(LINE.replace(change), **sizes).centres
        for change in ({"pinion.deviation": file}, {"pinion.crowning": 15e-6})
    ]
    np.testing.assert_allclose(*centres, atol=2e-9)


def test_uneven_places_and_diameters_make_the_same_surface(tmp_path: Path) -> None:
    even = pinion_axes(LINE)
    surface = waves(3, shortest=8e-3)
    roll, face = even["roll"].copy(), even["face"].copy()
    roll[1:-1] += 2e-5 * np.sin(np.arange(roll.size - 2))
    face[1:-1] += 1e-4 * np.cos(np.arange(face.size - 2))
    diameter = 2 * np.hypot(roll, PAIR.base_radius)

    def by_diameter(d: np.ndarray, z: np.ndarray) -> np.ndarray:
        return surface(np.sqrt((d / 2) ** 2 - PAIR.base_radius**2), z)

    files = {
        "even": write_grid(tmp_path / "even.csv", even, surface),
        "uneven": write_grid(tmp_path / "uneven.csv", {"roll": roll, "face": face}, surface),
        "dense": write_grid(tmp_path / "dense.csv", pinion_axes(LINE, 600), surface),
        "diameter": write_grid(tmp_path / "d.csv", {"diameter": diameter, "face": face}, by_diameter),
    }
    text = Path(files["even"]).read_text(encoding="utf-8").replace(",", ";").replace(".", ",")
    files["spreadsheet"] = str(tmp_path / "s.csv")
    Path(files["spreadsheet"]).write_text(text, encoding="utf-8")
    q, z = np.meshgrid(np.linspace(Q_FORM, Q_TIP, 50), np.linspace(-HALF_FACE, HALF_FACE, 50))
    for file in files.values():
        grid = measured_flanks(LINE.replace({"pinion.deviation": file})).pinion
        assert grid is not None
        np.testing.assert_allclose(grid.at(q, z, 0, -1), surface(q, z), atol=2e-8)


def test_teeth_that_bend_see_the_same_flanks(tmp_path: Path) -> None:
    """Law "teeth", crowning as a grid: within the bars of both."""
    file = write_grid(
        tmp_path / "crown.csv", pinion_axes(LINE), lambda q, z: NORMAL * FORMS["crowning"][1](q, z)
    )
    gear = SteeringGear().replace({"mesh.law": "teeth"})
    for metric in ("torque_mean", "torque_peak_to_peak"):
        runs = [
            rps.run("free-pinion-torque", gear.replace(change), fidelity="quasi-static", level=2)
            for change in ({"pinion.deviation": file}, {"pinion.crowning": 15e-6})
        ]
        values, errors = ([getattr(run, what)[metric] for run in runs] for what in ("summary", "errors"))
        assert abs(values[0] - values[1]) < sum(errors)


def test_worn_flank_gives_way_where_it_is_worn(tmp_path: Path) -> None:
    """A rack worn by 10 um on its middle teeth: the yoke follows it by what the worn teeth in mesh allow, at
    most d / sin alpha_n."""
    gear = SteeringGear()
    depth = {t: 1e-5 * np.exp(-((t / 1.5) ** 2)) for t in RackBar.of(gear).teeth}
    worn = {(str(t), "both"): (lambda y, z, d=d: -d + 0 * y) for t, d in depth.items()}
    file = write_grid(tmp_path / "worn.csv", rack_axes(gear, 5, 5), worn)
    changes = {"test.path": "there-and-back", "test.start_angle": -np.pi, "test.turns": 1.0}
    new, old = (
        rps.run("free-pinion-torque", gear.replace(changes | of), fidelity="quasi-static")
        for of in ({}, {"rack.deviation": file})
    )
    lift = np.ptp(old.signals["rack_y"]) - np.ptp(new.signals["rack_y"])
    whole = 1e-5 / np.sin(PAIR.alpha_n)
    assert 0.7 * whole < lift < whole
