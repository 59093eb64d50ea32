"""The gear in C and as an FMU: the laws of the reduced gear, and those of FMI."""

import ctypes
import json
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rps_exudyn as rps
from fmu_files import COURSED, GEAR, LOAD, CGear, library, needs_compiler, table
from rps_exudyn.fmu.export_fmu import reduced_of
from rps_exudyn.fmu.gear_data import operation_table
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.reduced_motion import Push, RackEnd, ReducedMotion
from rps_exudyn.solvers.temperature_and_wear import tested_gear as gear_in_operation

pytestmark = needs_compiler
MADE, MISSING, LOST, BEYOND, NOT_FINITE, STEPS = range(6)


def histories(count: int, steps: int, parts: int) -> Any:
    """What random histories of the inputs give (`fmu_histories.c`)."""
    found = (ctypes.c_double * 6)()
    library().histories(count, steps, parts, ctypes.c_ulonglong(3), found)
    return list(found)


def test_no_history_makes_energy() -> None:
    """Steps of 10 us to 10 ms, torque or column at the pinion, load or travel at the rack, other preloads,
    frictions, temperatures and mounts. The works at the ports are found beside the gear; quadrature over the
    table's 24 kinks leaves the balance open to 1e-4."""
    found = histories(10_000, 60, 400)
    assert found[MADE] <= 1e-6
    assert found[MISSING] < 1e-4
    assert found[LOST] >= 0
    assert found[NOT_FINITE] == 0
    assert found[BEYOND] < 1000
    assert found[STEPS] > 500_000


def test_the_balance_of_work_closes_as_its_quadrature_does() -> None:
    """Simpson's rule over kinks is off by the square of its steps: 100 times as many leave nothing."""
    coarse, fine = (histories(100, 60, parts)[MISSING] for parts in (400, 40_000))
    assert fine < 1e-6
    assert fine < coarse


@pytest.mark.parametrize("of", [GEAR, COURSED], ids=["constant", "course"])
def test_c_and_python_take_the_same_steps(of: SteeringGear) -> None:
    rng, gear = np.random.default_rng(4), CGear(of, longest_step=1.0, start_angle=0.2)
    motion = ReducedMotion(table(of), RackEnd(400.0), 0.2)
    gear.set("rack_force_in", 400.0)
    gear.start()
    for _ in range(300):
        held = 400.0 * float(GearPair.of(of).gain_at(motion.angle))
        torque, step = float(rng.normal(held, 1.0)), float(10 ** rng.uniform(-5, -2))
        gear.set("pinion_torque_in", torque)
        assert gear.step(step) == 0
        motion.push(Push(torque), step)
        assert gear.get("pinion_angle") == pytest.approx(motion.angle, rel=1e-8, abs=1e-9)
        assert gear.get("lost_work") == pytest.approx(motion.lost, rel=1e-7, abs=1e-9)


def test_a_copy_of_the_bytes_goes_on_bit_for_bit() -> None:
    rng, gear = np.random.default_rng(5), CGear()
    gear.start()

    def go_on(steps: int, seed: int) -> list[float]:
        draw = np.random.default_rng(seed)
        seen = []
        for _ in range(steps):
            gear.set("pinion_torque_in", float(draw.normal(0, 1)))
            assert gear.step(1e-3) == 0
            seen += [gear.get("pinion_angle"), gear.get("friction_torque"), gear.get("lost_work")]
        return seen

    go_on(50, int(rng.integers(100)))
    kept = gear.bytes.raw
    first = go_on(50, 7)
    ctypes.memmove(gear.bytes, kept, len(kept))
    assert go_on(50, 7) == first


def test_pinion_and_rack_are_coupled_either_way() -> None:
    """The load that a travel takes, given as a load, leads to that travel; the torque that an angle takes
    holds it there."""
    by_travel = CGear(
        rack_input=1, pinion_input=1, pinion_angle_in=0.3, rack_travel_in=0.3 * table().gain - 2e-5
    )
    assert by_travel.start() == 0
    assert by_travel.step(1e-3) == 0
    load = by_travel.get("rack_force")
    assert load > 100
    by_load = CGear(pinion_input=1, pinion_angle_in=0.3, rack_force_in=load)
    assert by_load.start() == 0
    assert by_load.step(1e-3) == 0
    assert by_load.get("rack_travel") == pytest.approx(0.3 * table().gain - 2e-5, abs=1e-9)
    assert by_load.get("pinion_torque") == pytest.approx(by_travel.get("pinion_torque"), abs=1e-6)
    turned = CGear(start_angle=0.3, rack_force_in=load, pinion_torque_in=by_load.get("pinion_torque"))
    turned.start()
    for _ in range(200):
        turned.step(1e-3)
    assert turned.get("pinion_angle") == pytest.approx(0.3, abs=1e-4)


