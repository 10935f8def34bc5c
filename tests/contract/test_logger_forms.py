"""One experiment as many loggers write it: analysers, oscilloscopes, class-room sensors, boards, phones, presses."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from ssmr_ident.core.errors import InputError
from ssmr_ident.readers import ReadOptions, read, read_one

COUNT, RATE = 80, 250.0
G, POUND, INCH = 9.80665, 4.4482216152605, 0.0254
RNG = np.random.default_rng(7)
TIME = np.arange(COUNT) / RATE
ACCELERATION = 2 * np.cos(9 * TIME) + 0.01 * RNG.standard_normal(COUNT)
FORCE = 30 * np.sin(7 * TIME) + 0.05 * RNG.standard_normal(COUNT)
POSITION = 4e-3 * np.sin(7 * TIME)

Row = Callable[[int, float, float, float, float], str]


def comma(value: float, digits: int = 6) -> str:
    return f"{value:.{digits}f}".replace(".", ",")


def stamp(k: int) -> str:
    return f"12:00:{k / RATE:06.3f}"


# name: lines above, a row of (k, t, a, f, x), quantities that it holds, encoding
FORMS: dict[str, tuple[list[str], Row, str, str]] = {
    "dewesoft": (
        ["Data info", "Sample rate:\t250", "", "Time (s)\tAccX (m/s2)\tForce (N)", ""],
        lambda k, t, a, f, x: f"{t:.4f}\t{a:.6f}\t{f:.5f}", "ax force", "utf-8"),
    "catman": (
        ["MGCplus", "Zeit  1 - Standardmessrate [s]\tKraft [kN]\tWeg [mm]", ""],
        lambda k, t, a, f, x: f"{comma(t)}\t{comma(f / 1e3, 8)}\t{comma(1e3 * x)}", "force position", "cp1252"),
    "rates below the units": (
        ["Time  1 - default sample rate\tForce\tDisplacement", "s\tN\tmm", "SR=250 Hz\tSR=250 Hz\tSR=250 Hz"],
        lambda k, t, a, f, x: f"{t:.4f}\t{f:.5f}\t{1e3 * x:.6f}", "force position", "utf-8"),
    "oscilloscope with numbered channels": (
        ["x-axis,1,2", "second,Volt,Volt"],
        lambda k, t, a, f, x: f"{t:+.9E},{a:+.6E},{f:+.6E}", "1:V:a 2:V:f", "utf-8"),
    "oscilloscope with units above": (
        ["Model,MDO", "Horizontal Units,S,", "Vertical Units,mV,V", "", "TIME,CH1,CH2"],
        lambda k, t, a, f, x: f"{t:.6f},{1e3 * a:.3f},{f:.5f}", "CH1:V:a CH2:V:f", "utf-8"),
    "one unit for all": (
        ["Sensor name:,Accelerometer", "Units:,m/s^2", "", "Time(s),X_value,Y_value"],
        lambda k, t, a, f, x: f"{t:.4f},{a:.6f},{f:.6f}", "ax ay:m/s^2:f", "utf-8"),
    "vernier": (
        ["Latest: Time (s),Latest: Force (N),Latest: Position (m)"],
        lambda k, t, a, f, x: f"{t:.4f},{f:.5f},{x:.8f}", "force position", "utf-8"),
    "pasco": (
        ["Time (s) Run #1,Force (N) Run #1,Acceleration (m/s²) Run #1"],
        lambda k, t, a, f, x: f"{t:.4f},{f:.5f},{a:.5f}", "force acceleration", "utf-8"),
    "microseconds of a board": (
        ["micros,accX_ms2,fx_N"],
        lambda k, t, a, f, x: f"{10**6 + 4000 * k},{a:.5f},{f:.5f}", "ax force", "utf-8"),
    "names behind a word": (
        ["# boot", "# columns: t_us fx_N"], lambda k, t, a, f, x: f"{4000 * k} {f:.5f}", "force", "utf-8"),
    "stamps in brackets": (
        ["[11:59:59.990] ax_g,ay_g"],
        lambda k, t, a, f, x: f"[{stamp(k)}] {a / G:.7f},{f / G:.7f}", "ax ay:m/s^2:f", "utf-8"),
    "seconds since the start in brackets": (
        ["[0.000100] force_N,acc_g"],
        lambda k, t, a, f, x: f"[{7 + t:.6f}] {f:.5f},{a / G:.7f}", "force acceleration", "utf-8"),
    "compact ISO 8601": (
        ["time,force_N"],
        lambda k, t, a, f, x: f"20240301T1200{k / RATE:06.3f}Z,{f:.5f}", "force", "utf-8"),
    "date and time joined by an underscore": (
        ["stamp;force_N"], lambda k, t, a, f, x: f"2024-03-01_{stamp(k)};{f:.5f}", "force", "utf-8"),
    "rate among remarks": (
        ["# sampling_rate_hz=250", "# sensor=ADXL355", "ax_mps2,ay_mps2"],
        lambda k, t, a, f, x: f"{a:.6f},{f:.6f}", "ax ay:m/s^2:f", "utf-8"),
    "units spelt out": (
        ["Time (seconds),Force (Newtons),Displacement (millimeters),Acceleration (meters per second squared)"],
        lambda k, t, a, f, x: f"{t:.4f},{f:.5f},{1e3 * x:.6f},{a:.5f}", "force position acceleration", "utf-8"),
    "the unit as a name": (
        ["Seconds,Accel (g's),Force (pounds)"],
        lambda k, t, a, f, x: f"{t:.4f},{a / G:.7f},{f / POUND:.7f}", "acceleration force", "utf-8"),
    "units behind dots": (
        ["time.s,force.N,acc.m_s2"], lambda k, t, a, f, x: f"{t:.4f},{f:.5f},{a:.5f}", "force acceleration", "utf-8"),
    "units above the names": (
        ["s,N,m/s^2", "Time,Force,Acceleration"],
        lambda k, t, a, f, x: f"{t:.4f},{f:.5f},{a:.5f}", "force acceleration", "utf-8"),
    "an index without a name": (
        [",time_s,force_N"], lambda k, t, a, f, x: f"{k},{t:.4f},{f:.5f}", "force", "utf-8"),
    "gravities of a phone": (
        ["time;gFx;TgF"],
        lambda k, t, a, f, x: f"{comma(t)};{comma(a / G, 8)};{comma(1.0 + a)}", "gFx:m/s^2:a", "utf-8"),
    "a gyroscope by letters": (
        ["t_ms,gx (deg/s),gy (deg/s)"],
        lambda k, t, a, f, x: f"{4 * k},{np.degrees(a):.5f},{np.degrees(f):.4f}", "wx:rad/s:a wy:rad/s:f", "utf-8"),
    "a press in the Imperial way": (
        ["Results Table 1", "Specimen,Max Load", "1,30", "", "Raw Data", "Time (sec),Extension (in),Load (lbf)"],
        lambda k, t, a, f, x: f"{t:.4f},{x / INCH:.9f},{f / POUND:.7f}", "force position", "utf-8"),
    "a press in French": (
        ["Temps [s];Effort [daN];Déplacement [mm]"],
        lambda k, t, a, f, x: f"{comma(t)};{comma(f / 10)};{comma(1e3 * x)}", "force position", "cp1252"),
    "a table of bars": (
        ["| t [s] | F [N] | a [m/s²] |", "|-------|-------|----------|"],
        lambda k, t, a, f, x: f"| {t:.4f} | {f:.5f} | {a:.5f} |", "force acceleration", "utf-8"),
    "data logger with processes": (
        ['"TOA5","rig","CR6"', '"TIMESTAMP","RECORD","Accel_X","Load"', '"TS","RN","m/s^2","N"', '"","","Smp","Smp"'],
        lambda k, t, a, f, x: f'"2024-03-01 {stamp(k)}",{k},{a:.6f},{f:.5f}', "ax force", "utf-8"),
    "words among numbers": (
        ["time_s,state,raw,force_N,valid"],
        lambda k, t, a, f, x: f"{t:.4f},{'RUN' if k > 5 else 'INIT'},0x{k:04X},{f:.5f},true", "force", "utf-8"),
    "a header on every page": (
        [], lambda k, t, a, f, x: ("" if k % 20 else f"Page {k // 20 + 1}\nTime   Load\n(s)    (N)\n-----------\n")
        + f"{t:.4f}   {f:.5f}", "force", "utf-8"),
    "names that a row says": (
        ["Operator:\tJ.", "Channel names:\tForce\tAccel", "Units:\tN\tg", "dt:\t0.004", ""],
        lambda k, t, a, f, x: f"{f:.5f}\t{a / G:.7f}", "force acceleration", "utf-8"),
    "a word before the names": (
        ["#SampleRate, 250,Hz", "#Headers, force_N,acc_g"], lambda k, t, a, f, x: f"{f:.5f},{a / G:.7f}",
        "force acceleration", "utf-8"),
    "a header over two rows": (
        ["Zeit;Sensor 1;", "s;Kraft [N];Beschl. [g]"], lambda k, t, a, f, x: f"{comma(t)};{comma(f)};{comma(a / G, 8)}",
        "force acceleration", "utf-8"),
    "rates of every channel": (
        ['"SampleRate",250,250', '"TraceName","Force (N)","Accel (m/s^2)"', '"HUnit","s"', ""],
        lambda k, t, a, f, x: f",{f:.5f},{a:.6f}", "force acceleration", "utf-8"),
    "dates between tabs": (
        ["time[0]\tForce [N]"],
        lambda k, t, a, f, x: f"02.06.2025 {stamp(k)}\t{comma(f)}".replace(".", ",").replace(",06,2025", ".06.2025"),
        "force", "utf-8"),
    "words for no number": (
        ["time_s,force_N,other_N"], lambda k, t, a, f, x: f"{t:.4f},{f:.5f},{'OVERLOAD' if k % 7 == 3 else f'{f:.2f}'}",
        "force", "utf-8"),
    "cells with their units": (
        ["Time,Force,Accel"], lambda k, t, a, f, x: f'{t:.4f} sec,"{f:.5f} N",{a:.6f} m/s²', "force acceleration",
        "utf-8"),
    "names, numbers and units in a line": (
        ["Sensor init"], lambda k, t, a, f, x: f"{stamp(k)} -> Acc: {a:.6f} m/s2, Force: {f:.5f} N",
        "force acceleration", "utf-8"),
    "a microcontroller's log": (
        ["ESP-ROM"], lambda k, t, a, f, x: f"I ({4 * k}) imu: force_N={f:.5f} acc_g={a / G:.7f}",
        "force acceleration", "utf-8"),
    "timedeltas of pandas": (
        [",force (N)"], lambda k, t, a, f, x: f"0 days 00:00:{t:09.6f},{f:.5f}", "force", "utf-8"),
    "days of a spreadsheet": (
        ["Date,Force (N)"], lambda k, t, a, f, x: f"{45810.4166 + t / 86400:.12f},{f:.5f}", "force", "utf-8"),
    "hour, minute, second, millisecond": (
        ["hour,minute,second,ms,force_N"],
        lambda k, t, a, f, x: f"23,59,{59 if k < 40 else 0},{(4 * k + 840) % 1000},{f:.5f}"
        if k < 40 else f"0,0,0,{(4 * k + 840) % 1000},{f:.5f}", "force", "utf-8"),
    "milliseconds beside a stamp": (
        ["Number,Date&Time,ms,CH1,CH2", "NO.,Time,ms,N,m/s2"],
        lambda k, t, a, f, x: f"{k},2025-03-01 12:00:0{(900 + 4 * k) // 1000},{(900 + 4 * k) % 1000},{f:.5f},{a:.6f}",
        "CH1:N=f CH2:m/s^2=a", "utf-8"),
    "a counter that runs over": (
        ["micros,force_N"], lambda k, t, a, f, x: f"{(2**32 - 100_000 + 4000 * k) % 2**32},{f:.5f}", "force", "utf-8"),
    "symbols with units": (
        ["t_s,F_N,x_g,T"], lambda k, t, a, f, x: f"{t:.4f},{f:.5f},{a / G:.7f},41", "force ax", "utf-8"),
    "Portuguese": (
        ["Tempo (s);Força (N);Aceleração (m/s²)"], lambda k, t, a, f, x: f"{comma(t)};{comma(f)};{comma(a)}",
        "force acceleration", "latin-1"),
    "Russian in its code page": (
        ["Время, с;Сила, Н;Ускорение, м/с2"], lambda k, t, a, f, x: f"{comma(t)};{comma(f)};{comma(a)}",
        "force acceleration", "cp1251"),
    "Japanese in its code page": (
        ["時間[s],荷重[N],加速度[m/s2]"], lambda k, t, a, f, x: f"{t:.4f},{f:.5f},{a:.6f}", "force acceleration",
        "shift_jis"),
    "sections with facts": (
        ["[meta]", "fs = 250", "unit = N", "[data]"], lambda k, t, a, f, x: f"{f:.5f}", "column_1:N=f", "utf-8"),
    "weekdays before dates": (
        ["Timestamp,Force (N)"], lambda k, t, a, f, x: f'"Mon, 02 Jun 2025 {stamp(k)} GMT",{f:.5f}', "force", "utf-8"),
    "stamps of C": (
        ["Timestamp,Force (N)"], lambda k, t, a, f, x: f"Mon Jun  2 {stamp(k)} 2025,{f:.5f}", "force", "utf-8"),
    "units before the names": (
        ["[s] Time;[N] Force;[m/s²] Acc"], lambda k, t, a, f, x: f"{t:.4f};{f:.5f};{a:.6f}", "force acceleration",
        "utf-8"),
    "camel case": (
        ["timeSec,accelXMps2,forceN"], lambda k, t, a, f, x: f"{t:.4f},{a:.6f},{f:.5f}", "ax force", "utf-8"),
    "serial numbers behind the unit": (
        ['"Plot Title: rig"', '"#","Date Time, GMT+01:00","X Accel, g (LGR S/N: 123, SEN S/N: 456)"'],
        lambda k, t, a, f, x: f"{k + 1},06/02/25 11:00:{k / RATE:06.3f} AM,{a / G:.7f}", "ax", "utf-8"),
    "channel numbers before the names": (
        ["Scan,Time,101 <force> (N),Alarm 101"],
        lambda k, t, a, f, x: f"{k},06/02/2025 11:00:00:{4 * k:03d},{f:.5f},0", "101_<force>:N=f", "utf-8"),
    "decimal commas in quotes": (
        ['"Zeit (s)","Kraft (N)"'], lambda k, t, a, f, x: f'"{comma(t)}","{comma(f)}"', "force", "utf-8"),
    "cells as formulas": (
        ["Time (s),Force (N)"], lambda k, t, a, f, x: f'="{t:.4f}",="{f:.5f}"', "force", "utf-8"),
    "a typesetter's minus": (
        ["Time (s),Force (N)"], lambda k, t, a, f, x: f"{t:.4f},{f:.5f}".replace("-", "\u2212"), "force", "utf-8"),
    "units in capitals": (
        ["TIME [S],LOAD [KN],ACC [M/S2]"], lambda k, t, a, f, x: f"{t:.4f},{f / 1e3:.8f},{a:.6f}", "force acceleration",
        "utf-8"),
    "kilosamples": (
        ["Sample rate: 0.25 kS/s", "Force [N]"], lambda k, t, a, f, x: f"{f:.5f}", "force", "utf-8"),
    "numbers as text in JSON, the rate before": (
        ['{"type": "meta", "fs": 250}'], lambda k, t, a, f, x: f'{{"type": "s", "force_N": "{f:.5f}"}}', "force",
        "utf-8"),
    "a clock with colons throughout": (
        ["Time\tForce (N)"], lambda k, t, a, f, x: f"12:00:00:{4 * k:03d}\t{f:.5f}", "force", "utf-8"),
}  # fmt: skip
TRUTH = {"ax": ("m/s^2", ACCELERATION), "acceleration": ("m/s^2", ACCELERATION), "force": ("N", FORCE),
         "position": ("m", POSITION)}  # fmt: skip
LETTERS = {"a": ACCELERATION, "f": FORCE}


@pytest.mark.parametrize("form", FORMS)
def test_a_logger_s_form(tmp_path: Path, form: str) -> None:
    above, row, quantities, encoding = FORMS[form]
    rows = [row(k, *values) for k, values in enumerate(zip(TIME, ACCELERATION, FORCE, POSITION, strict=True))]
    path = tmp_path / "log.txt"
    path.write_bytes("\n".join([*above, *rows, ""]).encode(encoding))
    recording = read_one(path)
    assert len(recording.time) == COUNT
    assert recording.sample_rate == pytest.approx(RATE, rel=1e-4)
    for wanted in quantities.split():
        name, _, rest = wanted.replace("_", " ").partition(":")
        unit, samples = (rest[:-2], LETTERS[rest[-1]]) if rest else TRUTH[name]
        assert recording.channel(name).unit == unit
        np.testing.assert_allclose(recording[name], samples, atol=2e-5 * np.ptp(samples) + 2e-5)


def test_minus_9999_is_no_number(tmp_path: Path) -> None:
    rows = "".join(
        f"{t:.4f},{-9999 if k in (20, 21) else f}\n" for k, (t, f) in enumerate(zip(TIME, FORCE, strict=True))
    )
    (tmp_path / "log.csv").write_text("time_s,force_N\n" + rows)
    recording = read_one(tmp_path / "log.csv")
    assert np.flatnonzero(np.isnan(recording["force"])).tolist() == [20, 21]
    assert any("2 value(s) of force_N are -9999" in note.text for note in recording.notes)
    near = "".join(f"{t:.4f},{-999 if k == 20 else 40 * f}\n" for k, (t, f) in enumerate(zip(TIME, FORCE, strict=True)))
    (tmp_path / "near.csv").write_text("time_s,force_N\n" + near)
    assert read_one(tmp_path / "near.csv")["force"][20] == -999


def test_infinite_is_no_number(tmp_path: Path) -> None:
    rows = "".join(f"{t:.4f},{'-Inf' if k == 9 else f}\n" for k, (t, f) in enumerate(zip(TIME, FORCE, strict=True)))
    (tmp_path / "log.csv").write_text("time_s,force_N\n" + rows)
    recording = read_one(tmp_path / "log.csv")
    assert np.flatnonzero(np.isnan(recording["force"])).tolist() == [9]
    assert any("1 value(s) of force_N are no number, kept as NaN" in note.text for note in recording.notes)


def test_a_rate_that_nothing_has_is_asked_about(tmp_path: Path) -> None:
    rows = "".join(f"{3 + t * 1e-9:.15f},{f:.5f}\n" for t, f in zip(TIME, FORCE, strict=True))
    (tmp_path / "log.csv").write_text("time,force_N\n" + rows)
    with pytest.raises(InputError, match=r"would be 2\.5e\+11 Hz"):
        read(tmp_path / "log.csv")


def test_a_name_that_stands_twice_is_asked_by_its_number(tmp_path: Path) -> None:
    rows = "".join(f"{t:.4f},{f:.5f},{a:.5f}\n" for t, f, a in zip(TIME, FORCE, ACCELERATION, strict=True))
    (tmp_path / "log.csv").write_text("Time (s),Acc,Acc\n" + rows)
    with pytest.raises(InputError) as error:
        read(tmp_path / "log.csv")
    assert "--units 1=…,2=…" in error.value.mend
    recording = read_one(tmp_path / "log.csv", ReadOptions(units={"1": "g", "2": "m/s^2"}))
    np.testing.assert_allclose(recording["acceleration"], G * FORCE, atol=1e-4)


def test_rows_in_brackets_are_no_text(tmp_path: Path) -> None:
    rows = "".join(f"({t:.4f}, {f:.5f}, {a:.5f})\n" for t, f, a in zip(TIME, FORCE, ACCELERATION, strict=True))
    (tmp_path / "log.txt").write_text(">>> import logger\n" + rows)
    columns, units = {"time": 0, "force": 1, "acceleration": 2}, {"force": "N", "acceleration": "m/s^2"}
    recording = read_one(tmp_path / "log.txt", ReadOptions(columns=columns, units=units))
    np.testing.assert_allclose(recording["force"], FORCE, atol=1e-5)
    np.testing.assert_allclose(recording["acceleration"], ACCELERATION, atol=1e-5)


def test_words_and_empty_cells_at_the_end_of_a_row(tmp_path: Path) -> None:
    """Rows of another width than the table's, with words where the table has words, are left out with their lines."""
    rows = [f"{t:.4f},run,{f:.5f}," for t, f in zip(TIME, FORCE, strict=True)]
    rows[1] = f"0.0040,run,{FORCE[1]:.5f},note"
    rows[40] = "0.16,,"
    (tmp_path / "log.csv").write_text("time_s,state,force_N,remark\n" + "\n".join(rows) + "\n")
    recording = read_one(tmp_path / "log.csv")
    assert recording.names == ("force",)
    assert len(recording.time) == COUNT - 1


