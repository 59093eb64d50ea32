"""The steering gear as an Exudyn system.

    model = build_model(gear, Fidelity.preset("full"))
    model.mbs                      the Exudyn MainSystem, to assemble and to go on with as usual; in general
                                   contact its function before each step is taken, and needed
    model.bodies["rack"]           object numbers; likewise model.nodes and model.sensors

Bodies and their joints, in the housing frame of `gears.gear_pair`:

    pinion    turns about its axis k (ObjectRotationalMass1D: its revolute joint is built in); on supports it
              has five more coordinates (NodeGenericODE2)
    rack      free rigid body; reference point on the bar's axis above the pitch point
    plunger   slides along Y (ObjectMass1D: its translational joint is built in)
    yokenut   locked to the housing
    wheel     steering wheel behind the column, where the rig turns it (ObjectRotationalMass1D)
    bush      chain of rigid segments held by connector springs, or condensed into the sliding fit

What acts between them are the force laws of `forces` and `tooth_contact`, the same that
`solvers.equilibrium` balances. The rig's drive
moves pinion, rack or wheel; the model starts in static equilibrium, so there is nothing to settle.
"""

from typing import Any

import exudyn as exu
import numpy as np
from exudyn import itemInterface as items

from rps_exudyn.base.errors import check_kind
from rps_exudyn.forces.bush import resting_segments
from rps_exudyn.forces.external_load import TimedForce
from rps_exudyn.forces.force_element import COORDINATE_BLOCKS, RACK, stacked
from rps_exudyn.forces.rigid_motion import rotation_matrix, spin_map
from rps_exudyn.gears import solids
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.masses import pinion_on_supports
from rps_exudyn.multibody.bodies import add_bodies, add_chain, add_forces, coordinate_marker
from rps_exudyn.multibody.column import add_column, add_wheel_torque
from rps_exudyn.multibody.general_contact import add_general_contacts
from rps_exudyn.multibody.steering_model import SteeringModel
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear, check_gear
from rps_exudyn.solvers.gear_forces import gear_forces
from rps_exudyn.solvers.gear_model import COLUMNS
from rps_exudyn.solvers.prescribed_motion import Drive, Steady
from rps_exudyn.solvers.settled_start import Approach, settled_behind, start_of_motion
from rps_exudyn.solvers.steering_column import ColumnModel, WheelTorque


def build_model(
    gear: SteeringGear,
    fidelity: Fidelity,
    drive: Drive | None = None,
    *,
    rack_load: float = 0.0,
    pulse: TimedForce | None = None,
    approach: Approach | None = None,
    pictured: bool = True,
) -> SteeringModel:
    """Build the gear in a rig, by default turned at its test's speed from the test's start angle.

    The result has `mbs`, Exudyn's system, not yet assembled, with the numbers of its nodes, bodies and
    sensors by name; `start.converged` is whether it found the equilibrium to start from. Without one the
    system is empty.

    Args:
        gear: its parameters, and the test's speed and angles.
        fidelity: one that Exudyn solves, such as the presets full and flank.
        drive: motion of the pinion, the rack or the wheel instead.
        rack_load: pulls the rack's end towards -X [N].
        pulse: force that acts on the rack besides.
        approach: the steady motion before the start, see `settled_path`.
        pictured: bodies get the shapes that Exudyn's viewer shows, which take longer to make than the rest.

    Raises:
        InputError: a gear that cannot exist.

    Examples:
        >>> model = rps.build_model(rps.SteeringGear(), rps.Fidelity.preset("flank"))
        >>> model.start.converged
        True
    """
    check_gear(gear)
    check_kind("fidelity", fidelity, Fidelity, "a Fidelity, such as Fidelity.preset('flank')")
    if drive is None:
        drive = Steady("pinion", gear.test.start_angle, gear.test.direction * gear.test.speed)
    forces = gear_forces(gear, fidelity, rack_load)
    column = ColumnModel.of(gear) if drive.body == "wheel" else None
    pair, statics = GearPair.of(gear), forces.statics
    if column is None:
        start = start_of_motion(statics, pair, drive, approach, fidelity.step_angle)
    else:
        start = settled_behind(statics, pair, drive, column, approach)
    SC = exu.SystemContainer()
    model = SteeringModel(gear, fidelity, forces, drive, SC, SC.AddSystem(), start)
    model.pulse, model.column, model.pictured = pulse, column, pictured
    if not start.converged:
        return model
    add_bodies(model)
    if column is not None:
        add_column(model, column)
    if forces.has_chain:
        _add_bush_chain(model)
    if fidelity.mesh == "general-contact":
        _add_forces_beside_spheres(model)
    else:
        _add_forces_together(model)
    _add_drive(model)
    for coordinate in forces.locked:
        _constrain(model, "rack", coordinate - RACK)
    if pulse is not None:
        _add_pulse(model, pulse)
    _add_sensors(model)
    return model


def _add_drive(model: SteeringModel) -> None:
    """Prescribe a coordinate of pinion, rack or wheel by a rheonomic constraint, or turn the wheel."""
    if isinstance(model.drive, WheelTorque):
        add_wheel_torque(model, model.drive)
        return
    place, rate = model.drive.of_time
    model.constraint = _constrain(
        model,
        model.drive.body,
        0,
        offsetUserFunction=lambda mbs, t, item, offset: place(t),
        offsetUserFunction_t=lambda mbs, t, item, offset: rate(t),
    )


