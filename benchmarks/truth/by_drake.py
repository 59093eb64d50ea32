"""The problems in Drake, from their URDF files, with point contact of compliant feet."""

from dataclasses import dataclass
from time import process_time

import numpy as np

from benchmarks.truth.problem_files import urdf
from benchmarks.truth.problems import Motion, Scene


@dataclass(frozen=True)
class Drake:
    """Settings of the discrete plant: stiffness of a foot [N/m], speed below which it sticks [m/s]."""

    step: float = 1e-3
    approximation: str = "lagged"
    stiffness: float = 1e6
    stiction: float = 1e-3

    def run(self, scene: Scene) -> tuple[Motion, float]:
        """Return the motion and the CPU time of its loop [s]."""
        from pydrake.multibody.parsing import Parser
        from pydrake.multibody.plant import AddMultibodyPlant, MultibodyPlantConfig
        from pydrake.multibody.tree import PdControllerGains
        from pydrake.systems.analysis import Simulator
        from pydrake.systems.framework import DiagramBuilder

        builder = DiagramBuilder()
        plant, _ = AddMultibodyPlant(
            MultibodyPlantConfig(
                time_step=self.step,
                contact_model="point",
                discrete_contact_approximation=self.approximation,
                stiction_tolerance=self.stiction,
            ),
            builder,
        )
        (instance,) = Parser(builder).AddModelsFromString(urdf(scene, self.stiffness), "urdf")
        plant.mutable_gravity_field().set_gravity_vector(scene.gravity)
        joint = plant.GetJointByName(scene.observed)
        if scene.drive:
            actuator = plant.GetJointActuatorByName("drive")
            actuator.set_controller_gains(PdControllerGains(p=scene.drive.stiffness, d=scene.drive.damping))
        plant.Finalize()
        simulator = Simulator(builder.Build())
        context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
        count = round(scene.seconds / self.step)
        found = np.zeros((count, 4))
        wanted = plant.get_desired_state_input_port(instance) if scene.drive else None
        effort = plant.get_net_actuation_output_port(instance) if scene.drive else None
        simulator.Initialize()
        start = process_time()
        for i in range(count):
            time = (i + 1) * self.step
            if scene.drive and wanted is not None:
                wanted.FixValue(context, [scene.drive.target(time), 0.0])
            simulator.AdvanceTo(time)
            place, rate = (
                plant.GetPositions(context)[joint.position_start()],
                plant.GetVelocities(context)[joint.velocity_start()],
            )
            force = 0.0 if effort is None else float(effort.Eval(context)[0])
            found[i] = time, place, rate, force
        return Motion(*found.T), process_time() - start