def test_a_rack_of_variable_ratio_moves_along_its_course() -> None:
    """Without load, at any preload; the pinion's torque and the load have the ratio of the place."""
    pair, friction = GearPair.of(COURSED), []
    for preload in (300.0, 400.0):
        gear = CGear(COURSED, pinion_input=1, pinion_angle_in=1.5, pinion_speed_in=2.0, preload=preload)
        assert gear.start() == gear.step(1e-3) == 0
        assert gear.get("rack_travel") == pytest.approx(float(pair.travel_at(1.5)), abs=1e-6)
        assert gear.get("rack_speed") == pytest.approx(2.0 * float(pair.gain_at(1.5)), rel=1e-3)
    for load in (-500.0, 500.0):  # friction does not turn about meanwhile
        gear = CGear(COURSED, pinion_input=1, pinion_angle_in=1.5, rack_force_in=load)
        assert gear.start() == gear.step(1e-3) == 0
        friction.append(gear.get("pinion_torque") - gear.get("friction_torque"))
    assert np.ptp(friction) == pytest.approx(1000 * float(pair.gain_at(1.5)), rel=2e-3)


def test_the_column_is_a_spring_in_series() -> None:
    """At rest under friction the pinion yields to a column as its own elements let it: k_c k / (k_c + k)."""
    gear = CGear(pinion_input=2, pinion_angle_in=0.0)
    gear.start()
    gear.set("pinion_angle_in", 1e-3)
    for _ in range(500):
        gear.step(1e-3)
    own, column = float(table().stiffness.sum()), GEAR.column.stiffness
    assert gear.get("pinion_torque") == pytest.approx(1e-3 * column * own / (column + own), rel=1e-2)


@pytest.mark.parametrize(("changes", "fmu", "limit"), [
    ({"yoke.preload": 360.0}, {"preload": 360.0}, 0.01),
    ({"yoke.preload": 240.0}, {"preload": 240.0}, 0.01),
    ({"mesh.friction": 0.12}, {"mesh_friction": 0.12}, 0.035),
    ({"yoke.friction": 0.08}, {"yoke_friction": 0.08}, 0.01),
    ({"conditions.temperature": 253.15}, {"temperature": 253.15}, 0.02),
])  # fmt: skip
def test_tunable_parameters_scale_the_table(
    changes: dict[str, Any], fmu: dict[str, float], limit: float
) -> None:
    """Friction of the tuned table against that of a table of the changed gear, free and under 1 kN. Where one
    flank carries the load, the teeth's share of friction is larger than the one of the free gear: -3 %."""
    other = reduced_of(GEAR.replace(changes), 1200.0)
    for load in (0.0, 1000.0):
        column = int(np.argmin(np.abs(other.loads - load)))
        means = []
        for sense in (1, -1):
            gear = CGear(pinion_input=1, rack_force_in=float(other.loads[column]), **fmu)
            gear.start()
            torques = []
            for k in range(1, 401):
                angle = sense * 0.0052 * k
                gear.set("pinion_angle_in", angle)
                gear.set("pinion_speed_in", 0.0)
                assert gear.step(1e-3) == 0
                torques.append(gear.get("pinion_torque"))
            means.append(float(np.mean(torques[-201:])))
        friction = (means[0] - means[1]) / 2
        expected = float((other.up - other.down)[:-1, column].mean() / 2)
        assert friction == pytest.approx(expected, rel=limit), load


def test_the_preload_of_each_temperature_is_that_of_the_conditions() -> None:
    rows = operation_table(GEAR, table())
    cold = GEAR.replace({"conditions.temperature": 253.15, "yoke.preload": "350 N"})
    factor, summand = (np.interp(253.15, rows[:, 0], rows[:, k]) for k in (1, 2))
    assert factor * 350 + summand == pytest.approx(gear_in_operation(cold).yoke.preload, rel=1e-9)


def test_a_load_beyond_the_table_is_a_status() -> None:
    gear = CGear(rack_force_in=1.2 * LOAD)
    assert gear.start() == 1
    gear = CGear(pinion_torque_in=float("nan"))
    assert gear.set("pinion_torque_in", float("nan")) == 2
    assert gear.set("preload", float("inf")) == 2
    assert gear.set("pinion_input", 7) not in (0, 1, 2)


