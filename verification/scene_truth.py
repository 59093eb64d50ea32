"""What a run of a scene should have shown: methods that must agree, quantity by quantity.

truth = truth_of("reversal", gear, methods, ("pinion_torque", "hysteresis_area"))
truth.uncertainty["hysteresis_area"]    largest difference of two methods [%]
truth.errors_of(run, fidelity)          quantity -> error [%]
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from rps_exudyn.analysis.impacts import describe_impacts
from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.run_maneuver import run_maneuver
from rps_exudyn.scenes.scene_run import SceneRun
from rps_exudyn.scenes.yoke_impact import end_deflection, shaken
from rps_exudyn.simulate.accuracy_check import Recorded, error_between, is_signal
from verification.references import SHAKEN
from verification.runs import run_scene

Made = tuple[SceneRun, Fidelity]
Make = Callable[[str, SteeringGear], Made]
"""(scene, gear) -> a run, and the fidelity whose steps it has."""

LEAST = 2  # methods of which a truth is made


@dataclass(frozen=True, eq=False)
class Truth:
    """Runs of one scene of one gear by methods of their own; the first that succeeded is the reference."""

    scene: str
    gear: SteeringGear
    quantities: tuple[str, ...]
    runs: Mapping[str, Made]
    failed: Mapping[str, str]  # method -> why

    def errors_of(self, run: Recorded, fidelity: Fidelity) -> dict[str, float]:
        """Return the error of each quantity [%]; nan where there is none."""
        return self._apart((run, fidelity), next(iter(self.runs.values())))

    def apart(self, first: str, second: str) -> dict[str, float]:
        """Return how far two methods lie apart in each quantity [%], nan where one of them failed."""
        if first in self.runs and second in self.runs:
            return self._apart(self.runs[first], self.runs[second])
        return dict.fromkeys(self.quantities, float("nan"))

    @property
    def uncertainty(self) -> dict[str, float]:
        """Largest difference of two methods in each quantity [%]; nan where one does not have it."""
        pairs = [self._apart(a, b) for a, b in combinations(self.runs.values(), 2)]
        return {name: float(np.max([pair[name] for pair in pairs])) for name in self.quantities}

    def _apart(self, run: tuple[Recorded, Fidelity], truer: Made) -> dict[str, float]:
        return {name: error_between(name, self.scene, self.gear, run, truer) for name in self.quantities}


def truth_of(
    scene: str,
    gear: SteeringGear,
    methods: Mapping[str, Make],
    quantities: Sequence[str],
    allowed: Mapping[str, float],
) -> Truth:
    """Return the runs of all methods that succeed; none is tried any more once methods differ in each
    quantity by more than is allowed [%].

    Raises:
        ArithmeticError: fewer than `LEAST` of them do, all quantities differ too much, or nothing happens of
            what they count; its message says how.
    """
    runs: dict[str, Made] = {}
    failed: dict[str, str] = {}
    for name, make in methods.items():
        try:
            run, fidelity = make(scene, gear)
        except (ArithmeticError, InputError) as error:
            failed[name] = str(error)
            continue
        if not run.ok:
            failed[name] = f"{run.outcome.status}, {run.outcome.message}"
            continue
        runs[name] = run, fidelity
        if not any(is_signal(scene, each) or run.summary.get(each) for each in quantities):
            raise ArithmeticError(f"nothing to measure: {' and '.join(quantities)} are 0")
        truth = Truth(scene, gear, tuple(quantities), runs, failed)
        if len(runs) >= LEAST and not any(truth.uncertainty[each] <= allowed[each] for each in quantities):
            known = ", ".join(f"{each} to {truth.uncertainty[each]:.2g} %" for each in quantities)
            raise ArithmeticError(f"the references of {' and '.join(runs)} differ: {known}")
    if len(runs) < LEAST:
        raise ArithmeticError("; ".join(f"{name}: {why}" for name, why in failed.items()))
    return Truth(scene, gear, tuple(quantities), runs, failed)


# --- methods ---------------------------------------------------------------------------------------
def by_model(fidelity: Fidelity) -> Make:
    """Method: a run of the package with this model."""

    def make(scene: str, gear: SteeringGear) -> Made:
        return run_scene(scene, gear, fidelity), fidelity

    return make


def impact_in_parts(parts: int) -> Make:
    """Method: an impact in Exudyn, each of the scene's steps in `parts` steps."""

    def make(scene: str, gear: SteeringGear) -> Made:
        maneuver = shaken(gear)
        cut = replace(maneuver, time_step=maneuver.time_step / parts, steps=maneuver.steps * parts)
        return run_maneuver(gear, SHAKEN, cut).described(_of_impact), SHAKEN

    return make


def _of_impact(signals: dict[str, np.ndarray]) -> dict[str, float]:
    return {**describe_impacts(signals), **end_deflection(signals)}
