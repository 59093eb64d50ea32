"""The command `fit` on the made-up curves that are shipped: what it prints, and the files it leaves."""

import re
import signal
import subprocess
import sys
from pathlib import Path
from time import process_time

import pytest

import rps_exudyn as rps
from rps_exudyn.simulate.cases.run_cases import cpu_time
from shell import Command, refusal_of

MADE_UP = Path(__file__).parents[2] / "studies" / "examples" / "measured"


@pytest.fixture
def files(command: Command) -> list[str]:
    return [str(MADE_UP / "made_up_free.csv"), f"yoke-out={MADE_UP / 'made_up_yoke_out.csv'}"]


def test_fit_prints_what_is_known_and_writes_its_files(command: Command, files: list[str]) -> None:
    made_up = Path(files[0]).read_text(encoding="utf-8")
    curve = re.sub("^-178,00;.*", "-178,00;", made_up, count=1, flags=re.M)
    Path("bench.csv").write_text(curve, encoding="utf-8")
    options = ["--single-law", "--plot", "fit.png", "--report", "fit.html"]
    answer = command(["fit", "bench.csv", files[1], "--all", *options])
    assert answer.status == 0
    assert "note: bench: 1 row without a value is left out: line 5\n" in answer.out
    assert "assumed: bench: pinion_torque from column 'Drehmoment [N cm]'" in answer.out
    assert "mean free torque 0.66" in answer.out
    assert "not separable by these tests: yoke.preload, mesh.friction, yoke.friction" in answer.out
    gear = rps.SteeringGear.from_toml("fitted.toml")
    assert gear.pinion.runout == pytest.approx(20e-6, abs=8e-6)
    assert "not separable" in Path("fitted.toml").read_text(encoding="utf-8")
    page = Path("fit.html").read_text(encoding="utf-8")
    assert page.count("<figure") == 2
    assert page.count('class="row open"') == 4
    assert "bench: 1 row without a value is left out: line 5." in page
    assert "yoke.preload x mesh.friction^0." in page
    assert Path("fit.png").stat().st_size > 20_000


def test_fit_prints_its_sheet_and_report_makes_the_page_of_its_data(
    command: Command, files: list[str]
) -> None:
    answer = command(["fit", *files, "--single-law", "--report", "fit.json"])
    lines = answer.out.splitlines()
    assert len(lines) <= 11
    places = ["plug", "once", "per"]
    assert [line.split()[0] for line in lines[-4:-1]] == places
    assert lines[0].startswith("Fit to measured curves: made_up_free, made_up_yoke_out")
    assert lines[1].strip().endswith("mean free torque (±: 95 % of the gear)")
    assert lines[1].split()[0].startswith("0.67")
    assert any(line.split()[:2] == ["not", "separable"] for line in lines)
    assert re.search(
        r"known +weighted product of yoke preload, .* to [0-9.]+ %, each alone is not", answer.out
    )
    assert "^" not in answer.out
    assert command(["report", "fit.json", "--out", "page.html"]).status == 0
    page = Path("page.html").read_text(encoding="utf-8")
    assert "mean free torque" in page
    assert 'class="gear"' in page


def test_the_sheet_of_a_fit_names_a_travel_beyond_the_teeth(command: Command) -> None:
    way = [10 * i for i in range(36)]  # mm
    rows = [f"{a},{f}" for f, path in ((109.0, way), (-108.0, way[::-1])) for a in path]
    Path("push.csv").write_text("\n".join(["rack travel [mm],force [N]", *rows]), encoding="utf-8")
    lines = command(["fit", "rack-push=push.csv", "--single-law"]).out.splitlines()
    assert len(lines) <= 8
    assert [" ".join(line.split()) for line in lines if line.split()[0] == "check"] == [
        "check push covers 350 mm of travel where the gear given has teeth for 151 mm: check the unit of its "
        "travel"
    ]


def test_the_next_gear_of_a_series_is_fitted_like_the_first(command: Command, files: list[str]) -> None:
    """Of the same curve the second fit has nothing left to do."""
    first = command(["fit", files[0], "--single-law", "--series", "series.json", "--json"])
    assert first.json["files"] == ["fitted.toml", "series.json"]
    second = command(["fit", files[0], "--like", "series.json", "--json", "--out", "next.toml"])
    assert second.json["simulations"] <= 3
    assert second.json["level"]["value"] == pytest.approx(first.json["level"]["value"], rel=1e-4)


def test_interrupt_while_the_picture_is_drawn_names_the_files_that_are_there(
    command: Command, files: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("rps_exudyn.pages.charts.style.save", lambda *_: signal.raise_signal(signal.SIGINT))
    options = ["--single-law", "--plot", "fit.png", "--series", "s.json", "--free", "yoke.preload"]
    answer = command(["fit", files[0], *options])
    assert answer.status == 130
    assert answer.err.endswith("interrupted; fitted.toml, s.json are written, the rest is not.\n")
    assert Path("fitted.toml").exists()
    assert Path("s.json").exists()
    assert not Path("fit.png").exists()


def test_fit_as_json(command: Command, files: list[str]) -> None:
    answer = command(["fit", files[0], "--single-law", "--json", "--free", "yoke.preload"])
    assert answer.json["estimates"]["yoke.preload"]["verdict"] == "follows from other priors"
    assert answer.json["converged"] is True
    rest = "made_up_free: 1 row is left out, line 364, where the angle stands still or jumps back"
    assert answer.json["left_out"] == [rest]
    assert answer.json["files"] == ["fitted.toml"]


def test_processes_share_the_simulations_of_a_fit(files: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """The passes of each simulation go to two processes; numbers are the same to the bit."""
    alone = rps.fit(files, free=["yoke.preload"], other_law=False)
    monkeypatch.setattr("rps_exudyn.simulate.cases.run_cases.STARTING", -1.0)
    monkeypatch.setattr("rps_exudyn.simulate.cases.run_cases.answer_to", None)  # nothing is done here
    shared = rps.fit(files, free=["yoke.preload"], other_law=False, jobs=2)
    assert shared.simulations == alone.simulations
    assert shared.estimate("yoke.preload") == alone.estimate("yoke.preload")


def test_a_simulation_beyond_its_time_limit_is_named(command: Command, files: list[str]) -> None:
    assert "no equilibrium at its initial guess: a run did not end" in refusal_of(
        command(["fit", files[0], "--single-law", "--jobs", "1", "--time-limit", "0.1 ms"])
    )


def test_cpu_time_holds_that_of_processes_that_have_ended() -> None:
    before = cpu_time(), process_time()
    subprocess.run([sys.executable, "-c", "sum(range(20_000_000))"], check=True)
    spent = cpu_time() - before[0]
    assert spent > process_time() - before[1] + 0.05


def test_a_file_that_is_given_twice_is_no_repeat(command: Command, files: list[str]) -> None:
    assert "is given twice for the same test" in refusal_of(
        command(["fit", files[0], files[0], "--single-law"])
    )
