"""`run --band` and the study design `uncertain`, by the closed form: what they print and leave."""

import json
import re
import signal
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

import rps_exudyn as rps
from rps_exudyn.study.cases import describe
from rps_exudyn.study.study_file import read_study
from shell import Command

OPTIONS = ("--fidelity", "closed-form", "--out", "r.h5")


def test_band_is_printed_and_every_sample_kept(command: Command) -> None:
    settings = ("--set", "yoke.preload=300 N +- 10 %", "--set", "yoke.clearance=uniform(30 um, 60 um)")
    answer = command(["run", *OPTIONS, "--all", "--band", "64", *settings, "--set", "pinion.runout=32 um"])
    assert answer.status == 0
    assert "of 64 samples failed" in answer.out
    assert "exceeds yoke.clearance" in answer.out
    assert re.search(r"Contributions to torque_mean: yoke.preload (9\d|100) %", answer.out)
    assert "law line deviates by -1.2 to +0.32 %" in answer.out
    kept = json.loads(Path("r.band.json").read_text())
    assert kept["samples"] == len(kept["values"]["yoke.preload"]) == 64
    failed = sum(value is None for value in kept["values"]["torque_mean"])
    assert 0 < failed == sum(kept["failures"].values())
    known = [value for value in kept["values"]["torque_mean"] if value is not None]
    assert kept["figures"]["torque_mean"]["quantiles"][2] == pytest.approx(np.median(known))
    assert rps.load("r.h5").gear.yoke.preload == 300
    assert Path("r.png").stat().st_size > 10_000
    assert command(["report", "r.band.json"]).out == "written: r.band.html\n"
    page = Path("r.band.html").read_text()
    assert page.count("data:image/svg+xml;base64,") >= 2  # the curve with its band, for wide and narrow
    assert "in 90 % of gears" in page
    assert "Shares of the variance of the mean torque" in page
    assert "Make the band again" in page


def test_band_and_measured_points_are_one_picture(command: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    """A tenth above the nominal torque, in both directions, another turn on: what is left is that tenth."""
    path = ("--set", "test.path=there-and-back")
    assert command(["run", *OPTIONS, *path]).status == 0
    nominal = rps.load("r.h5")
    angle, torque = np.degrees(nominal["pinion_angle"]) + 360, 1.1 * nominal["pinion_torque"]
    rows = "\n".join(f"{a:.3f};{t:.6f}" for a, t in zip(angle, torque, strict=True))
    Path("m.csv").write_text(f"pinion_angle [deg]; pinion_torque [N m]\n{rows}\n")
    kept: list[Figure] = []
    monkeypatch.setattr("rps_exudyn.pages.charts.style.save", lambda figure, _: kept.append(figure))
    spread = ("--band", "16", "--set", "yoke.preload=300 N +- 10 %")
    answer = command(["run", *OPTIONS, *path, *spread, "--measured", "m.csv", "--overwrite"])
    assert answer.status == 0
    assert answer.out.count("10 % above the simulated one") == 2
    assert "in 90 % of gears" in answer.out
    assert len(answer.out.splitlines()) <= 8
    above, left, _ = kept[0].axes
    dots = np.concatenate([line.get_xydata() for line in above.lines if line.get_marker() == "o"])
    assert np.abs(dots[:, 1]).max() == pytest.approx(np.abs(torque).max(), rel=1e-3)
    assert dots[:, 0].max() <= 360 + 1e-6
    assert above.collections  # the band
    rest = np.concatenate([line.get_ydata() for line in left.lines if line.get_marker() == "o"])
    assert np.abs(rest).max() == pytest.approx(np.abs(torque).max() / 11, rel=1e-2)
    measured = rps.load("r.h5").measured
    assert measured is not None
    assert measured.name == "m"
    assert command(["report", "r.band.json"]).status == 0
    assert "Comparison with m<" in Path("r.band.html").read_text()


def test_interrupt_while_the_picture_is_drawn_names_the_files_that_are_there(
    command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        "rps_exudyn.pages.charts.inference.band_figure", lambda *_: signal.raise_signal(signal.SIGINT)
    )
    answer = command(["run", *OPTIONS, "--band", "16", "--set", "yoke.preload=300 N +- 9 N"])
    assert answer.status == 130
    assert answer.err.endswith("interrupted; r.h5, r.band.json are written, the rest is not.\n")
    assert rps.load("r.h5").gear.yoke.preload == 300


def test_band_as_json_and_files_that_were_there(command: Command) -> None:
    Path("r.h5").write_text("older")
    answer = command(["run", *OPTIONS, "--band", "16", "--set", "yoke.preload=300 N ± 9 N", "--json"])
    content = answer.json
    assert (answer.status, content["samples"]) == (0, 16)
    assert Path("r.1.h5").read_text() == "older"
    assert content["nominal"]["status"] == "ok"


def test_run_without_a_band_takes_the_median(command: Command) -> None:
    answer = command(["run", *OPTIONS, "--set", "yoke.preload=uniform(200 N, 600 N)"])
    assert "yoke.preload: the run uses the median of the distribution" in answer.err
    assert rps.load("r.h5").gear.yoke.preload == 400


def test_uncertain_study_has_an_axis_for_every_distribution(tmp_path: Path) -> None:
    """Those of the gear's file and of [set], unless an axis of its own varies the parameter."""
    (tmp_path / "g.toml").write_text('[yoke]\npreload = "300 N +- 30 N"\nfriction = "0.1 +- 10 %"\n')
    file = tmp_path / "s.toml"
    file.write_text(
        'design = "uncertain"\nsamples = 8\ngear = "g.toml"\nfidelity = "closed-form"\n'
        '[set]\nbush.drag = "lognormal(20 N, 1.2)"\n'
        '[[axis]]\npath = "yoke.friction"\nuniform = [0.05, 0.2]\n'
    )
    study = read_study(file)
    assert [axis.name for axis in study.axes] == ["yoke.friction", "yoke.preload", "bush.drag"]
    cases = describe(study, {}).cases
    assert len({case.hash for case in cases}) == 8
    drag = [float(case.values["bush.drag"]) for case in cases]
    assert 20 / 1.2**3 < min(drag) < 20 < max(drag) < 20 * 1.2**3
    file.write_text('design = "uncertain"\nsamples = 4\ninputs = "unknown"\n')
    assert len(read_study(file).axes) == 14
