"""How many of the kernels that a work needs are compiled, as a row of the screen."""

from rps_exudyn.base.compiling import Step
from rps_exudyn.base.progress import duration


class CompilingProgress:
    """The latest count; its total never is less than the count."""

    def __init__(self) -> None:
        self.step = Step(0, 0, 0.0, 0.0)

    def take(self, step: Step) -> None:
        """Take a step."""
        self.step = step

    @property
    def is_done(self) -> bool:
        """Whether all that is known to be needed is compiled."""
        return self.step.done >= self.step.total

    @property
    def fraction(self) -> float:
        """Share of the time that is over."""
        whole = self.step.seconds + self.step.left
        return self.step.seconds / whole if whole else 0.0

    @property
    def text(self) -> str:
        """For instance "Compiling force laws, once: 46 of 146, 18 s left"."""
        left = duration(round(self.step.left))
        return f"Compiling force laws, once: {self.step.done} of {self.step.total}, {left} left"