def test_a_state_that_begins_with_a_word_for_no_number(tmp_path: Path) -> None:
    many = np.linspace(0.0, 4.0, 1000)
    rows = "".join(f"{t:.4f},{'OPEN' if t < 2 else 'CLOSED'},{np.sin(9 * t):.5f}\n" for t in many)
    (tmp_path / "log.csv").write_text("time_s,valve,force_N\n" + rows)
    recording = read_one(tmp_path / "log.csv")
    assert recording.names == ("force",)
    assert len(recording.time) == 1000


def test_seconds_since_a_start_long_ago_are_no_days(tmp_path: Path) -> None:
    rows = "".join(f"{45000 + k * 5e-5:.6f},{f:.5f}\n" for k, f in enumerate(FORCE))
    (tmp_path / "log.csv").write_text("uptime,force_N\n" + rows)
    assert read_one(tmp_path / "log.csv").sample_rate == pytest.approx(20_000, rel=1e-4)


def test_a_minimum_beside_seconds_is_no_minute(tmp_path: Path) -> None:
    rows = "".join(f"{t:.4f},{k % 7},{f:.5f}\n" for k, (t, f) in enumerate(zip(TIME, FORCE, strict=True)))
    (tmp_path / "log.csv").write_text("sec,min,force_N\n" + rows)
    assert read_one(tmp_path / "log.csv").sample_rate == pytest.approx(RATE)


