"""One experiment as brokers, databases and robots write it: a row is one sample of one sensor."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from ssmr_ident.core.errors import InputError
from ssmr_ident.readers import ReadOptions, read, read_one

COUNT, RATE, G = 90, 150.0, 9.80665
TIME = np.arange(COUNT) / RATE
RNG = np.random.default_rng(21)
ACCELERATION = 2 * np.cos(7 * TIME) + 0.01 * RNG.standard_normal(COUNT)
FORCE = 12 * np.sin(5 * TIME) + 3 + 0.01 * RNG.standard_normal(COUNT)


def in_turn(path: Path) -> None:
    pairs = zip(TIME, ACCELERATION / G, FORCE, strict=True)
    rows = [f"{t:.5f},accel_g,{a:.7f}\n{t:.5f},force_N,{f:.6f}" for t, a, f in pairs]
    path.write_text("\n".join(["time_s,sensor,value", *rows]) + "\n")


def one_behind_the_other(path: Path) -> None:
    rows = [f"{t:.5f};force_N;{f:.6f}" for t, f in zip(TIME, FORCE, strict=True)]
    rows += [f"{t:.5f};accel_g;{a:.7f}" for t, a in zip(TIME, ACCELERATION / G, strict=True)]
    path.write_text("\n".join(["t [s];which;value", *rows]) + "\n")


def with_a_column_of_units(path: Path) -> None:
    rows = []
    for t, a, f in zip(TIME, ACCELERATION / G, FORCE, strict=True):
        stamp = f"2025-03-01T12:00:{t:09.6f}Z"
        rows += [f"{stamp};Kraft;{f:.6f};N".replace(".", ","), f"{stamp};Beschl;{a:.7f};g".replace(".", ",")]
    path.write_text("\n".join(["Zeit;Messgröße;Wert;Einheit", *rows]) + "\n")


def by_topics(path: Path) -> None:
    rows = []
    for t, a, f in zip(TIME, ACCELERATION, FORCE, strict=True):
        rows += [f"{t:.5f},imu,{a:.7f},", f"{t + 0.001:.5f},cell,,{f:.6f}"]
    path.write_text("\n".join(["time_s,topic,acc_m_s2,force_N", *rows]) + "\n")


def objects_a_line(path: Path) -> None:
    pairs = zip(TIME, ACCELERATION / G, FORCE, strict=True)
    rows = [({"t": t, "channel": "accel_g", "v": a}, {"t": t, "channel": "force_N", "v": f}) for t, a, f in pairs]
    path.write_text("".join(json.dumps(one) + "\n" for pair in rows for one in pair))


def parquet(path: Path) -> None:
    values = np.column_stack([ACCELERATION / G, FORCE]).ravel()
    frame = pd.DataFrame({"time_s": np.repeat(TIME, 2), "metric": ["accel_g", "force_N"] * COUNT, "value": values})
    frame.to_parquet(path)


def of_a_database(path: Path) -> None:
    head = ["#datatype,string,long,dateTime:RFC3339,double,string,string", "#group,false,false,false,false,true,true"]
    rows = [",result,table,_time,_value,_field,_measurement"]
    for table, (name, samples, of) in enumerate((("force_N", FORCE, "cell"), ("accel_g", ACCELERATION / G, "imu"))):
        pairs = zip(TIME, samples, strict=True)
        rows += [f",,{table},2025-03-01T12:00:{t:09.6f}Z,{v:.7f},{name},{of}" for t, v in pairs]
    path.write_text("\n".join([*head, *rows]) + "\n")


WRITERS = (of_a_database, in_turn, one_behind_the_other, with_a_column_of_units, by_topics, objects_a_line, parquet)


@pytest.mark.parametrize("write", WRITERS, ids=lambda w: w.__name__)
def test_every_sensor_becomes_a_channel(tmp_path: Path, write: Callable[[Path], None]) -> None:
    path = tmp_path / "log"
    write(path)
    recording = read_one(path)
    for name, unit, samples in (("acceleration", "m/s^2", ACCELERATION), ("force", "N", FORCE)):
        series = recording.series(name)
        assert recording.channel(name).unit == unit
        assert series.rate == pytest.approx(RATE, rel=1e-3)
        np.testing.assert_allclose(series.samples, samples, atol=2e-5)
    assert any("every row is a sample of the sensor" in note.text for note in recording.notes)


def test_devices_with_the_same_sensors_and_numbered_channels(tmp_path: Path) -> None:
    devices, numbered = [], []
    for t, a, f in zip(TIME, ACCELERATION / G, FORCE, strict=True):
        devices += [f"{t:.5f},A,acc_g,{a:.7f}", f"{t:.5f},B,acc_g,{2 * a:.7f}", f"{t:.5f},A,force_N,{f:.6f}"]
        numbered += [f"{1000 * t:.3f},1,{a:.7f}", f"{1000 * t:.3f},2,{f:.7f}"]
    (tmp_path / "a.csv").write_text("\n".join(["time_s,device,metric,val", *devices]) + "\n")
    recording = read_one(tmp_path / "a.csv")
    assert {c.label for c in recording.channels} == {"A.acc_g", "B.acc_g", "A.force_N"}
    by_label = {c.label: c.samples for c in recording.channels}
    np.testing.assert_allclose(by_label["B.acc_g"], 2 * ACCELERATION, atol=2e-5)
    (tmp_path / "b.csv").write_text("\n".join(["time_ms,channel,value_g", *numbered]) + "\n")
    recording = read_one(tmp_path / "b.csv")
    assert [(c.label, c.unit) for c in recording.channels] == [("channel 1", "m/s^2"), ("channel 2", "m/s^2")]
    np.testing.assert_allclose(recording.channels[1].samples, G * FORCE, atol=1e-5)


def test_sensors_keep_their_own_rates(tmp_path: Path) -> None:
    rows = []
    for k, (t, a, f) in enumerate(zip(TIME, ACCELERATION, FORCE, strict=True)):
        rows += [f"{t:.5f},acc_m_s2,{a:.6f}"] + ([f"{t:.5f},force_N,{f:.6f}"] if k % 5 == 0 else [])
    (tmp_path / "log.csv").write_text("\n".join(["time_s,sensor,value", *rows]) + "\n")
    recording = read_one(tmp_path / "log.csv")
    assert recording.series("force").rate == pytest.approx(RATE / 5, rel=1e-3)
    np.testing.assert_allclose(recording.series("force").samples, FORCE[::5], atol=2e-6)
    np.testing.assert_allclose(recording.series("acceleration").samples, ACCELERATION, atol=2e-6)


def test_a_rate_given_holds_for_every_sensor(tmp_path: Path) -> None:
    in_turn(tmp_path / "log.csv")
    recording = read_one(tmp_path / "log.csv", ReadOptions(fs=50.0))
    assert recording.sample_rate == pytest.approx(50.0)
    assert len(recording.time) == COUNT


def test_two_levels_are_asked_with_the_guess_for_the_accelerometer_alone(tmp_path: Path) -> None:
    rows = [
        f"{t:.5f},acc,{a:.4f},0.1,9.81\n{t:.5f},gyro,{a / 9:.5f},0.2,0.3"
        for t, a in zip(TIME, ACCELERATION, strict=True)
    ]
    (tmp_path / "log.csv").write_text("\n".join(["timestamp,topic,x,y,z", *rows]) + "\n")
    with pytest.raises(InputError) as error:
        read(tmp_path / "log.csv")
    assert "acc.z=m/s^2,gyro.x=…" in error.value.mend
    units = {f"{s}.{a}": u for s, u in (("acc", "m/s^2"), ("gyro", "rad/s")) for a in "xyz"}
    recording = read_one(tmp_path / "log.csv", ReadOptions(units=units))
    assert {c.name: c.unit for c in recording.channels} == {
        "ax": "m/s^2", "ay": "m/s^2", "az": "m/s^2", "wx": "rad/s", "wy": "rad/s", "wz": "rad/s"
    }  # fmt: skip


def test_a_state_splits_nothing(tmp_path: Path) -> None:
    rows = [f"{t:.5f},{'idle' if k % 2 else 'run'},{f:.6f}" for k, (t, f) in enumerate(zip(TIME, FORCE, strict=True))]
    (tmp_path / "log.csv").write_text("\n".join(["time_s,state,force_N", *rows]) + "\n")
    recording = read_one(tmp_path / "log.csv")
    assert recording.names == ("force",)
    assert len(recording.time) == COUNT