# --- the FMU by an importer
@pytest.fixture(scope="module")
def exported(tmp_path_factory: pytest.TempPathFactory) -> dict[int, Path]:
    folder = tmp_path_factory.mktemp("fmu")
    paths = {version: folder / f"gear{version}.fmu" for version in (3, 2)}
    for version, path in paths.items():
        rps.export(SteeringGear(), path, fmi=version)
    return paths


def test_the_gear_and_its_error_are_inside(exported: dict[int, Path]) -> None:
    for version, path in exported.items():
        with zipfile.ZipFile(path) as archive:
            names = set(archive.namelist())
            error = json.loads(archive.read("resources/model_error.json"))
            assert b"[yoke]" in archive.read("resources/gear.toml") or b"default gear" in archive.read(
                "resources/gear.toml"
            )
        assert error["reference"] == "flank"
        assert abs(error["relative_error"]["hysteresis_area"]) < 0.01
        assert {f"sources/fmi{version}.c", "sources/reduced_gear.c", "sources/gear_data.h"} <= names
        assert any(name.startswith("binaries/") for name in names)


def test_equal_gears_give_equal_files(exported: dict[int, Path], tmp_path: Path) -> None:
    again = rps.export(SteeringGear(), tmp_path / "again.fmu")
    assert again.path.read_bytes() == exported[3].read_bytes()


fmpy = pytest.importorskip("fmpy", reason="FMPy of the extra [test] imports FMUs")


def swing(duration: float, step: float) -> np.ndarray:
    """Inputs of a column that is swung to and fro under a load."""
    names = ("time", "pinion_angle_in", "pinion_speed_in", "pinion_acceleration_in", "pinion_torque_in")
    names += ("rack_force_in", "rack_travel_in", "rack_speed_in")
    time = np.arange(0, duration + step / 2, step)
    signals = np.zeros(len(time), dtype=[(name, float) for name in names])
    signals["time"], signals["pinion_angle_in"] = time, 0.5 * np.sin(3 * time)
    signals["pinion_speed_in"] = 1.5 * np.cos(3 * time)
    signals["pinion_acceleration_in"] = -4.5 * np.sin(3 * time)
    signals["rack_force_in"] = 500 * np.sin(3 * time - 0.1)
    return signals


def simulated(path: Path, kind: str, step: float, **start: float) -> np.ndarray:
    outputs = ["pinion_angle", "pinion_torque", "rack_travel", "friction_torque"]
    options: dict[str, Any] = (
        {"solver": "CVode", "relative_tolerance": 1e-5} if kind == "ModelExchange" else {}
    )
    found: np.ndarray = fmpy.simulate_fmu(
        str(path), fmi_type=kind, stop_time=1.0, input=swing(1.0, step), output=outputs,
        output_interval=step, start_values=start, **options,
    )  # fmt: skip
    return found


def test_importers_find_nothing_wrong(exported: dict[int, Path]) -> None:
    from fmpy.validation import validate_fmu

    for path in exported.values():
        assert validate_fmu(str(path)) == []


def test_both_versions_and_the_c_code_agree(exported: dict[int, Path]) -> None:
    three, two = (simulated(exported[version], "CoSimulation", 1e-3, pinion_input=2) for version in (3, 2))
    for name in ("pinion_angle", "pinion_torque", "rack_travel"):
        assert np.array_equal(three[name], two[name])


def test_another_importer_agrees(exported: dict[int, Path]) -> None:
    """libcosim of the Open Simulation Platform, which reads files with FMI Library."""
    pytest.importorskip("libcosimpy", reason="libcosimpy of the extra [test] imports FMUs a second time")
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    log_output_level(CosimLogLevel.WARNING)
    step, inputs = 1e-3, swing(1.0, 1e-3)
    run = CosimExecution.from_step_size(step_size=round(step * 1e9))  # [ns]
    gear = run.add_local_slave(CosimLocalSlave(fmu_path=str(exported[2]), instance_name="gear"))
    seen, given = CosimObserver.create_last_value(), CosimManipulator.create_override()
    assert run.add_observer(seen)
    assert run.add_manipulator(given)
    numbers = {each.name.decode(): each.reference for each in run.slave_variables(slave_index=gear)}
    assert run.integer_initial_value(gear, numbers["pinion_input"], 2)
    names = [name for name in inputs.dtype.names or () if name != "time"]
    assert all(run.real_initial_value(gear, numbers[name], inputs[name][0]) for name in names)
    outputs, found = ("pinion_angle", "pinion_torque", "rack_travel"), []
    for now in inputs[:-1]:
        assert given.slave_real_values(gear, [numbers[name] for name in names], [now[name] for name in names])
        assert run.step()
        found.append(seen.last_real_values(gear, [numbers[name] for name in outputs]))
    first = simulated(exported[2], "CoSimulation", step, pinion_input=2)
    for name, values in zip(outputs, np.array(found).T, strict=True):
        expected = np.asarray(first[name])[1:]
        assert values == pytest.approx(expected, abs=1e-9 * np.ptp(expected))