def test_headerless_counts_are_asked_for(tmp_path: Path) -> None:
    (tmp_path / "log.txt").write_text("".join(f"{4000 * k} {f:.5f}\n" for k, f in enumerate(FORCE)))
    with pytest.raises(InputError, match="250 Hz in us"):
        read(tmp_path / "log.txt")


@pytest.mark.parametrize(
    "names",
    [
        "Run 1: Time (s),Run 1: Force (N),Run 2: Time (s),Run 2: Force (N)",
        "Time (s) Run #1,Force (N) Run #1,Time (s) Run #2,Force (N) Run #2",
        "Data Set 1 Time (s),Data Set 1 Force (N),Data Set 2 Time (s),Data Set 2 Force (N)",
        "Specimen 1,,Specimen 2,\nTime,Force,Time,Force\n(s),(N),(s),(N)",
        "Probe 1,,Probe 2,\nZeit (s),Kraft (N),Zeit (s),Kraft (N)",
    ],
)
def test_runs_side_by_side_are_recordings(tmp_path: Path, names: str) -> None:
    second = [f"{t:.4f},{2 * f:.5f}" if k < 50 else "," for k, (t, f) in enumerate(zip(TIME, FORCE, strict=True))]
    rows = [f"{t:.4f},{f:.5f},{other}" for t, f, other in zip(TIME, FORCE, second, strict=True)]
    (tmp_path / "log.csv").write_text("\n".join([names, *rows]) + "\n")
    one, two = read(tmp_path / "log.csv")
    np.testing.assert_allclose(one["force"], FORCE, atol=1e-5)
    np.testing.assert_allclose(two["force"], 2 * FORCE[:50], atol=1e-5)


