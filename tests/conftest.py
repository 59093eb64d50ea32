"""Made-up results and an in-process command line, for tests that need no simulation; and the sets of tests.

    pytest -q            the everyday set: all but the long tests
    pytest -q -m quick   the tests that run no kernel, within a minute of CPU time
    pytest -q -m long    bad cases, pages as printed, kills, benchmarks, browsers: what takes minutes
    pytest -q FILE       all tests of a file

Two processes share the files. A test that needs a law of `verification`, which each process compiles by
numba, is long.
"""

import dataclasses
import os
import signal
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import settings

from cpu_limit import CpuLimit
from made_up_study import make_study
from rps_exudyn.cli.main import main
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.result import Result
from shell import Answer, Command

QUICK = (
    "contract",
    "geometry",
    "smoke",
    "wrong_input",
    "physics/test_bush.py",
    "physics/test_closed_form.py",
    "physics/test_effects.py",
    "physics/test_metrics.py",
    "stability/test_after_run.py",
)
SLOW = (  # files, or single tests, in the folders above that are not quick
    "smoke/test_real_runs.py",
    "contract/test_contributing.py::test_few_frames_stand_between_a_run_and_its_kernel",
    "contract/test_docstring_examples.py",
    "contract/test_libraries.py::test_a_run_leaves_the_libraries_as_they_were",
    "contract/test_limit_of_cpu_time.py",
    "smoke/test_optimise.py",
    "wrong_input/test_optimisation.py",
    "contract/test_kernel_code.py",
    "contract/test_newton_step.py",
    "geometry/test_brep.py",
    "geometry/test_geometry_picture.py",
    "geometry/test_mesh_frames.py",
    "geometry/test_pinion_mesh.py",
    "geometry/test_rigid_mesh.py",
    "geometry/test_shaping.py",
    "geometry/test_variable_ratio.py",
    "geometry/test_solids.py",
    "geometry/test_tooth_stiffness.py::test_line_rests_as_teeth_that_bend",
    "physics/test_bush.py::test_a_bar_in_the_bush_is_held_as_by_a_cantilever",
    "physics/test_closed_form.py::test_friction_larger_at_rest_is_beyond_the_formulas",
    "smoke/test_animation.py",
    "smoke/test_animation_in_browser.py",
    "smoke/test_band_command.py::test_band_and_measured_points_are_one_picture",
    "smoke/test_band_command.py::test_band_is_printed_and_every_sample_kept",
    "smoke/test_blocks.py::test_page_about_a_case_in_a_block_has_a_place",
    "smoke/test_cluster.py",
    "smoke/test_commands.py::test_geometry_writes_solids_or_drawing",
    "smoke/test_commands.py::test_overwritten_files_leave_no_others_and_quiet_runs_no_words",
    "smoke/test_examples.py",
    "smoke/test_explore.py",
    "smoke/test_first_steps.py",
    "smoke/test_fit.py",
    "smoke/test_law_error.py::test_page_says_it",
    "smoke/test_one_entry.py",
    "smoke/test_pictures.py",
    "smoke/test_progress.py::test_check_counts_the_samples_of_all_its_bands",
    "smoke/test_progress.py::test_motion_in_exudyn_tells_how_much_is_done",
    "smoke/test_reader.py",
    "smoke/test_report.py",
    "smoke/test_report_in_browser.py",
    "smoke/test_scene_pictures.py::test_a_result_keeps_the_measured_torque_and_report_and_show_have_it",
    "smoke/test_sheet.py::test_header_of_a_band_counts_medians_apart_and_its_law_is_stated",
    "smoke/test_sheet.py::test_run_prints_the_sheet_of_the_readme",
    "smoke/test_studies.py",
    "smoke/test_study_to_report.py",
    "wrong_input/test_accuracy.py::test_metrics_that_the_scene_does_not_have",
    "wrong_input/test_corpus_of_bad_inputs.py",
    "wrong_input/test_damaged_files.py::test_tables_nested_without_end_are_no_traceback",
    "wrong_input/test_environment.py",
    "wrong_input/test_full_disk.py",
    "wrong_input/test_hostile_files.py::test_pipe_as_a_study_file_is_left_out",
    "wrong_input/test_measured_flanks.py::test_file_is_sought_beside_the_gear_and_kept_in_its_result",
    "wrong_input/test_surfaces.py",
    "wrong_input/test_retired.py::test_result_of_a_retired_choice_is_read_and_not_run_again",
    "wrong_input/test_studies_read.py::test_sensitivity_without_salib_says_what_to_install",
)
LONG = (  # files, folders or single tests that the everyday set leaves out
    "benchmarks",
    "contract/test_kernel_code.py::test_all_laws_are_those_of_numba_bit_for_bit",
    "contract/test_kernel_code.py::test_where_it_does_not_fit_numba_makes_the_same_and_says_why",
    "contract/test_limit_of_cpu_time.py",
    "physics/test_accuracy_methods.py",
    "physics/test_convergence.py",
    "physics/test_fit.py::test_a_runout_is_found_beside_a_bow",
    "physics/test_plan_reference.py",
    "physics/test_yoke_damping.py::test_impact_with_an_o_ring_is_that_of_a_plane_model",
    "physics/test_yoke_damping.py::test_rattle_with_an_o_ring_is_that_of_a_plane_model",
    "physics/test_sampler.py::test_every_scene_law_and_choice_is_drawn_in_plans",
    "smoke/test_animation_in_browser.py",
    "smoke/test_cluster.py",
    "smoke/test_examples.py::test_notebook_runs",
    "smoke/test_explore.py::test_crowd_is_answered_beside_a_slow_state",
    "smoke/test_explore.py::test_dynamics_and_the_gear_in_three_dimensions",
    "smoke/test_explore.py::test_page_in_a_browser",
    "smoke/test_explore.py::test_sheet_picture_and_pattern_are_those_of_the_state",
    "smoke/test_explore.py::test_state_is_in_the_address_and_a_file_can_be_dropped",
    "smoke/test_first_steps.py",
    "smoke/test_one_entry.py",
    "smoke/test_pictures.py",
    "smoke/test_reader.py",
    "smoke/test_report_in_browser.py",
    "stability",
    "upstream",
    "wrong_input/test_environment.py::test_runs_and_studies_need_nothing_that_windows_lacks",
)
PROCESSES = 2

