"""Importing the package, `--help` and `describe` must not wait for the libraries that simulate and draw."""

import subprocess
import sys

import pytest

import rps_exudyn

HEAVY = "exudyn numba llvmlite matplotlib h5py trimesh manifold3d"


def loaded_after(code: str) -> set[str]:
    """Which of the heavy libraries a fresh interpreter has loaded after this code."""
    probe = f"{code}\nimport sys\nprint('loaded:', *(set(sys.modules) & set('{HEAVY}'.split())))"
    done = subprocess.run([sys.executable, "-c", probe], capture_output=True, text=True, check=True)
    return set(done.stdout.rpartition("loaded:")[2].split())


def test_import_loads_nothing_heavy_and_no_numpy() -> None:
    assert loaded_after("import rps_exudyn, sys; assert 'numpy' not in sys.modules") == set()


@pytest.mark.parametrize(
    "arguments",
    [
        ["--help"],
        ["run", "--help"],
        ["fit", "--help"],
        ["geometry", "--help"],
    ],
)
def test_quick_commands_load_nothing_heavy(arguments: list[str]) -> None:
    assert loaded_after(f"from rps_exudyn.cli.main import main; assert main({arguments}) == 0") == set()


@pytest.mark.parametrize("arguments", [["describe"], ["describe", "yoke.preload"], ["describe", "--json"]])
def test_list_of_parameters_does_without_numpy_and_the_library_of_the_help(arguments: list[str]) -> None:
    """Each of them takes a quarter of the 0.3 s that the command may take."""
    probe = f"from rps_exudyn.cli.main import main; assert main({arguments}) == 0; import sys"
    assert loaded_after(f"{probe}; assert not set(sys.modules) & {{'numpy', 'rich'}}") == set()


def test_public_names_are_there_when_used() -> None:
    assert {name: getattr(rps_exudyn, name).__name__ for name in rps_exudyn.__all__} == {
        name: name
        for name in (
            "Batch",
            "Fidelity",
            "Fit",
            "InputError",
            "Result",
            "Scene",
            "Status",
            "SteeringGear",
            "add_scene",
            "batch",
            "build_model",
            "compare_with_measured",
            "export",
            "fit",
            "load",
            "open_study",
            "optimise",
            "read_measured_torque",
            "run",
            "sensitivities",
            "study_frame",
            "tolerances",
            "window",
        )
    }


def test_parameters_load_nothing_heavy() -> None:
    assert loaded_after("import rps_exudyn; rps_exudyn.SteeringGear()") == set()


def test_exudyn_ignores_settings_of_the_user() -> None:
    """Exudyn reads this variable at its own import, which therefore has to come later."""
    assert loaded_after("import rps_exudyn, os; assert os.environ['EXUDYN_NO_USER_SETTINGS'] == '1'") == set()
