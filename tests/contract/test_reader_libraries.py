"""Formats through their libraries: written with the library, read back; a word on a library that is missing."""

from __future__ import annotations

import io
import json
import sys
import zipfile
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from ssmr_ident.core.errors import InputError
from ssmr_ident.readers import ReadOptions, read, read_one
from ssmr_ident.readers.door import reader_for
from ssmr_ident.readers.mat import reader as mat
from ssmr_ident.readers.source import open_source

RNG = np.random.default_rng(11)
RATE = 250.0
TIME = np.arange(500) / RATE
FORCE = 30 * np.sin(7 * TIME) + RNG.standard_normal(500)
ACCEL = RNG.standard_normal((500, 3)) + np.array([0.0, 0.0, 9.81])


def same(samples: np.ndarray, expected: np.ndarray, factor: float = 1.0) -> None:
    np.testing.assert_allclose(samples, expected * factor, rtol=1e-12, atol=1e-12)


def test_mat_with_a_struct_and_units(tmp_path: Path) -> None:
    scipy_io = pytest.importorskip("scipy.io")
    log = {"t": TIME[:, None], "load": FORCE[:, None] / 1e3, "units": np.array(["s", "kN"], dtype=object)}
    scipy_io.savemat(tmp_path / "a.mat", {"run": log, "note": "beam 4"}, do_compression=True)
    recording = read_one(tmp_path / "a.mat")
    assert [(c.name, c.label, c.unit) for c in recording.channels] == [("force", "run.load", "N")]
    same(recording["force"], FORCE)
    same(recording.time, TIME)


def test_mat_with_bare_arrays_and_a_rate(tmp_path: Path) -> None:
    scipy_io = pytest.importorskip("scipy.io")
    scipy_io.savemat(tmp_path / "a.mat", {"y": ACCEL, "fs": RATE})
    recording = read_one(tmp_path / "a.mat", ReadOptions(units={"y 3": "g"}))
    assert recording.names == ("y 1", "y 2", "y 3")
    assert recording.sample_rate == pytest.approx(RATE)
    same(recording["y 3"], ACCEL[:, 2], 9.80665)
    scipy_io.savemat(tmp_path / "b.mat", {"y": ACCEL})
    with pytest.raises(InputError, match="time column missing, and no sampling rate"):
        read(tmp_path / "b.mat")