def test_names_of_sensors_that_logged_nothing(tmp_path: Path) -> None:
    rows = "".join(f"{t:.4f};{f:.5f};;\n" for t, f in zip(TIME, FORCE, strict=True))
    for names in ("time_s;force_N;acc_g;x_mm", "Time;Force;Acc;X\ns;N;g;mm"):
        (tmp_path / "log.csv").write_text(f"{names}\n{rows}")
        recording = read_one(tmp_path / "log.csv")
        assert recording.names == ("force",)
        assert recording.channels[0].unit == "N"


def test_names_broken_over_lines_within_quotes(tmp_path: Path) -> None:
    rows = "".join(f"{t:.4f},{f:.5f}\n" for t, f in zip(TIME, FORCE, strict=True))
    (tmp_path / "log.csv").write_text('"Time\n(s)","Force\n(N)"\n' + rows.replace("0.0400", "broken"))
    recording = read_one(tmp_path / "log.csv")
    assert recording.names == ("force",)
    assert any("line 14" in note.text + note.where for note in recording.warnings)  # as the file counts them


@pytest.mark.parametrize("names", ["Reading,Unit,Time (s)", "Force,,Time (s)"])
def test_units_in_cells_of_their_own(tmp_path: Path, names: str) -> None:
    rows = "".join(f"{f / POUND:.6f},lbf,{t:.4f}\n" for t, f in zip(TIME, FORCE, strict=True))
    (tmp_path / "log.csv").write_text(f"{names}\n{rows}")
    (channel,) = read_one(tmp_path / "log.csv").channels
    assert channel.unit == "N"
    np.testing.assert_allclose(channel.samples, FORCE, atol=1e-5)


