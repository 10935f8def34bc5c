"""A file that ends the library which reads it costs a line, and the next one is read."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from ssmr_ident.core.errors import InputError
from ssmr_ident.readers import apart_child, read, read_one
from ssmr_ident.readers.apart import Apart
from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.source import open_source

TIME = np.arange(40) / 100.0
DOUBLE, RESERVED = (9).to_bytes(4, "little"), (10).to_bytes(4, "little")


@pytest.fixture
def log(tmp_path: Path) -> Path:
    path = tmp_path / "log.mat"
    savemat(path, {"time_s": TIME, "force_N": np.sin(9.0 * TIME)})
    return path


@pytest.mark.slow
def test_a_type_that_ends_scipy_is_one_line_and_the_next_file_is_read(log: Path, tmp_path: Path) -> None:
    damaged = tmp_path / "damaged.mat"
    damaged.write_bytes(log.read_bytes().replace(DOUBLE, RESERVED))
    with pytest.raises(InputError, match="the library that reads it ended"):
        read(damaged)
    np.testing.assert_array_equal(read_one(log)["force"], np.sin(9.0 * TIME))


def test_names_and_hash_are_those_that_the_caller_has(log: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(log.parent)
    recording = read_one("log.mat")
    assert recording.provenance.file == "log.mat"
    assert recording.provenance.sha256 == open_source(log).digest.hex()
    nothing = io.BytesIO()
    savemat(nothing, {"text": "no numbers"})
    Path("empty.mat").write_bytes(nothing.getvalue())
    with pytest.raises(InputError, match=r"^empty\.mat"):
        read("empty.mat")


def test_what_comes_to_no_end_is_stopped(log: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ssmr_ident.readers.apart.PATIENCE", (0.0, 0.0))
    apart = Apart()
    with pytest.raises(InputError, match="came to no end"):
        apart.read(open_source(log), ReadOptions())
    apart.close()


def test_a_struct_of_more_members_than_bytes_is_refused_before_room_is_made_for_them(tmp_path: Path) -> None:
    file = tmp_path / "log.mat"
    savemat(file, {"run": {"t": np.arange(50.0), "force": np.arange(50.0)}})
    data = bytearray(file.read_bytes())
    assert int.from_bytes(data[160:164], "little") == 1  # rows of the struct, behind its flags
    data[163] = 0x10
    file.write_bytes(data)
    with pytest.raises(InputError, match="of 268435457 members in"):
        read(file)


def test_a_library_that_lost_its_way_has_met_a_damaged_file(log: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def lost(*_: object) -> None:
        raise SystemError("Negative size passed to PyUnicode_New")

    monkeypatch.setattr(apart_child, "reader_for", lost)
    folder = str(Path.cwd())
    assert apart_child._read(folder, str(log), None, ReadOptions()) is None
