"""Printed numbers, decimal signs, units and headers."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.units import QUANTITY_OF_UNIT, find_unit, to_si
from ssmr_ident.readers import ReadOptions, read_one
from ssmr_ident.readers.table.headings import heading_of, is_units_row, quantity_of, split_header
from ssmr_ident.readers.text.numbers import evidence_for_decimal, number
from ssmr_ident.readers.text.stamps import is_date, is_stamp, seconds_of


@pytest.mark.parametrize(
    ("token", "decimal", "value"),
    [
        ("1.5", ".", 1.5), ("-1,5", ",", -1.5),
        ("1,152.0", ".", 1152.0), ("1.234,56", ",", 1234.56), ("1e-3", ".", 1e-3),
        ("0,0000E+0", ",", 0.0), (".5", ".", 0.5), ("5.", ".", 5.0), ("1'234.5", ".", 1234.5), ("1 234,5", ",", 1234.5),
        ("1.5D-3", ".", 1.5e-3), ("Inf", ".", math.inf), ("-1.#INF", ".", -math.inf), ("12,345,678", ".", 12345678.0),
    ],
)  # fmt: skip
def test_number(token: str, decimal: str, value: float) -> None:
    assert number(token, decimal) == value


@pytest.mark.parametrize("token", ["NaN", "-1.#IND", "1.#QNAN", "-nan(ind)", "#N/A"])
def test_marks_for_no_number(token: str) -> None:
    assert math.isnan(number(token))


@pytest.mark.parametrize(
    "token", ["1_000", "abc", "1.2.3", "", " ", "0x10", "1,5", "٣", "1e", "--1", "0,001", "1e99999", "12,34"]
)
def test_text_is_no_number(token: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(token)}$"):
        number(token, ".")


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_every_double_comes_back(value: float) -> None:
    assert number(repr(value)) == value
    assert number(repr(value).replace(".", ","), ",") == value


@pytest.mark.parametrize(
    ("token", "sign"),
    [("1.5", "."), ("0,001", ","), ("1.234", ""), ("1.234,5", ","), ("1,234.5", "."), ("1,234,567", "."),
     ("1234", ""), ("1.2345", "."), ("-12,345", ""), ("1234,567", ",")],
)  # fmt: skip
def test_evidence(token: str, sign: str) -> None:
    assert evidence_for_decimal(token) == sign


def seconds(*cells: str) -> list[float]:
    return seconds_of([cell.encode() for cell in cells]).seconds.tolist()


def test_clock_times() -> None:
    assert seconds("14:03:11.5") == [14 * 3600 + 3 * 60 + 11.5]
    assert seconds("2:03:11 PM") == seconds("14:03:11")
    assert seconds("12:00:00 AM", "02:03.25") == [0.0, 123.25]
    assert not any(map(is_stamp, ("25:00:00", "12:61:00", "13:00:00 PM", "12.5", "1" * 20_000 + ":x")))


@pytest.mark.parametrize(
    "cell",
    ["2012/05/10 14:03:11.25", "2012-05-10T14:03:11.250Z", "10.05.2012 14:03:11,25", "10-May-2012 14:03:11.25",
     "May 10, 2012 2:03:11.25 PM", "2012-05-10 14:03:11.25 UTC+00:00", "10 mai 2012 14:03:11.25"],
)  # fmt: skip
def test_dates(cell: str) -> None:
    assert is_stamp(cell)
    assert seconds(cell) == [1336658591.25]


def test_the_column_says_which_is_the_day() -> None:
    assert seconds("02/28/2024", "02/29/2024") == [1709078400.0, 1709164800.0]
    assert seconds("28/02/2024", "29/02/2024") == [1709078400.0, 1709164800.0]
    assert np.diff(seconds("01/02/2024 23:59:59", "02/02/2024 00:00:01")) == [2.0]
    assert np.isnan(seconds("2012/02/31 10:00:00", "2012/02/28 10:00:00")).tolist() == [True, False]
    assert is_date("1.3.2024")
    assert not is_date("1.3")


# Factors from NIST SP 811 (2008), appendix B.8
@pytest.mark.parametrize(
    ("unit", "si", "factor"),
    [("lbf", "N", 4.4482216152605), ("kgf", "N", 9.80665), ("in", "m", 0.0254), ("psi", "Pa", 6894.757293168361),
     ("ksi", "Pa", 6894757.293168361), ("kip", "N", 4448.2216152605), ("g", "m/s^2", 9.80665),
     ("deg", "rad", math.pi / 180),
     ("rpm", "rad/s", 0.10471975511965977), ("µm", "m", 1e-6), ("m/s²", "m/s^2", 1.0), ("Sec", "s", 1.0),
     ("°/s", "rad/s", math.pi / 180),
     ("N/mm²", "Pa", 1e6), ("mm/min", "m/s", 1e-3 / 60), ("Volts", "V", 1.0), ("mN", "N", 1e-3), ("MN", "N", 1e6),
     ("N.m", "N m", 1.0), ("m.s-2", "m/s^2", 1.0), ("Ncm", "N m", 1e-2), ("min⁻¹", "rad/s", 0.10471975511965977),
     ("tr/min", "rad/s", 0.10471975511965977), ("mph", "m/s", 0.44704), ("mbar", "Pa", 100.0), ("µε", "1", 1e-6),
     ("mGal", "m/s^2", 1e-5), ("mils", "m", 2.54e-5)],
)  # fmt: skip
def test_units(unit: str, si: str, factor: float) -> None:
    assert to_si(unit).unit == si
    assert to_si(unit).factor == pytest.approx(factor, rel=1e-15)


def test_temperatures_have_an_offset() -> None:
    assert 20 * to_si("°C").factor + to_si("°C").offset == 293.15
    assert 68 * to_si("degF").factor + to_si("degF").offset == pytest.approx(293.15)


def test_case_is_not_guessed_where_it_matters() -> None:
    assert find_unit("MN") != find_unit("mN")
    assert find_unit("Mn") is None
    assert find_unit("KN") == find_unit("kN")


def test_unknown_unit_names_the_nearest() -> None:
    with pytest.raises(ValueError, match="Did you mean 'lbf'"):
        to_si("lbff")


def test_every_quantity_has_an_si_unit() -> None:
    assert all(find_unit(unit) is not None and find_unit(unit).factor == 1 for unit in QUANTITY_OF_UNIT)


@pytest.mark.parametrize(
    ("header", "label", "unit"),
    [("Load (N)", "Load", "N"), ('"Force [kN]"', "Force", "kN"), ("Time - sec", "Time", "sec"),
     ("time[0]", "time[0]", None),
     ("Amplitude - Plot 0", "Amplitude - Plot 0", None), ("Temp (°C)", "Temp", "°C"), ("Crosshead ", "Crosshead", None),
     ("F/N", "F", "N"), ("a (m/s^2)", "a", "m/s^2"), ("Dev0/Ai0", "Dev0/Ai0", None)],
)  # fmt: skip
def test_headers(header: str, label: str, unit: str | None) -> None:
    assert split_header(header) == (label, unit)


@pytest.mark.parametrize(
    ("label", "unit", "quantity"),
    [("Load", "N", "force"), ("Standardkraft", None, "force"), ("Axial Displacement", "mm", "position"),
     ("Running Time", None, "time"), ("F", "N", "force"), ("F", "g", None), ("a", "m/s^2", "acceleration"),
     ("a", None, None),
     ("m_1", "m/s^2", None), ("Prüfzeit", None, "time"), ("force_timestamp", None, "time"), ("Voltage_0", "V", None),
     ("ax", "V", "ax"), ("Strain 1", None, "strain"), ("Time - Plot 0", None, "time"), ("Peak Load", "N", None)],
)  # fmt: skip
def test_quantities(label: str, unit: str | None, quantity: str | None) -> None:
    assert quantity_of(label, unit) == quantity


def test_units_rows() -> None:
    assert is_units_row(["(s)", "(mm)", "(N)"])
    assert is_units_row(["s", "mm", "N", ""])
    assert not is_units_row(["Time", "Load"])
    assert not is_units_row([])


def log(tmp_path: Path, text: str, **options: object):
    path = tmp_path / "log.txt"
    path.write_text(text, encoding="utf-8")
    return read_one(path, ReadOptions(**options))  # type: ignore[arg-type]


ROWS = [(0.1 * k, 1000.5 + k) for k in range(12)]


def test_thousands_in_quotes(tmp_path: Path) -> None:
    text = "Time (s),Load (N)\n" + "".join(f'{t:.1f},"{f:,.1f}"\n' for t, f in ROWS)
    np.testing.assert_array_equal(log(tmp_path, text)["force"], [f for _, f in ROWS])


def test_german_thousands(tmp_path: Path) -> None:
    rows = "".join(f"{t:.1f};{f:,.1f}\n".replace(",", "_").replace(".", ",").replace("_", ".") for t, f in ROWS)
    np.testing.assert_array_equal(log(tmp_path, "Zeit (s);Kraft (N)\n" + rows)["force"], [f for _, f in ROWS])


def test_undecidable_numbers_are_refused(tmp_path: Path) -> None:
    text = "Time (s)\tLoad (N)\n" + "".join(f"{k}\t{k + 1}.{k:03d}\n" for k in range(1, 12))
    with pytest.raises(InputError, match="decimal or a thousands separator"):
        log(tmp_path, text)
    assert log(tmp_path, text, decimal=".")["force"][0] == 2.001
    assert log(tmp_path, text, decimal=",")["force"][0] == 2001.0


def test_comma_for_everything_is_refused(tmp_path: Path) -> None:
    text = "Time,Load\n" + "".join(f"{k},5,{k},25\n" for k in range(12))
    with pytest.raises(InputError, match="comma as separator and as decimal sign"):
        log(tmp_path, text)


def test_no_unit_is_refused_and_can_be_given(tmp_path: Path) -> None:
    text = "Time,Position,Load\n" + "".join(f"{k / 10},{k},{2 * k}\n" for k in range(12))
    with pytest.raises(InputError, match=r"unit of Position, Load unknown .*Give --units Position=…,Load=…"):
        log(tmp_path, text)
    recording = log(tmp_path, text, units={"load": "lbf", "pos": "in"})
    np.testing.assert_allclose(recording["force"], 2 * np.arange(12) * 4.4482216152605, rtol=1e-15)
    np.testing.assert_allclose(recording["position"], np.arange(12) * 0.0254, rtol=1e-15)
    assert any("lbf × 4.4482216 = N" in note.text for note in recording.notes)


def test_unit_of_another_quantity_is_refused(tmp_path: Path) -> None:
    text = "Time (s),Load (g)\n" + "".join(f"{k / 10},{k}\n" for k in range(12))
    with pytest.raises(InputError, match="Load is in g, which is no unit of force"):
        log(tmp_path, text)
    assert log(tmp_path, text, units={"Load": "gf"})["force"][1] == pytest.approx(9.80665e-3)


def test_user_columns(tmp_path: Path) -> None:
    text = "A,B,C\n" + "".join(f"{k / 10},{k},{2 * k}\n" for k in range(12))
    recording = log(tmp_path, text, columns={"time": 0, "force": "C"}, units={"force": "kN"})
    assert recording.names == ("force",)
    np.testing.assert_array_equal(recording["force"], 2e3 * np.arange(12))
    assert recording.channel("force").label == "C"
    assert any("columns not read" in note.text and "B" in note.text for note in recording.notes)
    with pytest.raises(InputError, match="has no column 'D' for force"):
        log(tmp_path, text, columns={"time": 0, "force": "D"})


def test_labels_of_a_rig_log_stay(tmp_path: Path) -> None:
    text = "time (s),F (N),a (m/s^2)\n" + "".join(f"{k / 1000:.3f},{k},{2 * k}\n" for k in range(12))
    recording = log(tmp_path, text)
    assert [(c.name, c.label) for c in recording.channels] == [("force", "F"), ("acceleration", "a")]


def test_a_unit_of_another_quantity_decides_where_it_is_sure(tmp_path: Path) -> None:
    text = "Time (s),Strain (mm),velocity [rad/s]\n" + "".join(f"{k / 10},{k},{2 * k}\n" for k in range(12))
    recording = log(tmp_path, text)
    assert [(c.name, c.unit) for c in recording.channels] == [("Strain", "m"), ("velocity", "rad/s")]
    assert sum("taken by its unit" in note.text for note in recording.warnings) == 2
    assert log(tmp_path, text, channels={"angular_rate": "velocity"}).names == ("Strain", "angular_rate")


def test_a_vocabulary_beside_the_log_adds_words_and_units(tmp_path: Path) -> None:
    text = "Time (s),pinch (furlong)\n" + "".join(f"{k / 10},{k}\n" for k in range(12))
    (tmp_path / "vocabulary.yaml").write_text(
        "quantities: {position: {words: {en: [pinch]}}}\nunits: {furlong: {unit: m, factor: 201.168}}\n"
    )
    np.testing.assert_allclose(log(tmp_path, text)["position"], 201.168 * np.arange(12))
    (tmp_path / "vocabulary.yaml").write_text("quantity: {}\n")
    with pytest.raises(InputError, match="quantity: is not a known key"):
        log(tmp_path, text)


@pytest.mark.parametrize(
    ("header", "quantity", "unit"),
    [("force_N", "force", "N"), ("accel_x_g", "ax", "m/s^2"), ("ax_m_s2", "ax", "m/s^2"), ("TimeUS", "time", "s"),
     ("Acc/(m/s^2)", "acceleration", "m/s^2"), ("AngVel/rad/s", "angular_rate", "rad/s"), ("a (in/s²)", "acceleration",
     "m/s^2"), ("Fuerza [kip]", "force", "N"), ("Accélération Z [mg]", "az", "m/s^2"),
     ("Prüfkraft in kN", "force", "N"),
     ("Drehrate x [°/s]", "wx", "rad/s"), ("desplazamiento_mm", "position", "m"),
     ("omega_rad_s", "angular_rate", "rad/s")],
)  # fmt: skip
def test_quantity_and_unit_in_one_name(header: str, quantity: str, unit: str) -> None:
    heading = heading_of(header)
    assert heading.quantity == quantity
    found = find_unit(heading.unit or "")
    assert found is not None
    assert found.unit == unit
