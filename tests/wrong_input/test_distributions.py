"""Distributions that cannot be, and bands that cannot be made: one sentence each."""

from pathlib import Path

import pytest

from rps_exudyn.base.errors import InputError
from rps_exudyn.inference.uncertainty.band import band_of_runs
from rps_exudyn.inference.uncertainty.input_sets import carried, uncertain_inputs
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.study.study_file import read_study


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("300 N +- -30 N", "normal must be [mean, standard deviation] with a deviation above 0"),
        ("300 N +- 0 N", "a deviation above 0"),
        ("300 N ± 0 %", "a deviation above 0"),
        ("uniform(400 N, 200 N)", "uniform must be [least, most] with least below most"),
        ("lognormal(300 N, 0.9)", "a factor above 1"),
        ("lognormal(-3 N, 1.2)", "a median above 0"),
        ("loguniform(0 N, 200 N)", "both above 0"),
        ("weibull(1 N, 2 N)", "a distribution is written"),
        ("300 N +- 3 mm", "no quantity in N"),
        ("300 N +-", "no quantity in N"),
    ],
)
def test_distribution_that_cannot_be(text: str, said: str) -> None:
    with pytest.raises(InputError) as refused:
        SteeringGear().replace({"yoke.preload": text})
    assert len(refused.value.problems) == 1
    assert refused.value.problems[0].startswith("yoke.preload is ")
    assert said in refused.value.problems[0]


@pytest.mark.parametrize("text", ["uniform(-1 N, 5 N)", "20 N +- 8 N"])
def test_distribution_beyond_the_limits_of_its_parameter(text: str) -> None:
    """A normal one ends at three standard deviations: 20 - 24 N is below 0."""
    with pytest.raises(InputError, match=r"distribution of bush.drag reaches -.* N; bush.drag must be"):
        carried({"bush": {"drag": text}}, {})


def test_settings_come_before_the_file() -> None:
    found = carried({"yoke": {"preload": "300 N +- 30 N"}}, {"yoke.preload": "uniform(1 N, 3 N)"})
    assert found["yoke.preload"].ends == (1.0, 3.0)
    assert carried({"yoke": {"preload": "300 N +- 30 N"}}, {"yoke.preload": "200 N"}) == {}


def test_sets_and_samples_that_do_not_exist() -> None:
    gear, formula = SteeringGear(), Fidelity.preset("closed-form")
    with pytest.raises(
        InputError, match="the set of inputs is 'any'; it must be one of unknown, series, own"
    ):
        uncertain_inputs(gear, "any", {})
    with pytest.raises(InputError, match="no parameter carries a distribution"):
        uncertain_inputs(gear, "own", {})
    own = carried({}, {"yoke.preload": "300 N +- 30 N"})
    with pytest.raises(InputError, match="3 samples; it needs 8 to 100000"):
        band_of_runs("free-pinion-torque", gear, formula, own, samples=3)


def test_too_many_failures_end_with_their_cause() -> None:
    """The formulas refuse every gear whose runout uses up the clearance."""
    own = carried({}, {"yoke.clearance": "uniform(1 um, 200 um)"})
    gear = SteeringGear().replace({"pinion.runout": "99 um"})
    with pytest.raises(
        InputError, match=r"[34] of 8 samples failed, too many for a band; .* formulas have no"
    ):
        band_of_runs("free-pinion-torque", gear, Fidelity.preset("closed-form"), own, samples=8)


def test_study_names_what_is_uncertain(tmp_path: Path) -> None:
    file = tmp_path / "s.toml"
    file.write_text('design = "grid"\ninputs = "series"\n[[axis]]\npath = "yoke.preload"\nvalues = [1]\n')
    with pytest.raises(InputError, match="inputs has no meaning for the design grid"):
        read_study(file)
    file.write_text('design = "uncertain"\nsamples = 4\n[set]\nyoke.preload = "300 N +- 200 N"\n')
    with pytest.raises(InputError, match=r"distribution of yoke.preload reaches -300 N"):
        read_study(file)
    file.write_text('design = "uncertain"\nsamples = 4\ninputs = "mine"\n')
    with pytest.raises(InputError, match="the set of inputs is 'mine'"):
        read_study(file)
