"""The scene in MuJoCo: spheres or convex pieces on the pinion's flanks, boxes under the rack's.

A contact of MuJoCo is a constraint with a spring and a damper. With constant impedance d, a stiffness s
given directly (`solref` negative) and the inverse inertia A that MuJoCo takes for the pair,
its force at a depth r at rest is

    f = s r / d^2  d / ((1 - d) A),      so that      s = k d (1 - d) A

makes it the spring k that a sphere has in the package: k = stiffness x area of its cell.
"""

from dataclasses import dataclass
from time import process_time
from typing import Any

import numpy as np

from benchmarks.peers import scene
from benchmarks.peers.geometry import FLANKS, RADIUS, SIDES, TEETH, flank_box, pieces, springs

IMPEDANCE = 0.9


@dataclass(frozen=True)
class MuJoCo:
    """MuJoCo with settings."""

    kind: str  # spheres, or convex pieces
    profile: int
    axial: int
    step: float  # [s]
    damping: float = 1e-4  # damping over stiffness of a contact [s]
    impratio: float = 100.0  # by which friction is stiffer than the normal constraint
    cone: str = "elliptic"

    @property
    def program(self) -> str:
        """Name of the family."""
        return f"MuJoCo, {self.kind}"

    @property
    def label(self) -> str:
        """Settings."""
        return (
            f"{self.profile} x {self.axial}, step {1e6 * self.step:g} us, damping {1e6 * self.damping:g} us, "
            f"impratio {self.impratio:g}, {self.cone} cone"
        )

    def run(self, turned: float) -> scene.Run:
        """Run over an angle [rad], as `Method` says."""
        import mujoco

        start = process_time()
        model = self._model()
        data = mujoco.MjData(model)
        data.qpos[:], data.qvel[:] = scene.START, scene.RATES
        steps = scene.steps_of(turned, self.step)
        angle, torque = np.empty(steps), np.empty(steps)
        loop = process_time()
        for i in range(steps):
            mujoco.mj_step(model, data)
            angle[i], torque[i] = data.qpos[0], -data.qfrc_constraint[0]
        end = process_time()
        angle -= scene.SPEED * self.step / 2  # of the step in whose middle the force acted
        scene.check_mesh("MuJoCo", data.qpos[2])
        return scene.Run(angle, torque, end - loop, end - start)

    def _model(self) -> Any:
        import mujoco

        spec = mujoco.MjSpec()
        option = spec.option
        option.timestep = self.step
        option.gravity = 0, -scene.PRELOAD / scene.RACK_MASS, 0  # the preload: the pinion cannot move along Y
        option.impratio = self.impratio
        option.cone = getattr(mujoco.mjtCone, f"mjCONE_{self.cone.upper()}")
        option.solver, option.tolerance, option.iterations = mujoco.mjtSolver.mjSOL_NEWTON, 1e-10, 50
        option.ccd_tolerance, option.ccd_iterations = 1e-10, 200  # depths are micrometres
        option.disableflags |= mujoco.mjtDisableBit.mjDSBL_MULTICCD  # one contact for a pair: its area's
        option.integrator = mujoco.mjtIntegrator.mjINT_EULER
        pinion = spec.worldbody.add_body(name="pinion", quat=_quaternion(scene.PAIR.pinion_frame))
        pinion.add_joint(type=mujoco.mjtJoint.mjJNT_HINGE, axis=(0, 0, -1), armature=scene.FLYWHEEL)
        _weigh(pinion, 0.25)
        rack = spec.worldbody.add_body(name="rack", pos=(0, scene.PAIR.bar_axis_height, 0))
        for axis in ((1, 0, 0), (0, 1, 0)):
            rack.add_joint(type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis)
        _weigh(rack, scene.RACK_MASS)
        self._add_boxes(rack)
        stiffness = self._add_flanks(spec, pinion)
        model = spec.compile()
        per = -IMPEDANCE * (1 - IMPEDANCE) * model.body_invweight0[[1, 2], 0].sum() * stiffness
        of_pinion = np.flatnonzero(model.geom_bodyid == 1)
        model.geom_solref[of_pinion, 0] = per
        model.geom_solref[of_pinion, 1] = per * self.damping / IMPEDANCE
        return model

    def _add_boxes(self, rack: Any) -> None:
        import mujoco

        for tooth in TEETH:
            for group, side in enumerate(SIDES):
                centre, half, axes = flank_box(tooth, side)
                of = {"contype": 0, "conaffinity": 1 << group, **_surface()}
                box = {"type": mujoco.mjtGeom.mjGEOM_BOX, "pos": centre, "size": half}
                rack.add_geom(quat=_quaternion(axes), **box, **of)

    def _add_flanks(self, spec: Any, pinion: Any) -> np.ndarray:
        """Add the pinion's flanks; return the stiffness of each piece [N/m], in order."""
        import mujoco

        stiffness = []
        for tooth, side in FLANKS:
            common = {"contype": 1 << SIDES.index(side), "conaffinity": 0, "priority": 1, **_surface()}
            if self.kind == "spheres":
                sphere = {"type": mujoco.mjtGeom.mjGEOM_SPHERE, "size": (RADIUS, 0, 0), **common}
                for centre, own in springs(tooth, side, self.profile, self.axial):
                    pinion.add_geom(pos=centre, **sphere)
                    stiffness.append(own)
                continue
            for number, (corners, area) in enumerate(pieces(tooth, side, self.profile, self.axial)):
                name = f"{tooth} {side} {number}"
                spec.add_mesh(name=name, uservert=corners.ravel())
                pinion.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name, **common)
                stiffness.append(scene.STIFFNESS * area)
        return np.array(stiffness)


def _surface() -> dict[str, Any]:
    return {
        "friction": (scene.FRICTION, 0, 0),
        "condim": 3,
        "mass": 0.0,
        "solimp": (IMPEDANCE, IMPEDANCE, 1e-3, 0.5, 2),
    }


def _weigh(body: Any, mass: float) -> None:
    body.mass, body.inertia, body.explicitinertial = mass, (1e-2, 1e-2, 1e-2), True


def _quaternion(axes: np.ndarray) -> np.ndarray:
    import mujoco

    found = np.empty(4)
    mujoco.mju_mat2Quat(found, np.ascontiguousarray(axes).ravel())
    return found
