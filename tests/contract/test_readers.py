"""One list of scenarios, (a file, the recordings in it), and every reader test runs on all of them.

A new format joins by adding scenarios; the list's completeness is itself tested.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.readers import READERS, ReadOptions, read, read_one
from ssmr_ident.readers.writers import write_csv, write_labview_xlsx, write_lvm, write_mtestquattro

N = 200
TIME = np.arange(N) * 1e-3


@dataclass(frozen=True)
class Expected:
    """What must come out: reader, time and channels (name -> unit, samples), one dict per recording."""

    reader: str
    channels: list[dict[str, tuple[str, np.ndarray]]]
    time: list[np.ndarray]
    options: ReadOptions = field(default_factory=ReadOptions)


Scenario = Callable[[Path], tuple[Path, Expected]]
SCENARIOS: dict[str, Scenario] = {}


def scenario(function: Scenario) -> Scenario:
    SCENARIOS[function.__name__] = function
    return function


def volts() -> Recording:
    values = 2.6 + 0.3 * np.random.default_rng(3).standard_normal((3, N)).round(4)
    channels = tuple(
        Channel(f"a{a}", v.round(6), "V", f"Voltage_{i}") for i, (a, v) in enumerate(zip("xyz", values, strict=True))
    )
    return Recording(TIME, channels, Provenance("", "", ""))


def pull() -> Recording:
    rng = np.random.default_rng(4)
    position = np.linspace(0, 0.02, N).round(7)
    force = (40 * (1 - np.exp(-position * 400)) + rng.standard_normal(N)).round(3)
    channels = Channel("position", position, "m", "Position"), Channel("force", force, "N", "Load")
    return Recording(TIME * 10, channels, Provenance("", "", ""))


def expected(reader: str, recording: Recording, **options: object) -> Expected:
    channels = {c.name: (c.unit, c.samples) for c in recording.channels}
    return Expected(reader, [channels], [recording.time], ReadOptions(**options))  # type: ignore[arg-type]


@scenario
def workbook_from_a_graph(folder: Path) -> tuple[Path, Expected]:
    return write_labview_xlsx(folder / "a.xlsx", volts()), expected("labview-xlsx", volts())


@scenario
def workbook_with_a_segment_header(folder: Path) -> tuple[Path, Expected]:
    return write_labview_xlsx(folder / "a.xlsx", volts(), header="segment"), expected("labview-xlsx", volts())


@scenario
def workbook_of_bare_numbers_with_named_sheets(folder: Path) -> tuple[Path, Expected]:
    path = write_labview_xlsx(folder / "a.bin", volts(), header="none", sheet_names=("z", "y", "x"))
    return path, expected("labview-xlsx", volts())


@scenario
def lvm_as_written(folder: Path) -> tuple[Path, Expected]:
    return write_lvm(folder / "a.lvm", volts()), expected("lvm", volts())


@scenario
def lvm_with_decimal_comma_under_another_name(folder: Path) -> tuple[Path, Expected]:
    return write_lvm(folder / "a.txt", volts(), decimal=","), expected("lvm", volts())


@scenario
def lvm_with_two_segments(folder: Path) -> tuple[Path, Expected]:
    path = write_lvm(folder / "a.lvm", volts())
    text = path.read_text()
    path.write_text(text + "\t\n" + text[text.index("Channels") :])
    one = expected("lvm", volts())
    return path, Expected("lvm", one.channels * 2, one.time * 2)


@scenario
def tdms(folder: Path) -> tuple[Path, Expected]:
    nptdms = pytest.importorskip("nptdms")
    with nptdms.TdmsWriter(folder / "a.tdms") as writer:
        writer.write_segment(
            [
                nptdms.ChannelObject("G", c.label, c.samples, {"wf_increment": 1e-3, "unit_string": "V"})
                for c in volts().channels
            ]
        )
    return folder / "a.tdms", expected("tdms", volts())


@scenario
def machine_with_a_units_row(folder: Path) -> tuple[Path, Expected]:
    return write_mtestquattro(folder / "a.txt", pull()), expected("mtestquattro", pull())


@scenario
def machine_with_facts_above(folder: Path) -> tuple[Path, Expected]:
    facts = {"Sample": "1", "Procedure": "Rolling force", "Date": "5/10/2012", "Time": "2:03:11 PM"}
    return write_mtestquattro(folder / "a.csv", pull(), style="csv", facts=facts), expected("mtestquattro", pull())


@scenario
def machine_xml(folder: Path) -> tuple[Path, Expected]:
    recording = pull()
    rows = zip(recording.time, recording["position"], recording["force"], strict=True)
    lines = [f'<Sample TIME="{1e3 * t:.0f}" POSN="{p:.7f}" LOAD="{f / 10:.4f}"/>' for t, p, f in rows]
    (folder / "a.mtwData").write_text("<TestData>\n" + "\n".join(lines) + "\n</TestData>")
    return folder / "a.mtwData", expected("mtestquattro", recording, load_scale=10.0)


@scenario
def two_specimens_and_a_results_table(folder: Path) -> tuple[Path, Expected]:
    path = write_mtestquattro(folder / "a.csv", pull(), style="csv", facts={"Sample": "1"})
    text = path.read_text()
    results = "Results\nSample,Peak Load (N),Position at Peak (mm)\n1,40.1,20.0\n2,40.1,20.0\nMean,40.1,20.0\n"
    path.write_text(f"{text}\n{text}\n{results}")
    one = expected("mtestquattro", pull())
    return path, Expected("mtestquattro", one.channels * 2, one.time * 2)


@scenario
def plain_csv(folder: Path) -> tuple[Path, Expected]:
    return write_csv(folder / "a.csv", pull()), expected("mtestquattro", pull())


@scenario
def german_csv(folder: Path) -> tuple[Path, Expected]:
    recording = pull()
    columns = zip(recording.time, recording["position"] * 1e3, recording["force"] / 1e3, strict=True)
    lines = [f"{t:.2f};{p:.4f};{f:.6f}".replace(".", ",") for t, p, f in columns]
    text = "\n".join(["Prüfer;Müller", "Zeit;Weg;Kraft", "[s];[mm];[kN]", *lines])
    (folder / "a.csv").write_bytes(text.encode("utf-16"))
    return folder / "a.csv", expected("mtestquattro", recording)


@scenario
def csv_of_unknown_quantities(folder: Path) -> tuple[Path, Expected]:
    recording = Recording(TIME, (Channel("qm", TIME**2, "m"), Channel("V1", TIME - 0.1, "V")), Provenance("", "", ""))
    return write_csv(folder / "a.csv", recording), expected("csv", recording)


@pytest.fixture(params=SCENARIOS.values(), ids=SCENARIOS.keys())
def case(request: pytest.FixtureRequest, tmp_path: Path) -> tuple[Path, Expected]:
    return request.param(tmp_path)


def test_every_reader_has_a_scenario(tmp_path: Path) -> None:
    seen = set()
    for number, make in enumerate(SCENARIOS.values()):
        folder = tmp_path / str(number)
        folder.mkdir()
        seen.add(make(folder)[1].reader)
    # those through a library are written and read back in test_reader_libraries.py
    through = {"mat", "hdf5", "parquet", "uff", "wav", "json", "zip", "npz", "npy", "rosbag", "gzip", "bzip2", "xz"}
    assert seen | through == set(READERS)


def test_values_units_and_time(case: tuple[Path, Expected]) -> None:
    path, wanted = case
    recordings = read(path, wanted.options)
    assert len(recordings) == len(wanted.channels)
    for recording, channels, time in zip(recordings, wanted.channels, wanted.time, strict=True):
        assert recording.provenance.reader == wanted.reader
        assert recording.names == tuple(channels)
        np.testing.assert_allclose(recording.time, time, rtol=1e-12, atol=1e-12)
        for name, (unit, samples) in channels.items():
            assert recording.channel(name).unit == unit
            np.testing.assert_allclose(recording[name], samples, rtol=1e-12, atol=1e-12)


def test_recordings_are_sound(case: tuple[Path, Expected]) -> None:
    path, wanted = case
    for recording in read(path, wanted.options):
        assert recording.provenance.file == str(path)
        assert recording.provenance.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()
        assert (np.diff(recording.time) > 0).all()
        assert all(c.samples.dtype == float and c.samples.flags.c_contiguous for c in recording.channels)
        assert len(set(recording.names)) == len(recording.names)
        assert all(c.label and "(" not in c.label and "[" not in c.label for c in recording.channels)
        assert all(note.level in ("info", "warning") and note.text for note in recording.notes)


def test_the_name_does_not_matter(case: tuple[Path, Expected]) -> None:
    path, wanted = case
    first = read(path, wanted.options)
    for name in ("log", "log.csv", "log.lvm", "log.xlsx", "log.dat"):
        second = read(path.rename(path.with_name(name)), wanted.options)
        path = path.with_name(name)
        for a, b in zip(first, second, strict=True):
            assert a.names == b.names
            assert all(np.array_equal(x.samples, y.samples) for x, y in zip(a.channels, b.channels, strict=True))


def test_naming_the_reader_changes_nothing(case: tuple[Path, Expected]) -> None:
    path, wanted = case
    named = ReadOptions(reader=wanted.reader, load_scale=wanted.options.load_scale)
    for a, b in zip(read(path, wanted.options), read(path, named), strict=True):
        assert all(np.array_equal(x.samples, y.samples) for x, y in zip(a.channels, b.channels, strict=True))


def test_the_wrong_reader_is_refused(case: tuple[Path, Expected]) -> None:
    path, wanted = case
    other = "tdms" if wanted.reader != "tdms" else "lvm"
    with pytest.raises(InputError, match="is not what reader"):
        read(path, ReadOptions(reader=other))


def test_one_of_several(case: tuple[Path, Expected]) -> None:
    path, wanted = case
    count = len(wanted.channels)
    if count == 1:
        assert read_one(path, wanted.options).names == tuple(wanted.channels[0])
        return
    with pytest.raises(InputError, match=f"holds {count} recordings") as caught:
        read_one(path)
    assert "sample: 1" in caught.value.mend
    last = read_one(path, ReadOptions(sample=count))
    np.testing.assert_allclose(last.time, wanted.time[-1], atol=1e-12)
    with pytest.raises(InputError, match=f"number {count + 1} is not there"):
        read(path, ReadOptions(sample=count + 1))


def test_a_rate_replaces_the_time_column(case: tuple[Path, Expected]) -> None:
    path, wanted = case
    if len(wanted.channels) > 1:
        pytest.skip("time tells the specimens apart")
    options = ReadOptions(fs=250.0, load_scale=wanted.options.load_scale)
    recording = read_one(path, options)
    np.testing.assert_allclose(recording.time, np.arange(N) / 250.0, atol=1e-12)
    assert recording.names == tuple(wanted.channels[0])


def test_cut_files_are_read_short_or_refused(case: tuple[Path, Expected]) -> None:
    """A log that lost its end gives the samples before it, or says so; never other numbers."""
    path, wanted = case
    data = path.read_bytes()
    for length in np.random.default_rng(5).integers(1, len(data), 25):
        path.write_bytes(data[:length])
        try:
            recordings = read(path, wanted.options)
        except InputError:
            continue
        for recording, channels in zip(recordings, wanted.channels, strict=False):
            for name, channel in zip(channels, recording.channels, strict=False):
                got = channel.samples
                np.testing.assert_allclose(got, channels[name][1][: len(got)], rtol=1e-12, atol=1e-12)
