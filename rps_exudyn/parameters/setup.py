"""A gear and how it is modelled, as one set of parameters: what `--set` reaches and `describe` lists."""

from typing import ClassVar

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear


class Setup(SteeringGear):
    """The gear's tables, and the choices of its model as the table `fidelity`."""

    not_in_files: ClassVar[tuple[str, ...]] = ("fidelity",)

    fidelity: Fidelity = Fidelity()

    @property
    def steering_gear(self) -> SteeringGear:
        """The gear alone; its tables are not validated again."""
        return SteeringGear.model_construct(
            **{name: getattr(self, name) for name in SteeringGear.model_fields}
        )
