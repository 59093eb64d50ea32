"""The scene in Newton, single precision on the CPU: spheres on the pinion's flanks, boxes under the rack's.

`SolverFeatherstone` integrates joints explicitly. Its contact is the scene's law: a spring for each sphere,
whose stiffness is the mean of both shapes', and friction that grows with speed up to Coulomb's limit. A
damper holds the pinion's speed, and its torque is read.
"""

from dataclasses import dataclass
from time import process_time
from typing import Any

import numpy as np

from benchmarks.peers import scene
from benchmarks.peers.geometry import FLANKS, RADIUS, SIDES, TEETH, flank_box, springs

GAP = 1e-5  # at which contacts are looked for [m]
INERTIA, DRIVE = 1e-2, 100.0  # of the pinion [kg m^2], and of the damper that drives it [N m s/rad]
FRICTION_GAIN = 1e3  # friction over sliding speed, below Coulomb's limit [N s/m]
CONTACTS = 4096  # at most


@dataclass(frozen=True)
class Newton:
    """Newton with settings."""

    profile: int
    axial: int
    step: float  # [s]
    damping: float = 2e-5  # damping over stiffness of a contact [s]

    program = "Newton, spheres"

    @property
    def label(self) -> str:
        """Settings."""
        times = f"step {1e6 * self.step:g} us, damping {1e6 * self.damping:g} us"
        return f"{self.profile} x {self.axial}, {times}"

    def run(self, turned: float) -> scene.Run:
        """Run over an angle [rad], as `Method` says."""
        import newton
        import warp

        warp.config.quiet = True
        start = process_time()
        model = self._model()
        solver = newton.solvers.SolverFeatherstone(model, angular_damping=0.0)
        pipeline = newton.CollisionPipeline(model, broad_phase="sap", rigid_contact_max=CONTACTS)
        now, then, contacts, control = model.state(), model.state(), pipeline.contacts(), model.control()
        now.joint_q.assign(scene.START.astype(np.float32))
        now.joint_qd.assign(scene.RATES.astype(np.float32))
        newton.eval_fk(model, now.joint_q, now.joint_qd, now)
        angle, rate = np.empty((2, scene.steps_of(turned, self.step)))
        loop = process_time()
        for i in range(angle.size):
            pipeline.collide(now, contacts)
            now.clear_forces()
            solver.step(now, then, control, contacts, self.step)
            now, then = then, now
            angle[i], rate[i] = now.joint_q.numpy()[0], now.joint_qd.numpy()[0]
        end = process_time()
        scene.check_mesh("Newton", float(now.joint_q.numpy()[2]))
        return scene.Run(angle, DRIVE * (scene.SPEED - rate), end - loop, end - start)

    def _model(self) -> Any:
        import newton

        builder = newton.ModelBuilder(gravity=(0.0, -scene.PRELOAD / scene.RACK_MASS, 0.0))
        axis, inertia = newton.ModelBuilder.JointDofConfig, (1e-2 * np.eye(3)).tolist()
        pinion, rack = (builder.add_link(mass=m, inertia=inertia) for m in (0.25, float(scene.RACK_MASS)))
        drive = {"target_qd": scene.SPEED, "target_ke": 0.0, "target_kd": DRIVE, "armature": INERTIA}
        turns = [axis(axis=(0, 0, -1), actuator_mode=newton.JointTargetMode.VELOCITY, **drive)]
        slides = [axis(axis=way) for way in ((1, 0, 0), (0, 1, 0))]
        centre = np.array([0.0, scene.PAIR.bar_axis_height, 0.0])
        on_axis, on_bar = _placed(np.zeros(3), scene.PAIR.pinion_frame), _placed(centre)
        builder.add_articulation([builder.add_joint_d6(-1, pinion, angular_axes=turns, parent_xform=on_axis)])
        builder.add_articulation([builder.add_joint_d6(-1, rack, linear_axes=slides, parent_xform=on_bar)])
        for tooth in TEETH:
            for side in SIDES:
                centre, half, frame = flank_box(tooth, side)
                box = dict(zip(("hx", "hy", "hz"), half.tolist(), strict=True))
                builder.add_shape_box(rack, xform=_placed(centre, frame), cfg=self._surface(0.0, side), **box)
        for tooth, side in FLANKS:
            for centre, stiffness in springs(tooth, side, self.profile, self.axial):
                surface = self._surface(2 * stiffness, side)  # the box has none, and the mean counts
                builder.add_shape_sphere(pinion, xform=_placed(centre), radius=RADIUS, cfg=surface)
        return builder.finalize(device="cpu")

    def _surface(self, stiffness: float, side: int) -> Any:
        import newton

        spring = {"ke": stiffness, "kd": self.damping * stiffness}
        rubbing = {"mu": float(scene.FRICTION), "kf": FRICTION_GAIN, "collision_group": 1 + SIDES.index(side)}
        return newton.ModelBuilder.ShapeConfig(density=0.0, gap=GAP, **spring, **rubbing)


def _placed(centre: np.ndarray, axes: np.ndarray | None = None) -> Any:
    import warp

    turned = warp.quat_identity() if axes is None else warp.quat_from_matrix(warp.mat33(axes))
    return warp.transform(warp.vec3(*centre.tolist()), turned)
