"""Production batches: scatter between gears, both risks of limits, drift; curves by a formula."""

from pathlib import Path
from time import process_time

import numpy as np
import pytest

from rps_exudyn.base.errors import InputError
from rps_exudyn.inference.fitting.production import (
    FALSE_ALARMS,
    GUARD,
    MeasuredGear,
    drift_of,
    lot_of,
)
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.limit import Limit
from shell import Command, refusal_of
from verification.bench_curves import folder_of

MEAN, SCATTER, OWN = 0.65, 0.07, 0.02


def drawn(seed: int, count: int = 60, scatter: float = SCATTER, slope: float = 0.0) -> list[MeasuredGear]:
    """Gears with levels about the mean, that drift by `slope` of it over the batch."""
    random = np.random.default_rng(seed)
    true = MEAN * (1 + scatter * random.standard_normal(count) + slope * np.linspace(-0.5, 0.5, count))
    levels = true * (1 + OWN * random.standard_normal(count))
    return [MeasuredGear(f"{i}", float(each), OWN * float(each), None) for i, each in enumerate(levels)]


def test_the_scatter_between_gears_is_found_without_that_of_the_measurement() -> None:
    """Of 40 batches at least 34 intervals hold; without scatter its median is below the measurement's."""
    held = sum(
        found.scatter[1] <= SCATTER <= found.scatter[2]
        for found in (lot_of(drawn(seed), SteeringGear()) for seed in range(40))
    )
    assert held >= 34
    assert lot_of(drawn(1, scatter=0.0), SteeringGear()).scatter[0] < 0.7 * OWN


def test_a_gears_level_is_drawn_to_the_mean_as_far_as_it_is_uncertain() -> None:
    found = lot_of(drawn(2), SteeringGear())
    levels = np.array([each.level for each in found.gears])
    share = np.log(found.expected / found.mean) / np.log(levels / found.mean)
    assert share == pytest.approx(found.scatter[0] ** 2 / (found.scatter[0] ** 2 + OWN**2), rel=1e-6)


def test_both_risks_are_those_of_drawn_gears() -> None:
    """Against two million drawn gears; guard bands lower the consumer's risk and raise the producer's."""
    found, tolerance = lot_of(drawn(3), SteeringGear()), Limit(0.55, 0.75, "")
    random = np.random.default_rng(0)
    true = found.mean * (1 + found.scatter[0] * random.standard_normal(2_000_000))
    shown = true + np.hypot(found.sd, 0.005 * found.mean) * random.standard_normal(true.size)
    for guard in (0.0, GUARD * found.sd):
        risks = found.risks(tolerance, guard)
        accepted, good = risks.limits.keeps(shown), tolerance.keeps(true)
        assert risks.consumer == pytest.approx((accepted & ~good).mean(), rel=0.03, abs=2e-5)
        assert risks.producer == pytest.approx((~accepted & good).mean(), rel=0.03)
    assert found.risks(tolerance, GUARD * found.sd).consumer < 0.2 * found.risks(tolerance, 0.0).consumer
    with pytest.raises(InputError, match="is smaller than the guard bands"):
        found.risks(Limit(0.64, 0.66, ""), 0.02)


def test_drift_is_seen_and_false_alarms_are_rare() -> None:
    """1 % of batches without drift: of 100 at most 7. A drift of 15 % over 60 gears is seen in 18 of 20."""
    false = sum(
        drift_of(np.array([g.level for g in drawn(seed)]), seed).alarms.size > 0 for seed in range(100)
    )
    assert false <= 100 * FALSE_ALARMS + 6
    seen = sum(lot_of(drawn(seed, slope=0.30), SteeringGear()).drift.alarms.size > 0 for seed in range(20))
    assert seen >= 18


def test_the_command_judges_a_folder_and_names_what_it_cannot_read(command: Command, tmp_path: Path) -> None:
    (tmp_path / "line").mkdir()
    folder = folder_of(tmp_path / "line", 12, 2.0)
    (folder / "gear13.csv").write_text("angle [deg],torque\n0,1\n1,2\n")
    begun = process_time()
    written = ["--out", "line.csv", "--plot", "drift.svg"]
    done = command(["judge-batch", "line", "--tolerance", "0.5 N*m to 0.8 N*m", *written, "--jobs", "1"])
    assert process_time() - begun < 12 * 0.4 + 3
    assert done.status == 0, done.err
    assert "batch · 12 gears" in done.out
    assert "consumer's risk" in done.out
    assert "gives no unit of pinion_torque" in done.out
    rows = (tmp_path / "line.csv").read_text().splitlines()
    assert len(rows) == 13
    assert [row.split(",")[0] for row in rows[1:]] == [f"gear{i}" for i in range(1, 13)]
    (tmp_path / "none").mkdir()
    for wrong, sentence in (
        (["judge-batch", "none"], "holds 0 curves that can be read; a batch needs at least 5"),
        (["judge-batch", "absent"], "is no folder"),
        (["judge-batch", "line", "--tolerance", "wide"], "write for instance"),
        (["fit", "--batch", "line"], "use rps-exudyn judge-batch"),
        (["fit", "--tolerance", "0.5 N*m to 0.8 N*m"], "use rps-exudyn judge-batch"),
    ):
        assert sentence in refusal_of(command(wrong))
