"""The scene in Drake: hydroelastic contact of the pinion's mesh with the rack's teeth.

The pinion's flanks are a rigid mesh, each rack tooth is a compliant convex body. Drake fills a convex body
with tetrahedra around its centroid and with a pressure that grows linearly from 0 at the surface to the
modulus E there, so that behind a face at the distance h from the centroid the pressure per depth is E / h:
the scene's law, exactly, with E = stiffness x h.
"""

from dataclasses import dataclass
from time import process_time
from typing import Any

import numpy as np

from benchmarks.peers import scene
from benchmarks.peers.geometry import BAR, SIDES, TEETH, pinion_flanks, rack_tooth


@dataclass(frozen=True)
class Drake:
    """Drake with settings."""

    chord_error: float  # of the pinion's mesh [m]
    step: float  # [s]
    approximation: str = "lagged"
    surface: str = "polygon"  # polygon or triangle: what a piece of the contact surface is
    longest: float = 0.0  # longest edge of the pinion's triangles; 0: from end to end of a generator [m]

    program = "Drake, hydroelastic"

    @property
    def label(self) -> str:
        """Settings."""
        cut = f", edges to {1e3 * self.longest:g} mm" if self.longest else ""
        return (
            f"chord error {1e6 * self.chord_error:g} um{cut}, step {1e3 * self.step:g} ms, "
            f"{self.approximation}, {self.surface}s"
        )

    def run(self, turned: float) -> scene.Run:
        """Run over an angle [rad], as `Method` says."""
        start = process_time()
        simulator, plant = self._simulator()
        context = simulator.get_mutable_context()
        own = plant.GetMyMutableContextFromRoot(context)
        pinion, slide_x, slide_y = (plant.GetJointByName(name) for name in ("turn", "x", "y"))
        pinion.set_angle(own, scene.START[0])
        pinion.set_angular_rate(own, scene.RATES[0])
        slide_x.set_translation(own, scene.START[1])
        slide_x.set_translation_rate(own, scene.RATES[1])
        slide_y.set_translation(own, scene.START[2])
        forces = plant.get_generalized_contact_forces_output_port(plant.GetModelInstanceByName("gear"))
        steps = scene.steps_of(turned, self.step)
        angle, torque = np.empty(steps), np.empty(steps)
        loop = process_time()
        try:
            simulator.Initialize()
            for i in range(steps):
                simulator.AdvanceTo((i + 1) * self.step)
                angle[i], torque[i] = pinion.get_angle(own), -forces.Eval(own)[pinion.velocity_start()]
        except RuntimeError as error:
            raise ArithmeticError(f"Drake: {error}") from error
        end = process_time()
        scene.check_mesh("Drake", slide_y.get_translation(own))
        return scene.Run(angle, torque, end - loop, end - start)

    def _simulator(self) -> tuple[Any, Any]:
        from pydrake import geometry
        from pydrake.math import RigidTransform, RotationMatrix
        from pydrake.multibody import plant as plants
        from pydrake.multibody.tree import PrismaticJoint, RevoluteJoint, SpatialInertia, UnitInertia
        from pydrake.systems.analysis import Simulator
        from pydrake.systems.framework import DiagramBuilder

        builder = DiagramBuilder()
        config = plants.MultibodyPlantConfig(
            time_step=self.step,
            contact_model="hydroelastic",
            discrete_contact_approximation=self.approximation,
            contact_surface_representation=self.surface,
        )
        plant, _ = plants.AddMultibodyPlant(config, builder)
        plant.mutable_gravity_field().set_gravity_vector([0, -scene.PRELOAD / scene.RACK_MASS, 0])
        gear = plant.AddModelInstance("gear")

        def body(name: str, mass: float, inertia: float) -> Any:
            unit = UnitInertia.SolidSphere(np.sqrt(2.5 * inertia / mass))
            return plant.AddRigidBody(name, gear, SpatialInertia(mass, np.zeros(3), unit))

        friction = plants.CoulombFriction(scene.FRICTION, scene.FRICTION)
        pinion = body("pinion", 1.0, scene.FLYWHEEL)
        frame = RigidTransform(RotationMatrix(scene.PAIR.pinion_frame), np.zeros(3))
        plant.AddJoint(RevoluteJoint("turn", _fixed(plant, "axis", frame), pinion.body_frame(), [0, 0, -1]))
        rigid = geometry.ProximityProperties()
        geometry.AddRigidHydroelasticProperties(rigid)
        geometry.AddContactMaterial(0.0, None, friction, rigid)
        plant.RegisterCollisionGeometry(
            pinion, RigidTransform(), _mesh(self.chord_error, self.longest), "flanks", rigid
        )
        between, rack = body("between", 1e-6, 1e-9), body("rack", scene.RACK_MASS, 1e-2)
        axis = _fixed(plant, "bar", RigidTransform([0, scene.PAIR.bar_axis_height, 0]))
        plant.AddJoint(PrismaticJoint("x", axis, between.body_frame(), [1, 0, 0]))
        plant.AddJoint(PrismaticJoint("y", between.body_frame(), rack.body_frame(), [0, 1, 0]))
        for tooth in TEETH:
            self._add_tooth(plant, rack, tooth, friction)
        plant.Finalize()
        return Simulator(builder.Build()), plant

    def _add_tooth(self, plant: Any, rack: Any, tooth: int, friction: Any) -> None:
        from pydrake import geometry
        from pydrake.math import RigidTransform

        vertices, faces = rack_tooth(tooth)
        compliant = geometry.ProximityProperties()
        modulus = scene.STIFFNESS * _depth_of_centroid(tooth, vertices, faces)
        geometry.AddCompliantHydroelasticProperties(1.0, modulus, compliant)
        geometry.AddContactMaterial(0.0, None, friction, compliant)
        shape = geometry.Convex(vertices.T, f"tooth {tooth}")
        plant.RegisterCollisionGeometry(rack, RigidTransform(), shape, f"tooth {tooth}", compliant)


def _fixed(plant: Any, name: str, where: Any) -> Any:
    from pydrake.multibody.tree import FixedOffsetFrame

    return plant.AddFrame(FixedOffsetFrame(name, plant.world_frame(), where))


def _depth_of_centroid(tooth: int, vertices: np.ndarray, faces: np.ndarray) -> float:
    """Distance of the centroid around which Drake puts the tetrahedra from the flanks [m]."""
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    volumes = np.einsum("ij,ij->i", a, np.cross(b, c))
    centroid = volumes @ (a + b + c) / (4 * volumes.sum())
    flanks = [BAR.flank(tooth, side) for side in SIDES]
    return float(np.mean([flank.normal @ (flank.point - centroid) for flank in flanks]))


def _mesh(chord_error: float, longest: float) -> Any:
    from pydrake import geometry
    from pydrake.common import MemoryFile

    vertices, faces = pinion_flanks(chord_error)
    if longest:
        import trimesh

        vertices, faces = trimesh.remesh.subdivide_to_size(vertices, faces, longest)
    rows = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
    rows += [f"f {a} {b} {c}" for a, b, c in (faces + 1).tolist()]
    source = geometry.InMemoryMesh(mesh_file=MemoryFile("\n".join(rows) + "\n", ".obj", "pinion"))
    return geometry.Mesh(source)
