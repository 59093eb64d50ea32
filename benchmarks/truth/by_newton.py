"""The problems in Newton, from their MJCF files: explicit steps, single precision on the CPU."""

from dataclasses import replace
from time import process_time
from typing import Any

import numpy as np

from benchmarks.truth.problem_files import mjcf
from benchmarks.truth.problems import Motion, Scene
from benchmarks.truth.soft_feet import SoftFeet

CONTACTS = 256  # at most
GAP = 1e-5  # at which contacts are looked for [m]
MOST_STEPS = 100_000  # of a scene: more than two minutes


class Newton(SoftFeet):
    """Newton's `SolverFeatherstone` with settings."""

    def run(self, scene: Scene) -> tuple[Motion, float]:
        """Return the motion and the CPU time of its loop [s].

        Raises:
            ArithmeticError: the motion is not finite, or has too many steps.
        """
        step = self.step(scene)
        if (count := round(scene.seconds / step)) > MOST_STEPS:
            raise ArithmeticError(f"not run: {count} steps")
        import newton
        import warp

        warp.config.quiet = True
        model = self._model(newton, scene)
        solver = newton.solvers.SolverFeatherstone(model, angular_damping=0.0)
        pipeline = newton.CollisionPipeline(model, broad_phase="sap", rigid_contact_max=CONTACTS)
        now, then, contacts, control = model.state(), model.state(), pipeline.contacts(), model.control()
        newton.eval_fk(model, now.joint_q, now.joint_qd, now)
        freedoms = [each.name for body in scene.bodies for each in body.freedoms]
        row, drive = freedoms.index(scene.observed), scene.drive
        forces, found = np.zeros(len(freedoms), np.float32), np.zeros((count, 4))
        place = rate = 0.0
        start = process_time()
        for i in range(count):
            if drive:
                forces[row] = drive.stiffness * (drive.target(i * step) - place) - drive.damping * rate
                control.joint_f.assign(forces)
            found[i] = i * step, place, rate, forces[row]
            pipeline.collide(now, contacts)
            now.clear_forces()
            solver.step(now, then, control, contacts, step)
            now, then = then, now
            place, rate = (float(each.numpy()[row]) for each in (now.joint_q, now.joint_qd))
        spent = process_time() - start
        if not np.isfinite(found).all():
            raise ArithmeticError("Newton: the motion is not finite")
        return Motion(*found.T), spent

    def _model(self, newton: Any, scene: Scene) -> Any:
        """Return the scene without its drive, with the feet's springs; of two shapes the mean counts."""
        builder = newton.ModelBuilder(gravity=scene.gravity)
        builder.default_shape_cfg.gap = GAP
        builder.add_mjcf(mjcf(replace(scene, drive=None)))
        model = builder.finalize(device="cpu")
        feet = model.shape_type.numpy() == newton.GeoType.SPHERE
        values = np.zeros((3, len(feet)), np.float32)
        for number, body in enumerate(scene.bodies):
            own = feet & (model.shape_body.numpy() == number)
            stiffness = self.stiffness(scene, body)
            rubbing = scene.friction * stiffness * self.depth / self.zone
            values[:, own] = 2 * np.array([[stiffness], [self.damping(scene, body)], [rubbing]])
        surfaces = model.shape_material_ke, model.shape_material_kd, model.shape_material_kf
        for surface, of_shapes in zip(surfaces, values, strict=True):
            surface.assign(of_shapes)
        return model
