"""The report's section about bands of an uncertain study."""

from pathlib import Path

import numpy as np
import pytest

from made_up_study import description, make_study, sampled
from rps_exudyn.pages.report.study_page import band_blocks, study_page
from rps_exudyn.results.page_blocks import Fold, Warning
from rps_exudyn.results.result import Result
from rps_exudyn.results.sheet import Grid
from rps_exudyn.study.store import Store
from rps_exudyn.study.table import CaseTable

POINTS = [
    {"preload": 300.0 + 100 * (np.sqrt(5) * i % 1), "friction": 0.1 + 0.02 * (np.sqrt(2) * i % 1)}
    for i in range(40)
]


def test_uncertain_study_has_quantiles_contributions_and_its_failures(
    tmp_path: Path, made_up_result: Result
) -> None:
    """Torque = preload x friction: 300 to 400 N make a range of 29 %, 0.1 to 0.12 of 18 %: 0.29^2 / (0.29^2 +
    0.18^2) = 0.72 of the variance; 40 points leave a tenth to chance."""
    failed = {3: "it broke", 7: "it broke"}
    folder = make_study(tmp_path / "s", made_up_result, sampled(POINTS, "uncertain"), failed=failed)
    table = CaseTable.of(Store.open(folder))
    warning, quantiles, fold = band_blocks(table, ["torque_mean"])
    assert isinstance(warning, Warning)
    assert warning.text.startswith("2 of 40 samples failed")
    assert isinstance(quantiles, Grid)
    known = [p["preload"] * p["friction"] / 100 for i, p in enumerate(POINTS) if i not in failed]
    assert quantiles.rows[0][3] == f"{np.median(known):.4g} N m"
    assert isinstance(fold, Fold)
    (shares,) = fold.blocks
    assert isinstance(shares, Grid)
    assert shares.rows[0][0] == "preload"
    assert float(str(shares.rows[0][1]).rstrip("%")) == pytest.approx(72, abs=10)


def test_other_designs_have_no_bands(tmp_path: Path, made_up_result: Result) -> None:
    folder = make_study(tmp_path / "s", made_up_result, description(POINTS[:4]))
    assert "Bands" not in [section.title for section in study_page(Store.open(folder)).sections]