# Property tests draw the same cases every time, and a slow machine fails none of them
settings.register_profile("repeatable", derandomize=True, deadline=None)
settings.load_profile("repeatable")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--update-references",
        action="store_true",
        help="write the values of tests/regression anew and print what changed",
    )
    parser.addini("cpu_limit", "CPU time of a test and its children [s]", default="inf")


def _names_files(config: pytest.Config) -> bool:
    """Return whether the command names files, not folders."""
    return all(".py" in Path(name).name for name in config.args)


def pytest_xdist_auto_num_workers(config: pytest.Config) -> int:
    """Two processes for folders; files and quick tests are done sooner than a second process has started."""
    alone = config.option.markexpr == "quick" or _names_files(config)
    return 0 if alone else min(PROCESSES, os.cpu_count() or 1)


def pytest_configure(config: pytest.Config) -> None:
    """Limit the tests' CPU time; one that runs a kernel fails where only quick ones are wanted.

    Ctrl-C interrupts, also where a shell started the tests in the background, whose processes ignore it.
    """
    signal.signal(signal.SIGINT, signal.default_int_handler)
    config.pluginmanager.register(CpuLimit(float(config.getini("cpu_limit"))))
    if config.option.markexpr == "quick":
        from rps_exudyn.base import kernel_code

        setattr(kernel_code, "address_of", refuse)  # noqa: B010, for mypy


def refuse(entry: Any) -> None:
    """Fail a test that runs a kernel."""
    pytest.fail(f"runs {entry.name}: list it as SLOW in tests/conftest.py")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Mark quick and long tests."""
    for item in items:
        name = item.nodeid.removeprefix("tests/")
        if name.startswith(LONG):
            item.add_marker("long")
        if name.startswith(QUICK) and not name.startswith(SLOW):
            item.add_marker("quick")
    if not config.option.markexpr and not _names_files(config):
        left_out = [item for item in items if item.get_closest_marker("long")]
        config.hook.pytest_deselected(items=left_out)
        items[:] = [item for item in items if not item.get_closest_marker("long")]


@pytest.fixture
def made_up_result() -> Result:
    """One revolution with plausible torque, lift and roll; no simulation behind it."""
    angle = np.linspace(0, 2 * np.pi, 121)
    return Result(
        scene="free-pinion-torque",
        gear=SteeringGear(),
        fidelity={"name": "flank", "mesh": "flank"},
        solver={"name": "generalized-alpha", "step": 1e-3},
        status=Status.OK,
        signals={
            "time": angle / 1.57,
            "pinion_angle": angle,
            "pinion_torque": 0.6 + 0.01 * np.cos(6 * angle),
            "rack_displacement": 0.0056 * angle,
            "rack_y": 3e-6 * np.cos(angle),
            "rack_roll": 1e-3 + 1e-4 * np.cos(angle),
            "mesh_normal_force_drive": np.full_like(angle, 450.0),
            "work_drive": 0.6 * angle,
            "work_mesh_friction": 0.3 * angle,
            "work_bearing_friction": 0.03 * angle,
        },
        summary={"torque_mean": 0.6, "torque_peak_to_peak": 0.02, "rack_gain": 0.035},
        errors={"torque_mean": 0.0012, "torque_peak_to_peak": 0.001},
        counters={"steps": 120, "newton_iterations": 250},
        cpu_s=1.5,
        wall_s=2.0,
    )


@pytest.fixture
def study(made_up_result: Result, tmp_path: Path) -> Path:
    """Folder `s` of a made-up study that has ended."""
    return make_study(tmp_path / "s", made_up_result)


@pytest.fixture
def failed_result(made_up_result: Result) -> Result:
    return dataclasses.replace(made_up_result, status=Status.DIVERGED, message="NaN at t = 0.1 s.")


@pytest.fixture
def command(capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Command:
    """`rps-exudyn` with these arguments, in an empty folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("FORCE_COLOR", raising=False)  # which makes lines as short as a terminal's

    def call(arguments: Sequence[str]) -> Answer:
        status = main(list(arguments))
        captured = capsys.readouterr()
        return Answer(status, captured.out, captured.err)

    return call
