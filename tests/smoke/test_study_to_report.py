"""The whole way of a study: run, opened, collected, reported, with indices."""

import re
from pathlib import Path

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.study.collected import read_table
from shell import Command

STUDY = """
title = "Screening"
scene = "free-pinion-torque"
fidelity = "quasi-static"
design = "morris"
samples = 3
seed = 1
[set]
test.turns = 0.2
[[axis]]
name = "preload"
path = "yoke.preload"
uniform = ["200 N", "400 N"]
[[axis]]
name = "friction"
paths = ["mesh.friction", "yoke.friction"]
uniform = [0.05, 0.15]
[keep]
signals = ["pinion_torque"]
samples = 21
"""


def test_study_run_opened_collected_and_reported(tmp_path: Path, command: Command) -> None:
    pytest.importorskip("SALib")
    (tmp_path / "screening.toml").write_text(STUDY, encoding="utf-8")
    assert command(["study", "screening.toml", "--jobs", "1"]).status == 0
    study = rps.open_study("screening")
    assert set(study.status.values) == {"ok"}
    assert study.pinion_torque.shape == (9, 21)
    same = rps.load(tmp_path / "screening" / "cases" / f"{study.hash[4].item()}.h5")
    assert study.torque_mean[4] == same.summary["torque_mean"]
    np.testing.assert_array_equal(study.pinion_torque[4], same["pinion_torque"])
    assert same.gear.yoke.preload == study.preload[4]
    assert study.torque_mean_error[4] == same.errors["torque_mean"] > 0
    assert study.torque_mean_error.attrs == {"units": "N*m", "long_name": "numerical error of torque_mean"}
    assert "torque_closed_form_error" not in study  # which follows from a formula
    command(["collect", "screening"])
    table = read_table(tmp_path / "screening" / "table.h5")
    np.testing.assert_array_equal(table["summary"]["torque_mean_error"], study.torque_mean_error)
    np.testing.assert_array_equal(table["summary"]["torque_mean"], study.torque_mean)
    assert command(["report", "screening"]).status == 0
    page = (tmp_path / "screening" / "report.html").read_text(encoding="utf-8")
    assert "Sensitivity indices" in page
    assert re.search(r">0\.\d+ ± 0\.\d+ N m<", page)
    assert "torque mean: from 3 groups of cases" in page
    assert "design = &#34;morris&#34;" in page  # the study file
