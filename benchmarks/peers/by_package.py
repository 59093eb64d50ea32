"""The scene in this package: quasi-static, flank and full, with the rack guided as the peers guide it.

Each is one run in the steps given, as those of the peers are: no further run confirms its metrics.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from time import process_time

import numpy as np

from benchmarks.peers.reference import SCENE
from benchmarks.peers.scene import GEAR, GUIDED, TURN, Run
from rps_exudyn.parameters.fidelity import Fidelity
from verification.runs import run_scene


@dataclass(frozen=True)
class Package:
    """One preset of the package with settings."""

    program: str  # the preset's name
    settings: Mapping[str, object]

    @property
    def label(self) -> str:
        """Settings."""
        return ", ".join(f"{name.replace('_', ' ')} {value}" for name, value in self.settings.items())

    def run(self, turned: float) -> Run:
        """Run over an angle [rad], as `Method` says."""
        start = process_time()
        fidelity = Fidelity.preset(self.program).replace({**GUIDED, **self.settings})
        run = run_scene(SCENE, GEAR.replace({"test.turns": turned / TURN}), fidelity)
        whole = process_time() - start
        if not run.ok:
            raise ArithmeticError(f"{run.outcome.status}: {run.outcome.message}")
        time, torque = run.signals["time"], run.signals["pinion_torque"]
        return Run(GEAR.test.speed * np.asarray(time), torque, run.outcome.cpu_s, whole)
