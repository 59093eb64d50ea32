"""Files of others: nothing outside them is read, nothing endless, and no more than they can hold."""

import os
import re
import struct
import zlib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

import rps_exudyn as rps
from edited import edited
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import content_of
from rps_exudyn.gears.solids import rack_solid
from rps_exudyn.results.block import Block, CaseRecord, packed
from rps_exudyn.study.study_file import read_study
from shell import Command, refusal_of


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
    with edited(path) as file:
        change(file, secret)
    with pytest.raises(InputError, match=f"r.h5 is refused: .*{re.escape(reason)}"):
        rps.load(path)


def test_groups_that_hold_each_other_are_visited_once(made_up_result: rps.Result, tmp_path: Path) -> None:
    """Forty groups, each linked twice in the one before, are 2^40 paths; the last holds the first again."""
    path = tmp_path / "r.h5"
    made_up_result.save(path)
    with edited(path) as file:
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
        said = refusal_of(command(line.replace("{}", str(tmp_path / name)).split()))
        assert "Traceback" not in said
        assert f"{name} " in said
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


MAT_HEAD = b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<H", 0x100) + b"IM"
CELL, SIZES, NAME = 1, struct.pack("<IIii", 5, 8, 1, 1), struct.pack("<II", 1, 0)


def matrix(kind: int, sizes: bytes, content: bytes) -> bytes:
    body = struct.pack("<IIII", 6, 8, kind, 0) + sizes + NAME + content
    return struct.pack("<II", 14, len(body)) + body


def test_cells_within_cells_are_refused(tmp_path: Path) -> None:
    """On a hundred thousand levels scipy's reader ends the process."""
    one = matrix(CELL, SIZES, b"")
    head, levels, size = one[8:], [one], len(one)
    for _ in range(10**5):
        size += len(head)
        levels.append(struct.pack("<II", 14, size) + head)
        size += 8
    content = b"".join(reversed(levels))
    packed = zlib.compress(content)
    compressed = struct.pack("<II", 15, len(packed)) + packed
    for each in (content, compressed):
        (tmp_path / "m.mat").write_bytes(MAT_HEAD + each)
        with pytest.raises(InputError, match=r"m.mat is a damaged file of MAT"):
            rps.read_measured_torque(tmp_path / "m.mat")


def test_a_matrix_of_more_cells_than_bytes_is_refused(tmp_path: Path) -> None:
    """Room for its cells is made before the first one is read: its reader's process has not as much."""
    sizes = struct.pack("<IIii", 5, 8, 2**31 - 1, 1)
    (tmp_path / "m.mat").write_bytes(MAT_HEAD + matrix(CELL, sizes, b""))
    with pytest.raises(InputError, match=r"m.mat needs more memory than there is"):
        rps.read_measured_torque(tmp_path / "m.mat")


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (".".join(["a"] * 10**5) + " = 1", "it has a key of more than 50 parts"),
        (f"[{'.'.join(['yoke'] * 3000)}]", "it has a key of more than 50 parts"),
        ("x = " + "{a.b.c.d = " * 20 + "1" + "}" * 20, "its text is nested more than 50 levels deep"),
        ("x = " + "[" * 300 + "]" * 300, "its text is nested more than 50 levels deep"),
    ],
)
def test_deep_keys_are_no_gear(text: str, reason: str, tmp_path: Path, command: Command) -> None:
    (tmp_path / "g.toml").write_text(text)
    assert reason in refusal_of(command(["run", "--gear", str(tmp_path / "g.toml")]))


def test_names_of_others_cannot_command_a_terminal(tmp_path: Path, command: Command) -> None:
    (tmp_path / "g.toml").write_text('[yoke]\n"\\u001b[31mred" = 1\n')
    assert r"yoke.\x1b[31mred is no parameter" in refusal_of(
        command(["run", "--gear", str(tmp_path / "g.toml")])
    )


def test_a_message_names_some_of_many_mistakes(tmp_path: Path) -> None:
    (tmp_path / "g.toml").write_text("[yoke]\n" + "".join(f"k{i} = 1\n" for i in range(1000)))
    with pytest.raises(InputError, match="950 more values are wrong"):
        rps.SteeringGear.from_toml(tmp_path / "g.toml")
    titles = ";".join(f"c{i}" for i in range(1000))
    (tmp_path / "m.csv").write_text(f"{titles}\n" + f"{';'.join(['1'] * 1000)}\n" * 9)
    with pytest.raises(InputError, match=r"only c0, .*c29, 970 more; name one"):
        rps.read_measured_torque(tmp_path / "m.csv")


def test_a_million_values_of_an_axis_are_refused(tmp_path: Path) -> None:
    values = ", ".join(map(str, range(10**6)))
    (tmp_path / "s.toml").write_text(f'[[axis]]\npath = "yoke.preload"\nvalues = [{values}]')
    with pytest.raises(InputError, match=r"axis 1 \(yoke.preload\) has 1000000 values \(limit 100000\)"):
        read_study(tmp_path / "s.toml")
