"""The problems in MuJoCo, from their MJCF files."""

from dataclasses import dataclass
from time import process_time

import numpy as np

from benchmarks.truth.problem_files import mjcf
from benchmarks.truth.problems import Motion, Scene


@dataclass(frozen=True)
class MuJoCo:
    """Settings; a time constant of 0 leaves MuJoCo's own contact (20 ms)."""

    step: float = 2e-3
    cone: str = "pyramidal"
    impratio: float = 1.0
    time_constant: float = 0.0
    no_slip: int = 0

    def run(self, scene: Scene) -> tuple[Motion, float]:
        """Return the motion and the CPU time of its loop [s]."""
        import mujoco

        spec = mujoco.MjSpec.from_string(mjcf(scene))
        option = spec.option
        option.timestep, option.impratio, option.noslip_iterations = self.step, self.impratio, self.no_slip
        option.cone = getattr(mujoco.mjtCone, f"mjCONE_{self.cone.upper()}")
        option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        if self.time_constant:
            for geom in spec.geoms:
                geom.solref = np.array([self.time_constant, 1.0])
        model = spec.compile()
        data = mujoco.MjData(model)
        joint = model.joint(scene.observed).qposadr[0], model.joint(scene.observed).dofadr[0]
        count = round(scene.seconds / self.step)
        found = np.zeros((count, 4))
        start = process_time()
        for i in range(count):
            if scene.drive:
                data.ctrl[0] = scene.drive.target(data.time + self.step)
            mujoco.mj_step(model, data)
            force = data.qfrc_actuator[joint[1]] if scene.drive else 0.0
            found[i] = data.time, data.qpos[joint[0]], data.qvel[joint[1]], force
        return Motion(*found.T), process_time() - start
