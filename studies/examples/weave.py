"""On-centre feel: the weave test (ISO 13674-1) of a car with this gear, and what decides it.

    python weave.py [PICTURE.png]

The wheel is turned to and fro at 0.2 Hz and 100 km/h, to 2 m/s^2 of lateral acceleration. A linear
single-track car gives the rack's load, the reduced gear the torque at the wheel, without power assistance.
Each parameter of the gear is then moved by its uncertainty, both ways.
"""

import sys

import numpy as np

import rps_exudyn as rps
from rps_exudyn.fmu.export_fmu import reduced_of
from rps_exudyn.solvers.reduced_motion import Push, RackEnd, ReducedMotion

SPEED, FREQUENCY, ACCELERATION = 100 / 3.6, 0.2, 2.0  # [m/s, Hz, m/s^2]
MASS, YAW, FRONT, REAR = 1500.0, 2500.0, 1.2, 1.5  # [kg, kg m^2, m, m]
STIFF_FRONT, STIFF_REAR = 90e3, 110e3  # of the axles [N/rad]
ARM, TRAIL = 0.13, 0.03  # of the steering, and of the front tyres with caster [m]
STEP, CYCLES = 2e-3, 3  # [s]
UNSURE = {"yoke.preload": 0.15, "mesh.friction": 0.2, "yoke.friction": 0.2, "bush.drag": 0.2}
UNITS = ("N m", "m/s^2", "N m/(m/s^2)", "deg")
NAMES = ("torque at no acceleration", "acceleration at no torque", "torque gradient", "angle hysteresis")


def weave(gear: rps.SteeringGear) -> dict[str, np.ndarray]:
    """Angle and torque of the wheel, and lateral acceleration, of the last cycle."""
    gain = (SPEED / (FRONT + REAR)) * SPEED / (1 + understeer() * SPEED**2)  # of a slow turn
    amplitude = ACCELERATION / gain * ARM / reduced_of(gear, LOAD).gain
    motion, column = ReducedMotion(reduced_of(gear, LOAD), RackEnd(), 0.0), gear.column
    slip = yaw = wheel = load = 0.0
    rows = []
    for k in range(round(CYCLES / FREQUENCY / STEP)):
        twist, before = wheel - motion.angle, wheel
        wheel = amplitude * np.sin(2 * np.pi * FREQUENCY * (k + 1) * STEP)
        half = column.stiffness / 2 + column.damping / STEP
        motion.end = RackEnd(load)
        turn = motion.push(Push(column.stiffness * twist + half * (wheel - before), half), STEP)
        steer = motion.travel / ARM
        front = STIFF_FRONT * (steer - slip - FRONT * yaw / SPEED)
        rear = STIFF_REAR * (REAR * yaw / SPEED - slip)
        slip += STEP * ((front + rear) / (MASS * SPEED) - yaw)
        yaw += STEP * (FRONT * front - REAR * rear) / YAW
        load = front * TRAIL / ARM
        torque = column.stiffness * (wheel - motion.angle) + column.damping * (wheel - before - turn) / STEP
        rows.append((wheel, torque, (front + rear) / MASS))
    last = np.array(rows)[-round(1 / FREQUENCY / STEP) :]
    return {name: last[:, i] for i, name in enumerate(("angle", "torque", "acceleration"))}


LOAD = 1200.0  # of the gear's table [N]; the car takes about half of it


def understeer() -> float:
    """Gradient of the steady turn [s^2/m^2]."""
    return MASS * (REAR * STIFF_REAR - FRONT * STIFF_FRONT) / (STIFF_FRONT * STIFF_REAR * (FRONT + REAR) ** 2)


def described(cycle: dict[str, np.ndarray]) -> np.ndarray:
    """The four numbers of `NAMES`; hysteresis counts half the width of a loop."""
    angle, torque, acceleration = cycle["angle"], cycle["torque"], cycle["acceleration"]
    rising = np.gradient(acceleration) > 0
    gradient = [
        np.polyfit(acceleration[way & near], torque[way & near], 1)[0]
        for way in (rising, ~rising)
        for near in (np.abs(acceleration) < 0.3,)
    ]
    return np.array(
        [
            half_width(acceleration, torque, rising),
            half_width(torque, acceleration, rising),
            np.mean(gradient),
            np.degrees(half_width(acceleration, angle, rising)),
        ]
    )


def half_width(along: np.ndarray, across: np.ndarray, rising: np.ndarray) -> float:
    """Half the width of a loop where the first signal is zero."""
    ends = [np.interp(0.0, *sorted_pairs(along[way], across[way])) for way in (rising, ~rising)]
    return float(abs(ends[0] - ends[1]) / 2)


def sorted_pairs(along: np.ndarray, across: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    order = np.argsort(along)
    return along[order], across[order]


gear = rps.SteeringGear()  # the paper's; SteeringGear.from_toml("my_gear.toml") reads another
cycle = weave(gear)
numbers = described(cycle)
changes = {}
for path, share in UNSURE.items():
    ends = [
        described(weave(gear.replace({path: gear.value_at(path) * (1 + way * share)}))) for way in (-1, 1)
    ]
    changes[path] = (ends[1] - ends[0]) / 2
band = np.sqrt(sum(change**2 for change in changes.values()))

for i, (name, unit) in enumerate(zip(NAMES, UNITS, strict=True)):
    first = max(changes, key=lambda path: abs(changes[path][i]))
    print(f"{name:27s} {numbers[i]:.3f} +- {band[i]:.3f} {unit}; most of it by {first}")
decisive = max(changes, key=lambda path: abs(changes[path][0]) / numbers[0])
print(f"on-centre feel is decided by {decisive}")

if len(sys.argv) > 1:
    from matplotlib.figure import Figure

    figure = Figure(layout="constrained")
    axes = figure.subplots()
    axes.plot(cycle["acceleration"], cycle["torque"])
    axes.axhline(0, color="0.8", zorder=0)
    axes.axvline(0, color="0.8", zorder=0)
    axes.set_xlabel("lateral acceleration [m/s$^2$]")
    axes.set_ylabel("torque at the wheel [N m]")
    figure.savefig(sys.argv[1])