def test_model_exchange_agrees_with_co_simulation(exported: dict[int, Path]) -> None:
    """At a given pinion angle, where an importer's delay of inputs counts least; model exchange rounds the
    corner at which elements begin to slide."""
    found = [simulated(exported[3], kind, 1e-3, pinion_input=1) for kind in ("CoSimulation", "ModelExchange")]
    friction = [
        np.interp(np.linspace(0.05, 0.45, 50), each["time"], each["friction_torque"]) for each in found
    ]
    assert friction[0] == pytest.approx(friction[1], rel=5e-3)


def test_instances_do_not_touch_each_other_and_states_return(
    exported: dict[int, Path], tmp_path: Path
) -> None:
    about = fmpy.read_model_description(str(exported[3]))
    fmpy.extract(str(exported[3]), str(tmp_path))
    reference = {each.name: each.valueReference for each in about.modelVariables}
    torque, angle = [reference["pinion_torque_in"]], [reference["pinion_angle"]]

    def instance(name: str) -> Any:
        made = fmpy.instantiate_fmu(str(tmp_path), about, "CoSimulation")
        made.enterInitializationMode()
        made.exitInitializationMode()
        return made

    def go(made: Any, size: float, steps: range) -> list[float]:
        seen = []
        for k in steps:
            made.setFloat64(torque, [size * np.sin(0.1 * k)])
            made.doStep(currentCommunicationPoint=1e-3 * k, communicationStepSize=1e-3)
            seen += made.getFloat64(angle)
        return seen

    alone = instance("alone")
    expected = go(alone, 0.9, range(100))
    one, two = instance("one"), instance("two")
    seen = []
    for k in range(100):
        seen += go(one, 0.9, range(k, k + 1))
        go(two, -3.0, range(k, k + 1))
    assert seen == expected
    state = alone.getFMUState()
    kept = alone.serializeFMUState(state)
    first = go(alone, 0.7, range(100, 150))
    alone.setFMUState(state)
    assert go(alone, 0.7, range(100, 150)) == first
    alone.setFMUState(alone.deserializeFMUState(kept))
    assert go(alone, 0.7, range(100, 150)) == first
    for made in (alone, one, two):
        made.terminate()
        made.freeInstance()


def test_directional_derivatives_are_slopes(exported: dict[int, Path], tmp_path: Path) -> None:
    """Rates of a pinion that a torque turns: d(rate of speed)/d(torque) = 1 / J."""
    about = fmpy.read_model_description(str(exported[3]))
    fmpy.extract(str(exported[3]), str(tmp_path))
    reference = {each.name: each.valueReference for each in about.modelVariables}
    made = fmpy.instantiate_fmu(str(tmp_path), about, "ModelExchange")
    made.enterInitializationMode()
    made.exitInitializationMode()
    slope = made.getDirectionalDerivative(
        [reference["der_speed_state"]], [reference["pinion_torque_in"]], [1.0]
    )
    assert slope[0] == pytest.approx(1 / table().inertia, rel=1e-6)
    travel = made.getDirectionalDerivative([reference["rack_travel"]], [reference["angle_state"]], [1.0])
    assert travel[0] == pytest.approx(table().gain, rel=1e-2)
    made.freeInstance()


def test_a_load_beyond_the_table_is_logged_with_its_range(exported: dict[int, Path]) -> None:
    said: list[str] = []
    inputs = swing(1.0, 1e-3)
    inputs["rack_force_in"] *= 10
    with pytest.raises(Exception, match="fmi3DoStep"):
        fmpy.simulate_fmu(
            str(exported[3]), fmi_type="CoSimulation", stop_time=1.0, input=inputs, output_interval=1e-3,
            start_values={"pinion_input": 1}, logger=lambda *given: said.append(str(given[-1])),
        )  # fmt: skip
    assert "the table has -3000 to 3000 N" in said[0]