@pytest.mark.parametrize("names", ["in s,C1 in V", "[s],[V]"])
def test_units_without_names(tmp_path: Path, names: str) -> None:
    rows = "".join(f"{t:.4f},{f:.5f}\n" for t, f in zip(TIME, FORCE, strict=True))
    (tmp_path / "log.csv").write_text(f"{names}\n{rows}")
    (channel,) = read_one(tmp_path / "log.csv").channels
    assert channel.unit == "V"


def test_a_matrix_as_it_is_shown_is_refused(tmp_path: Path) -> None:
    rows = "".join(f"    {t / 1e3:.4f}    {f / 1e3:.4f}\n" for t, f in zip(TIME, FORCE, strict=True))
    (tmp_path / "log.txt").write_text(f"A =\n\n   1.0e+03 *\n\n{rows}")
    with pytest.raises(InputError, match="few digits"):
        read(tmp_path / "log.txt", ReadOptions(fs=250))


@pytest.mark.parametrize(
    ("names", "encoding"),
    [("시간(s),하중(N)", "euc_kr"), ("Idő (s),Erő (N)", "cp1250"), ("Χρόνος (s),Δύναμη (N)", "cp1253"),
     ("Süre (s),Yük (N)", "cp1254"), ("Aika (s),Voima (N)", "ascii")],
)  # fmt: skip
def test_words_of_more_languages(tmp_path: Path, names: str, encoding: str) -> None:
    rows = "".join(f"{t:.4f},{f:.5f}\n" for t, f in zip(TIME, FORCE, strict=True))
    (tmp_path / "log.csv").write_bytes(f"{names}\n{rows}".encode(encoding))
    assert read_one(tmp_path / "log.csv").names == ("force",)


def test_a_clock_in_no_known_unit_is_left_out_beside_another(tmp_path: Path) -> None:
    rows = "".join(f"{4 * k},{t:.4f},{f:.5f}\n" for k, (t, f) in enumerate(zip(TIME, FORCE, strict=True)))
    (tmp_path / "log.csv").write_text("uptime,time_s,force_N\n" + rows)
    recording = read_one(tmp_path / "log.csv")
    assert recording.sample_rate == pytest.approx(RATE)
    assert any("uptime left out" in note.text for note in recording.notes)