def test_hdf5_groups_are_recordings(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for k, scale in enumerate((1.0, 2.0)):
            group = file.create_group(f"trial{k}")
            group["Zeit"] = TIME
            group["Zeit"].attrs["unit"] = "s"
            group["sensors/acc"] = scale * ACCEL
            group["sensors/acc"].attrs.update({"unit": "m/s^2", "labels": ["acc x", "acc y", "acc z"]})
    first, second = read(tmp_path / "a.h5")
    assert first.names == second.names == ("ax", "ay", "az")
    same(second["az"], 2 * ACCEL[:, 2])
    assert second.provenance.part == "trial1"


def test_hdf5_records_and_seconds_since_a_date(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["log"] = np.rec.fromarrays([TIME, FORCE], names="time_s,force_N")
    with h5py.File(tmp_path / "b.h5", "w") as file:
        file["time"], file["force"] = TIME, FORCE / 1e3
        file["time"].attrs["units"] = "seconds since 2024-03-01 00:00:00"
        file["force"].attrs["units"] = "kN"
    for name in ("a.h5", "b.h5"):
        recording = read_one(tmp_path / name)
        same(recording["force"], FORCE)
        same(recording.time, TIME)


def test_hdf5_arrays_with_rates_of_their_own(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for name, values, rate, unit in (("force", FORCE, RATE, "N"), ("position", TIME[:100], 50.0, "mm")):
            file[name] = values
            file[name].attrs.update({"sample_rate": rate, "units": unit})
    recording = read_one(tmp_path / "a.h5")
    assert recording.series("force").rate == pytest.approx(RATE)
    assert recording.series("position").rate == pytest.approx(50.0)
    assert recording.time[-1] == pytest.approx(99 / 50)


def test_matlab_73_is_hdf5(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.mat", "w", userblock_size=512) as file:
        file["time"], file["force_N"] = TIME[None, :], FORCE[None, :]
    with (tmp_path / "a.mat").open("r+b") as stream:
        stream.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")
    recording = read_one(tmp_path / "a.mat")
    assert (recording.names, recording.provenance.reader) == (("force",), "hdf5")
    same(recording["force"], FORCE)


def test_hdf5_bombs_and_links_are_not_followed(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.create_dataset("x", shape=(4_000_000_000,), chunks=(1_000_000,), dtype="f8", compression="gzip")
    assert (tmp_path / "a.h5").stat().st_size < 100_000
    with pytest.raises(InputError, match="unpacks to more than"):
        read(tmp_path / "a.h5")
    with h5py.File(tmp_path / "b.h5", "w") as file:
        file["time"], file["force_N"] = TIME, FORCE
        file["secret"] = h5py.ExternalLink("elsewhere.h5", "/x")
        file["again"] = file["/"]
    assert read_one(tmp_path / "b.h5").names == ("force",)


def test_mat_bomb(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import zlib

    monkeypatch.setattr("ssmr_ident.readers.mat.reader.MOST_BYTES", 20 * 2**20)

    head = b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM"
    packed = zlib.compress(b"\x0e\x00\x00\x00" + bytes(30 * 2**20), 9)
    element = (15).to_bytes(4, "little") + len(packed).to_bytes(4, "little") + packed
    (tmp_path / "a.mat").write_bytes(head + element)
    with pytest.raises(InputError, match="unpacks to more than"):
        mat.read(open_source(tmp_path / "a.mat"), ReadOptions())


@pytest.mark.parametrize("kind", ["parquet", "feather"])
def test_frames(tmp_path: Path, kind: str) -> None:
    pyarrow = pytest.importorskip("pyarrow")
    import pandas as pd

    stamps = pd.Timestamp("2022-05-04T23:59:59") + pd.to_timedelta((TIME * 1e9).round().astype("int64"), unit="ns")
    table = {"timestamp": stamps, "Kraft_kN": FORCE / 1e3, "gyro_z [deg/s]": ACCEL[:, 0], "state": ["on"] * 500}
    path = tmp_path / f"a.{kind}"
    frame = pd.DataFrame(table)
    frame.to_parquet(path, index=False) if kind == "parquet" else frame.to_feather(path)
    recording = read_one(path)
    assert [(c.name, c.unit) for c in recording.channels] == [("force", "N"), ("wz", "rad/s")]
    np.testing.assert_allclose(recording.time, TIME, atol=1e-9)
    same(recording["force"], FORCE)
    assert any("state" in note.text for note in recording.notes)
    assert pyarrow is not None


@pytest.mark.slow
def test_parquet_of_repeats_is_refused_before_it_is_laid_out(tmp_path: Path) -> None:
    pyarrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    column = pyarrow.array(np.zeros(8_000_000))
    parquet.write_table(pyarrow.table({f"c{k}": column for k in range(7)}), tmp_path / "a.parquet")
    assert (tmp_path / "a.parquet").stat().st_size < 300_000
    with pytest.raises(InputError, match="unpacks to more than"):
        read(tmp_path / "a.parquet")


def test_universal_file(tmp_path: Path) -> None:
    pyuff = pytest.importorskip("pyuff")
    sets = []
    for direction, values in ((1, ACCEL[:, 0]), (3, ACCEL[:, 2])):
        sets.append(
            {"type": 58, "binary": 0, "func_type": 1, "rsp_node": 7, "rsp_dir": direction, "ref_node": 0, "ref_dir": 0,
             "data": values, "x": TIME + 0.5, "id1": "beam", "rsp_ent_name": "B", "ref_ent_name": "NONE",
             "abscissa_spacing": 1, "abscissa_spec_data_type": 17, "ordinate_spec_data_type": 12,
             "orddenom_spec_data_type": 0, "ordinate_axis_lab": "Accel", "ordinate_axis_units_lab": "g",
             "ordinate_num_data": 2, "ver_num": 1, "load_case_id": 0, "z_axis_value": 0, "ord_data_type": 4,
             "num_pts": 500, "abscissa_min": 0.5, "abscissa_inc": 1 / RATE}
        )  # fmt: skip
    file = pyuff.UFF(str(tmp_path / "a.uff"))
    for one in sets:
        file.write_sets(one, "add")
    recording = read_one(tmp_path / "a.uff")
    assert [c.label for c in recording.channels] == ["Accel 7:+X", "Accel 7:+Z"]
    assert recording.time[0] == 0.5
    assert recording.sample_rate == pytest.approx(RATE, rel=1e-6)
    np.testing.assert_allclose(recording.channels[1].samples, ACCEL[:, 2] * 9.80665, rtol=1e-6)


@pytest.mark.parametrize("dtype", [np.int16, np.int32, np.float32])
def test_wav_is_of_full_scale(tmp_path: Path, dtype: type) -> None:
    wavfile = pytest.importorskip("scipy.io.wavfile")
    full = 1.0 if dtype is np.float32 else float(np.iinfo(dtype).max) + 1
    values = (0.5 * np.sin(60 * TIME) * full).astype(dtype)
    wavfile.write(tmp_path / "a.wav", 4000, values)
    recording = read_one(tmp_path / "a.wav")
    assert recording.sample_rate == pytest.approx(4000.0)
    np.testing.assert_allclose(recording.channels[0].samples, values.astype(float) / full)
    assert any("full scale is 1" in note.text for note in recording.warnings)
    scaled = read_one(tmp_path / "a.wav", ReadOptions(units={"channel 1": "g"}))
    assert scaled.channels[0].unit == "m/s^2"


def test_json_of_objects_and_of_arrays(tmp_path: Path) -> None:
    rows = [{"t": float(t), "imu": {"acc": {"x": float(a)}}, "load_N": float(f)} for t, a, f in
            zip(TIME, ACCEL[:, 0], FORCE, strict=True)]  # fmt: skip
    texts = {
        "lines.jsonl": "\n".join(json.dumps(row) for row in [{"event": "boot"}, *rows]),
        "list.json": json.dumps(rows),
        "inside.json": json.dumps({"device": "x", "data": rows}),
    }
    for name, text in texts.items():
        (tmp_path / name).write_text(text + "\n")
        recording = read_one(tmp_path / name, ReadOptions(units={"imu.acc.x": "m/s^2"}))
        assert recording.names == ("ax", "force")
        same(recording["force"], FORCE)
        same(recording.time, TIME)
    named = {"fs": RATE, "units": ["N", "m"], "force": FORCE.tolist(), "position": TIME.tolist()}
    (tmp_path / "a.json").write_text(json.dumps(named))
    assert read_one(tmp_path / "a.json").names == ("force", "position")


def test_zip_of_a_phone_and_npz(tmp_path: Path) -> None:
    rows = "".join(f"{t:.4f},{a:.9f}\n" for t, a in zip(TIME, ACCEL[:, 0], strict=True))
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as archive:
        archive.writestr("Accelerometer.csv", '"Time (s)","Acceleration x (m/s^2)"\n' + rows)
        archive.writestr("about/device.csv", '"property","value"\n"model","x"\n')
    recording = read_one(tmp_path / "a.zip")
    assert recording.names == ("ax",)
    assert any("about/device.csv" in note.text for note in recording.notes)
    np.savez(tmp_path / "b.npz", time=TIME, force_N=FORCE)
    same(read_one(tmp_path / "b.npz")["force"], FORCE)
    np.savez(tmp_path / "c.npz", time=TIME, force_N=np.array([{}] * 500, dtype=object))
    with pytest.raises(InputError, match="cannot be read"):
        read(tmp_path / "c.npz")


def test_npy_has_no_names(tmp_path: Path) -> None:
    np.save(tmp_path / "a.npy", np.column_stack([TIME, FORCE, ACCEL[:, 0]]))
    told = ReadOptions(columns={"time": 0, "force": 1}, units={"force": "kN", "time": "s"})
    recording = read_one(tmp_path / "a.npy", told)
    same(recording["force"], FORCE, 1e3)
    same(recording.time, TIME)
    np.save(tmp_path / "b.npy", np.rec.fromarrays([TIME, FORCE], names="time_s,force_N"))
    same(read_one(tmp_path / "b.npy")["force"], FORCE)


def test_tdms_rate_and_unit_among_the_properties(tmp_path: Path) -> None:
    nptdms = pytest.importorskip("nptdms")
    with nptdms.TdmsWriter(tmp_path / "a.tdms") as file:
        group = nptdms.GroupObject("Log", {"SamplingRate": RATE})
        file.write_segment([group, nptdms.ChannelObject("Log", "Force", FORCE, {"Unit": "kN"})])
    recording = read_one(tmp_path / "a.tdms")
    assert recording.sample_rate == pytest.approx(RATE)
    same(recording["force"], FORCE, 1e3)


def test_zip_bomb_of_logs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ssmr_ident.readers.archive.reader.MOST_BYTES", 20 * 2**20)
    with zipfile.ZipFile(tmp_path / "a.zip", "w", zipfile.ZIP_DEFLATED) as archive, archive.open("a.csv", "w") as out:
        for _ in range(25):
            out.write(b"1,2\n" * 2**18)
    with pytest.raises(InputError, match="unpacks to more than"):
        read(tmp_path / "a.zip")


@pytest.mark.parametrize("version", [1, 2])
def test_bags(tmp_path: Path, version: int) -> None:
    pytest.importorskip("rosbags")
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC if version == 1 else Stores.ROS2_HUMBLE)
    types = store.types
    vector, imu = types["geometry_msgs/msg/Vector3"], types["sensor_msgs/msg/Imu"]
    header, moment = types["std_msgs/msg/Header"], types["builtin_interfaces/msg/Time"]
    turn = types["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0)
    none = np.zeros(9)
    if version == 1:
        from rosbags.rosbag1 import Writer

        path, writer = tmp_path / "a.bag", Writer(tmp_path / "a.bag")
    else:
        from rosbags.rosbag2 import StoragePlugin, Writer

        writer = Writer(tmp_path / "a", version=9, storage_plugin=StoragePlugin.MCAP)
    with writer:
        connection = writer.add_connection("/imu", imu.__msgtype__, typestore=store)
        for k in range(500):
            nanoseconds = 1_650_000_000_000_000_000 + 4_000_000 * k
            stamp = moment(nanoseconds // 10**9, nanoseconds % 10**9)
            about = header(k, stamp, "imu") if version == 1 else header(stamp, "imu")
            message = imu(about, turn, none, vector(0.1, 0.2, k / 1e3), none, vector(*ACCEL[k].tolist()), none)
            raw = store.serialize_ros1(message, imu.__msgtype__) if version == 1 else store.serialize_cdr(
                message, imu.__msgtype__)  # fmt: skip
            writer.write(connection, nanoseconds + 700_000, raw)
    if version == 2:
        path = next((tmp_path / "a").glob("*.mcap"))
    recording = read_one(path)
    assert {"ax", "ay", "az", "wx", "wy", "wz"} <= set(recording.names)
    same(recording["az"], ACCEL[:, 2])
    assert recording.channel("az").unit == "m/s^2"
    np.testing.assert_allclose(recording.time, TIME, atol=1e-9)


@pytest.mark.parametrize(
    ("module", "data", "words"),
    [("h5py", b"\x89HDF\r\n\x1a\n" + bytes(600), r"needs h5py.*\[hdf5\]"),
     ("pyarrow", b"PAR1" + bytes(600), r"needs pyarrow.*\[parquet\]"),
     ("pyuff", b"    -1\n    58\n" + b"x\n" * 50, r"needs pyuff.*\[uff\]"),
     ("rosbags.highlevel", b"#ROSBAG V2.0\n" + bytes(600), r"needs rosbags.*\[ros\]"),
     ("nptdms", b"TDSm" + bytes(600), r"needs npTDMS.*\[tdms\]")],
)  # fmt: skip
def test_a_missing_library_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, module: str, data: bytes, words: str
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    (tmp_path / "log").write_bytes(data)
    source = open_source(tmp_path / "log")
    with pytest.raises(InputError, match=words):
        reader_for(source, ReadOptions()).read(source, ReadOptions())


def test_a_lab_brings_a_reader(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A package of a lab's own names an object under the entry point, and the door asks it first."""
    from ssmr_ident.core.recording import Recording
    from ssmr_ident.readers import door
    from ssmr_ident.readers.source import Source
    from ssmr_ident.readers.table.assemble import recordings_of
    from ssmr_ident.readers.table.columns import Column, Table

    class Lab:
        NAMES = ("our-logger",)

        def recognises(self, source: Source) -> bool:
            return source.data.startswith(b"OURS")

        def read(self, source: Source, options: ReadOptions) -> list[Recording]:
            values = np.frombuffer(source.data[4:], "<f8")
            columns = [Column("F", "kN", values, step=0.01)]
            return recordings_of(source, "our-logger", Table(columns, str), options)

    class Point:
        def load(self) -> Lab:
            return Lab()

    monkeypatch.setattr(door, "entry_points", lambda group: [Point()] if group == "ssmr_ident.readers" else [])
    door.installed.cache_clear()
    try:
        (tmp_path / "a.bin").write_bytes(b"OURS" + FORCE.tobytes())
        recording = read_one(tmp_path / "a.bin", ReadOptions(reader="our-logger"))
        same(recording["force"], FORCE, 1e3)
        assert recording.sample_rate == pytest.approx(100.0)
    finally:
        door.installed.cache_clear()


def test_damage_is_a_word_and_no_traceback(tmp_path: Path) -> None:
    for mark in (b"\x89HDF\r\n\x1a\n", b"PAR1", b"ARROW1", b"RIFF\0\0\0\0WAVE", b"#ROSBAG V2.0\n", b"\x89MCAP0\r\n"):
        (tmp_path / "a").write_bytes(mark + RNG.bytes(3000))
        with pytest.raises(InputError):
            read(tmp_path / "a")
    buffer = io.BytesIO()
    np.save(buffer, TIME)
    with zipfile.ZipFile(tmp_path / "b.npz", "w") as archive:
        archive.writestr("time.npy", buffer.getvalue()[:200])
    with pytest.raises(InputError):
        read(tmp_path / "b.npz")


def test_names_and_units_beside_the_numbers_of_a_struct(tmp_path: Path) -> None:
    scipy_io = pytest.importorskip("scipy.io")
    cells = np.zeros((1, 3), dtype=object)
    cells[0, 0] = {"name": "acc", "unit": "g", "data": ACCEL[:, 0]}
    cells[0, 1] = {"name": "force", "unit": "kN", "data": FORCE / 1e3}
    cells[0, 2] = {"name": "note", "unit": "", "data": "x"}
    scipy_io.savemat(tmp_path / "a.mat", {"fs": RATE, "channels": cells})
    named = {"Channel_1_Data": FORCE[:, None], "Channel_1_Header": {"SignalName": "Force", "Unit": "N"}, "Ts": 1 / RATE}
    scipy_io.savemat(tmp_path / "b.mat", named)
    recording = read_one(tmp_path / "a.mat")
    assert [(c.name, c.unit) for c in recording.channels] == [("acceleration", "m/s^2"), ("force", "N")]
    same(recording["acceleration"], ACCEL[:, 0], 9.80665)
    recording = read_one(tmp_path / "b.mat")
    assert [(c.name, c.unit) for c in recording.channels] == [("force", "N")]
    assert recording.sample_rate == pytest.approx(RATE)


def test_runs_with_a_bare_t_are_recordings(tmp_path: Path) -> None:
    scipy_io = pytest.importorskip("scipy.io")
    scipy_io.savemat(tmp_path / "a.mat", {f"run{k}": {"t": TIME, "force_N": k * FORCE} for k in (1, 2)})
    first, second = read(tmp_path / "a.mat")
    same(second["force"], first["force"], 2.0)


def test_hdf5_groups_with_rates_of_their_own_are_one_recording(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for name, samples, unit, rate in (
            ("fast/acc", ACCEL[:, 0], "g", RATE),
            ("slow/force", FORCE[::5], "N", RATE / 5),
        ):
            file[name] = samples
            file[name].attrs["units"] = unit
            file[name.split("/")[0]].attrs["fs"] = rate
    recording = read_one(tmp_path / "a.h5")
    same(recording.series("force").samples, FORCE[::5])
    assert recording.series("force").rate == pytest.approx(RATE / 5)
    assert recording.series("acceleration").rate == pytest.approx(RATE)


def test_hdf5_stamps_as_text(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["when"] = np.array([f"2025-03-01T12:00:{t:09.6f}" for t in TIME], dtype="S26")
        file["force_N"] = FORCE
    recording = read_one(tmp_path / "a.h5")
    assert recording.sample_rate == pytest.approx(RATE, rel=1e-5)
    same(recording["force"], FORCE)


def test_factors_of_a_convention_are_applied_and_others_told(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.attrs["fs"] = RATE
        for name, keys in (("force", {"scale_factor": 0.5, "add_offset": 3.0}), ("load", {"gain": 0.1})):
            file[name] = np.round(FORCE)
            file[name].attrs.update({"units": "N", **keys})
    recording = read_one(tmp_path / "a.h5")
    same(recording["force"], 0.5 * np.round(FORCE) + 3.0)
    same(recording["force_2"], np.round(FORCE))
    assert any(n.level == "warning" and "gain = 0.1 stands beside" in n.text for n in recording.notes)


def test_json_of_pandas_and_in_batches(tmp_path: Path) -> None:
    pd = pytest.importorskip("pandas")
    frame = pd.DataFrame({"time_s": TIME, "force_N": FORCE})
    (tmp_path / "a.json").write_text(frame.to_json(double_precision=15))
    np.testing.assert_allclose(read_one(tmp_path / "a.json")["force"], FORCE, atol=1e-12)
    dated = pd.DataFrame({"force_N": FORCE}, index=pd.date_range("2025-03-01", periods=500, freq="4ms"))
    epoch = json.dumps({"force_N": {str(1_740_787_200_000 + 4 * k): f for k, f in enumerate(FORCE)}})
    for text in (epoch, dated.to_json(double_precision=15, date_unit="ms", date_format="iso")):
        (tmp_path / "b.json").write_text(text)
        assert read_one(tmp_path / "b.json").sample_rate == pytest.approx(RATE)
    batches = [{"t0": TIME[k], "id": "x", "force_N": FORCE[k : k + 20].tolist()} for k in range(0, 500, 20)]
    (tmp_path / "c.jsonl").write_text("".join(json.dumps(batch) + "\n" for batch in batches))
    recording = read_one(tmp_path / "c.jsonl")
    same(recording["force"], FORCE)
    np.testing.assert_allclose(recording.time, TIME, atol=1e-9)
    vectors = {"fs": RATE, "acc_g": (ACCEL / 9.80665).tolist()}
    (tmp_path / "d.json").write_text(json.dumps(vectors))
    assert {c.unit for c in read_one(tmp_path / "d.json").channels} == {"m/s^2"}


def test_frames_with_an_index_of_dates_and_structs(tmp_path: Path) -> None:
    pd = pytest.importorskip("pandas")
    pytest.importorskip("pyarrow")
    index = pd.date_range("2025-03-01", periods=500, freq="4ms", tz="Europe/Berlin")
    acc = [{"ax_g": x, "ay_g": y} for x, y in ACCEL[:, :2] / 9.80665]
    pd.DataFrame({"acc": acc}, index=index).to_parquet(tmp_path / "a.parquet")
    recording = read_one(tmp_path / "a.parquet")
    assert recording.names == ("ax", "ay")
    assert recording.sample_rate == pytest.approx(RATE)
    same(recording["ay"], ACCEL[:, 1])


def test_units_of_a_record_are_its_fields_own(tmp_path: Path) -> None:
    import h5py

    record = np.zeros(100, dtype=[("time", "f8"), ("force", "f8"), ("acc", "f4")])
    record["time"], record["force"] = np.arange(100) / 50.0, np.arange(100.0)
    for units in (["s", "kN", "m/s^2"], ["kN", "m/s^2"], "s, kN, m/s^2"):
        with h5py.File(tmp_path / "log.h5", "w") as file:
            file.create_dataset("log", data=record).attrs["units"] = units
        recording = read_one(tmp_path / "log.h5")
        assert [channel.unit for channel in recording.channels] == ["N", "m/s^2"]
        np.testing.assert_allclose(recording["force"], 1e3 * record["force"])


def test_clocks_named_after_their_channels_and_a_scope_s_interval(tmp_path: Path) -> None:
    from scipy.io import savemat

    clock, force = np.arange(100) / 50.0, np.sin(np.arange(100.0))
    savemat(tmp_path / "a.mat", {"Data1_time_AI_1": clock, "Data1_AI_1": force})
    savemat(tmp_path / "b.mat", {"A": force, "Tstart": -1.0, "Tinterval": 0.02, "Length": 100.0})
    savemat(tmp_path / "c.mat", {"tout": clock, "yout": force})
    for name in "abc":
        recording = read_one(tmp_path / f"{name}.mat")
        assert recording.sample_rate == pytest.approx(50.0)
        assert len(recording.channels) == 1


@pytest.mark.parametrize("module", ["gzip", "bz2", "lzma"])
def test_a_packed_log_is_read_as_the_log(tmp_path: Path, module: str, monkeypatch: pytest.MonkeyPatch) -> None:
    rows = "time_s,force_N\n" + "".join(f"{k / 50:.2f},{k}\n" for k in range(100))
    packed = import_module(module).compress(rows.encode())
    (tmp_path / "log.csv.gz").write_bytes(packed)
    recording = read_one(tmp_path / "log.csv.gz")
    np.testing.assert_array_equal(recording["force"], np.arange(100.0))
    assert recording.provenance.file == str(tmp_path / "log.csv.gz")
    (tmp_path / "damaged.gz").write_bytes(packed[:-20])
    with pytest.raises(InputError, match="damaged"):
        read_one(tmp_path / "damaged.gz")
    monkeypatch.setattr("ssmr_ident.readers.archive.reader.MOST_BYTES", 500)
    with pytest.raises(InputError, match="unpacks to more"):
        read_one(tmp_path / "log.csv.gz")


def test_documents_that_are_zips_are_called_by_their_names(tmp_path: Path) -> None:
    for part, said in (("content.xml", "OpenDocument"), ("xl/workbook.bin", "xlsb"), ("Index/Document.iwa", "Numbers")):
        with zipfile.ZipFile(tmp_path / "a", "w") as archive:
            archive.writestr(part, "x")
        with pytest.raises(InputError, match=said):
            read(tmp_path / "a")


def test_a_feather_file_whose_words_are_no_text_is_damaged(tmp_path: Path) -> None:
    pyarrow = pytest.importorskip("pyarrow")
    from pyarrow import feather

    file = tmp_path / "a.feather"
    words = pyarrow.array(["still", "moves"] * 20)
    table = pyarrow.table({"time": np.arange(40) * 0.01, "state": words, "a [m/s^2]": np.zeros(40)})
    feather.write_feather(table, file, compression="uncompressed")
    file.write_bytes(file.read_bytes().replace(b"moves", b"mo\xe0es"))
    with pytest.raises(InputError, match="damaged"):
        read(file)
