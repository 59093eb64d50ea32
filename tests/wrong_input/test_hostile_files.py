"""Files of others: nothing outside them is read, nothing endless, and no more than they can hold."""

import os
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

import rps_exudyn as rps
from made_up_study import make_study
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import content_of, without_checksum
from rps_exudyn.gears.solids import rack_solid
from rps_exudyn.results.block import Block, CaseRecord, packed
from rps_exudyn.study.study_file import read_study
from shell import Command


@pytest.fixture
def study(made_up_result: rps.Result, tmp_path: Path) -> Path:
    return make_study(tmp_path / "s", made_up_result)


def linked(file: h5py.File, secret: Path) -> None:
    del file["summary/torque_mean"]
    file["summary/torque_mean"] = h5py.ExternalLink(str(secret), "/")


def soft(file: h5py.File, _: Path) -> None:
    del file["summary/torque_mean"]
    file["summary/torque_mean"] = h5py.SoftLink("/signals/time")


def stored_outside(file: h5py.File, secret: Path) -> None:
    del file["signals/pinion_torque"]
    file.create_dataset("signals/pinion_torque", (1,), "f8", external=[(str(secret), 0, 8)])


def virtual(file: h5py.File, secret: Path) -> None:
    del file["signals/pinion_torque"]
    layout = h5py.VirtualLayout((4,), "f8")
    layout[:] = h5py.VirtualSource(str(secret), "x", (4,))
    file.create_virtual_dataset("signals/pinion_torque", layout)


def vast(file: h5py.File, _: Path) -> None:
    del file["signals/pinion_torque"]
    file.create_dataset("signals/pinion_torque", (10**12,), "f8", chunks=(1000,))


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (linked, "is a link, no data"),
        (soft, "is a link, no data"),
        (stored_outside, "lie in other files"),
        (virtual, "lie in other files"),
        (vast, "declares 8e+12 bytes of data"),
    ],
)
def test_a_result_holds_all_of_its_data(
    change: Callable[[h5py.File, Path], None], reason: str, made_up_result: rps.Result, tmp_path: Path
) -> None:
    secret, path = tmp_path / "secret.txt", tmp_path / "r.h5"
    secret.write_text("password")
    made_up_result.save(path)
    path.write_bytes(without_checksum(path.read_bytes()))
    assert rps.load(path).summary
    with h5py.File(path, "a") as file:
        change(file, secret)
    with pytest.raises(InputError, match=f"r.h5 is refused: .*{re.escape(reason)}"):
        rps.load(path)


def test_groups_that_hold_each_other_are_visited_once(made_up_result: rps.Result, tmp_path: Path) -> None:
    """Forty groups, each linked twice in the one before, are 2^40 paths; the last holds the first again."""
    path = tmp_path / "r.h5"
    made_up_result.save(path)
    path.write_bytes(without_checksum(path.read_bytes()))
    with h5py.File(path, "a") as file:
        first = group = file.create_group("first")
        for _ in range(40):
            inner = group.create_group("one")
            group["other"] = inner
            group = inner
        group["again"] = first
    assert rps.load(path).summary == made_up_result.summary


def test_constant_signals_pack_as_far_as_is_allowed(made_up_result: rps.Result, tmp_path: Path) -> None:
    """Deflate stores a thousand zeros in one byte: the bound lets them pass."""
    long = rps.Result(**{**vars(made_up_result), "signals": {"time": np.zeros(10**6)}, "measured": None})
    long.save(tmp_path / "r.h5")
    assert rps.load(tmp_path / "r.h5")["time"].size == 10**6


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes with names here")
@pytest.mark.parametrize(
    "line",
    ["show {}", "run --gear {}", "run --measured {}", "study {}", "fit {}", "diff {} {}", "fit {} --like {}"],
)
def test_what_may_never_end_is_refused(line: str, command: Command, tmp_path: Path) -> None:
    for name in ("pipe.h5", "pipe.toml", "pipe.csv"):
        os.mkfifo(tmp_path / name)
        answer = command(line.replace("{}", str(tmp_path / name)).split())
        assert answer.status == 2
        assert "Traceback" not in answer.err
        assert f"{name} " in answer.err
    with pytest.raises(InputError, match="cannot be read: it is a device, a pipe or a socket"):
        content_of("/dev/zero")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes with names here")
def test_pipe_as_a_study_file_is_left_out(study: Path, command: Command) -> None:
    (study / "study.toml").unlink(missing_ok=True)
    os.mkfifo(study / "study.toml")
    assert command(["report", str(study)]).status == 0


def test_endless_and_vast_files_are_refused(tmp_path: Path) -> None:
    with (tmp_path / "vast.csv").open("wb") as file:
        file.truncate(2**43)  # holes: it takes no room on the disk
    with pytest.raises(InputError, match=r"vast.csv cannot be read: it has 8.8e\+12 bytes"):
        content_of(tmp_path / "vast.csv")


def test_deep_json_of_a_block_is_damage(made_up_result: rps.Result, tmp_path: Path) -> None:
    """In a file whose checksum fits."""
    record = CaseRecord.of("0123456789abcdef", made_up_result)
    for name in ("findings", "parameters"):
        nested = {**record.attributes, name: '{"a":' * 10**5}
        (tmp_path / "0.h5").write_bytes(packed([replace(record, attributes=nested)]))
        with pytest.raises(InputError, match=rf"0.h5 is damaged: {name} is nested more than 50 levels"):
            Block.read(tmp_path / "0.h5").result("0123456789abcdef")


def test_deep_json_of_a_study_is_damage(study: Path) -> None:
    (study / "study.json").write_text('{"a":' * 10**5)
    with pytest.raises(InputError, match=r"study.json is damaged: its text is nested more than 50 levels"):
        rps.open_study(study)


def test_bodies_of_a_rack_of_kilometres_are_refused() -> None:
    gear = rps.SteeringGear().replace({"rack.length": "10 km", "rack.travel": "9 km"})
    with pytest.raises(InputError, match=r"rack.travel needs 1541\d{3} teeth on the rack"):
        rack_solid(gear)
    assert rack_solid(gear.replace({"rack.travel": "150 mm"})).mass_properties


def test_a_million_values_of_an_axis_are_refused(tmp_path: Path) -> None:
    values = ", ".join(map(str, range(10**6)))
    (tmp_path / "s.toml").write_text(f'[[axis]]\npath = "yoke.preload"\nvalues = [{values}]')
    with pytest.raises(InputError, match=r"axis 1 \(yoke.preload\) has 1000000 values \(limit 100000\)"):
        read_study(tmp_path / "s.toml")