def _constrain(model: SteeringModel, body: str, coordinate: int, **law: Any) -> Any:
    ground, node = model.mbs.AddNode(items.NodePointGround()), model.nodes[body]
    markers = [coordinate_marker(model, ground), coordinate_marker(model, node, coordinate)]
    return model.mbs.AddObject(items.CoordinateConstraint(markerNumbers=markers, **law))


def _add_pulse(model: SteeringModel, pulse: TimedForce) -> None:
    end = items.MarkerBodyPosition(bodyNumber=model.bodies["rack"], localPosition=[pulse.place, 0.0, 0.0])
    marker = model.mbs.AddMarker(end)
    model.mbs.AddLoad(
        items.LoadForceVector(markerNumber=marker, loadVectorUserFunction=lambda mbs, t, load: pulse.force(t))
    )


def _add_forces_beside_spheres(model: SteeringModel) -> None:
    """Add the teeth in Exudyn's general contact, and all other forces in one compiled object."""
    mbs, forces, nodes = model.mbs, model.forces, model.nodes
    assert forces.spheres is not None
    stack = [nodes[body] for body in model.stack]
    # GeneralContact itself contributes no Jacobian: without contact between spheres its own derivative is
    # exactly zero (tests/upstream pins this), so that of the compiled spheres is added
    add_forces(mbs, stack, len(stacked(model.stack)), forces.without_mesh.force, forces.tangent)
    model.contacts = add_general_contacts(
        mbs,
        model.gear,
        forces.spheres,
        pinion=model.bodies["pinion"],
        rack=model.bodies["rack"],
        angle=float(model.start.coordinates[0, 0]),
        step=model.fidelity.step_angle,
    )

    def bring_contacts(mbs: Any, t: float) -> bool:
        """Bring the contacts to where an implicit step is about to end."""
        contacts, system = model.contacts, mbs.systemData
        assert contacts is not None
        coordinates, rates = np.array(system.GetODE2Coordinates()), np.array(system.GetODE2Coordinates_t())
        contacts.hold(mbs, float(coordinates[model.coordinates("pinion")][0]))
        contacts.update(mbs, coordinates + mbs.sys["dynamicSolver"].it.currentStepSize * rates)
        return True

    mbs.SetPreStepUserFunction(bring_contacts)


def _add_forces_together(model: SteeringModel) -> None:
    """Add all forces of the gear in one compiled object, with its Jacobian."""
    forces, bar = model.forces, model.forces.bar
    bodies = [body for body in COORDINATE_BLOCKS if body in model.nodes]
    of_bodies, modes, held = len(stacked(bodies)), model.modes, len(forces.supported)
    pulse, at_peak = model.pulse, None
    if pulse is not None and bar is not None and modes:
        on_modes = bar.on_modes(pulse.place) @ pulse.peak
        at_peak = np.concatenate([np.zeros(of_bodies), on_modes, np.zeros(held)])
    mass = np.diag(np.repeat([0.0, 1.0, 0.0], [of_bodies, modes, held]))
    if held:
        mass[-held:, -held:] = pinion_on_supports(model.gear)
    if forces.has_bristles:
        forces.memory[:] = model.start.kept[-1][1]
    add_forces(
        model.mbs,
        [model.nodes[body] for body in model.stack],
        of_bodies + modes + held,
        forces.force,
        forces.tangent,
        memory=forces.memory if forces.has_bristles else None,
        mass=mass,
        applied=None if pulse is None or at_peak is None else lambda time: pulse.share(time) * at_peak,
    )


def _add_sensors(model: SteeringModel) -> None:
    """Add sensors of pinion, rack and plunger: `mbs.PlotSensor(model.sensors["rack"])`."""
    for body in ("pinion", "rack", "plunger"):
        model.sensors[body] = model.mbs.AddSensor(
            items.SensorNode(
                nodeNumber=model.nodes[body],
                storeInternal=True,
                outputVariableType=exu.OutputVariableType.Coordinates,
            )
        )


def _add_bush_chain(model: SteeringModel) -> None:
    """Add the segments, resting under the wrench of the fit at the start."""
    gear, chain = model.gear, model.forces.chain
    rest = resting_segments(gear, chain, _wrench_at_fit(model), chain.end_station)
    segment = solids.bush_segment_solid(gear).mass_properties
    nodes, bodies = add_chain(
        model.mbs,
        gear,
        chain,
        rest,
        mass=segment.mass,
        inertia=segment.inertia,
        axis_height=GearPair.of(gear).bar_axis_height,
    )
    model.segments = nodes
    model.nodes["segment"], model.bodies["segment"] = nodes[-1], bodies[-1]


def _wrench_at_fit(model: SteeringModel) -> np.ndarray:
    """Force and moment of the rack on the bush at the fit, where the model starts."""
    q, fit = model.start.coordinates[0, COORDINATE_BLOCKS["rack"]], model.forces.condensed
    on_rack = model.start.outputs[0, COLUMNS["bush"]][:6]
    moment = np.linalg.solve(spin_map(q[3:]).T, on_rack[3:])  # about the rack's reference point
    axis = rotation_matrix(q[3:])[:, 0]
    to_fit = (fit.station - q[0]) / axis[0] * axis
    return -np.concatenate([on_rack[:3], moment - np.cross(to_fit, on_rack[:3])])
