"""Feed the readers mutated logs: only a Recording or an InputError may come out, soon and without much memory.

Seeds are the files of the folders given, or small logs of every format that this package writes itself. Bytes are
flipped, cut, doubled, swapped and replaced by what trips parsers; the parts of a workbook are mutated inside the
zip as well, with the checksums made right again, or nothing would ever get behind the door.

Each log is read in a warm child, under a limit of time, and its memory is measured. Time is the processor's, there and
in the process that compiled libraries read in; memory is the larger of the two.

Run: python benchmarks/fuzz_readers.py [--count 20000] [--minutes 20] [--seed 0] [--keep FOLDER] [FOLDER...]
"""

from __future__ import annotations

import argparse
import gzip
import io
import math
import sys
import tempfile
import time
import traceback
import warnings
import zipfile
from collections import Counter
from collections.abc import Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path

import numpy as np
from limited_child import MEGABYTES, Child

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.readers import read
from ssmr_ident.readers.writers import write_csv, write_labview_xlsx, write_lvm, write_mtestquattro

TOKENS = (
    b"NaN", b"-1.#IND", b"1e999", b"-1e-999", b"0,5", b"1.234.567,8", b"\0", b"\xff\xfe", b"\xef\xbb\xbf", b'"',
    b"'", b"\t\t\t", b";;;", b",,,", b"\r\n\r\n", b"***End_of_Header***", b"LabVIEW Measurement", b"X_Value",
    b"99999999999", b"-0", b"<!DOCTYPE a [<!ENTITY b 'c'>]>", b"&b;", b"]]>", b"<", b"XFD1048576", b"A0",
    b"Samples\t1", b"TDSm", b"PK\x03\x04", b"24:61:61", b"2012/02/31 25:00:00", "°µ²Ω".encode(), b"_", b"1_000",
    b"__import__('os')", b"%s%n", b"../../", b" " * 300,
)  # fmt: skip


RARE = 0.25
"""How often a log for the compiled loops is taken, where a short one is once: it costs ten times as much."""


def seeds(folders: list[Path]) -> list[tuple[str, bytes]]:
    """Name and bytes of the logs to begin with."""
    files = sorted(f for folder in folders for f in folder.iterdir() if f.is_file() and f.stat().st_size < 200_000)
    return ([(file.name, file.read_bytes()) for file in files] or own_logs()) + long_logs()


def long_logs() -> list[tuple[str, bytes]]:
    """Logs long enough for the compiled loops."""
    rng = np.random.default_rng(1)
    rows = [f"{k / 1000:.3f},{f:.6f}" for k, f in enumerate(rng.standard_normal(15_000))]
    text = "\n".join(["Time (s),Load (N)", *rows]) + "\n"
    head = "LabVIEW Measurement\nWriter_Version,2\nSeparator,Comma\n***End_of_Header***\n\nChannels,1\nDelta_X,0.001\n"
    lvm = f"{head}***End_of_Header***\nX_Value,Voltage_0\n" + "\n".join(rows) + "\n"
    return [("long.csv", text.encode()), ("long.lvm", lvm.encode())]


def own_logs() -> list[tuple[str, bytes]]:
    """A small log of every format that the writers know."""
    rng = np.random.default_rng(0)
    time_axis = np.arange(40) * 1e-3
    volts = tuple(
        Channel(f"a{a}", 2.6 + 0.1 * rng.standard_normal(40), "V", f"Voltage_{i}") for i, a in enumerate("xyz")
    )
    pull = (
        Channel("position", time_axis, "m", "Position"),
        Channel("force", rng.standard_normal(40), "N", "Load"),
    )
    accelerometer = Recording(time_axis, volts, Provenance("", "", ""))
    machine = Recording(time_axis, pull, Provenance("", "", ""))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_csv(folder / "a.csv", machine)
        write_lvm(folder / "b.lvm", accelerometer)
        write_lvm(folder / "c.lvm", accelerometer, decimal=",")
        write_mtestquattro(folder / "d.txt", machine)
        write_mtestquattro(folder / "e.csv", machine, style="csv", facts={"Sample": "1"})
        for header in ("graph", "segment", "none"):
            write_labview_xlsx(folder / f"{header}.xlsx", accelerometer, header=header)
        rows = "".join(f'<Sample TIME="{k}" POSN="{k}e-5" LOAD="{k}"/>\n' for k in range(20))
        (folder / "f.mtwData").write_text(f"<TestData><Samples>\n{rows}</Samples></TestData>")
        through_libraries(folder)
        as_strangers_write(folder)
        return [(file.name, file.read_bytes()) for file in sorted(folder.iterdir())]


def through_libraries(folder: Path) -> None:
    """A small log of every format that a library writes."""
    import h5py
    import pandas as pd
    import pyuff
    from scipy.io import savemat, wavfile

    time_axis = np.arange(200) / 200.0
    force = np.sin(9 * time_axis)
    savemat(folder / "g.mat", {"run": {"t": time_axis, "force": force, "units": np.array(["s", "N"], dtype=object)}})
    savemat(folder / "h.mat", {"y": np.column_stack([force, force]), "fs": 200.0}, do_compression=True)
    with h5py.File(folder / "i.h5", "w") as file:
        file["run/time"], file["run/force_N"] = time_axis, force
        file["run"].attrs["fs"] = 200.0
    frame = pd.DataFrame({"time_s": time_axis, "force_N": force, "state": ["on"] * 200})
    frame.to_parquet(folder / "j.parquet")
    frame.to_feather(folder / "k.feather")
    wavfile.write(folder / "l.wav", 200, (1e4 * force).astype(np.int16))
    np.savez(folder / "m.npz", time=time_axis, force_N=force)
    with zipfile.ZipFile(folder / "n.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("log.csv", frame.to_csv(index=False))
    function = {"type": 58, "binary": 0, "func_type": 1, "rsp_node": 1, "rsp_dir": 3, "ref_node": 0, "ref_dir": 0,
                "data": force, "x": time_axis, "id1": "a", "rsp_ent_name": "B", "ref_ent_name": "NONE",
                "abscissa_spacing": 1, "abscissa_spec_data_type": 17, "ordinate_spec_data_type": 13,
                "orddenom_spec_data_type": 0, "ordinate_axis_lab": "Force", "ordinate_axis_units_lab": "N",
                "ordinate_num_data": 2, "ver_num": 1, "load_case_id": 0, "z_axis_value": 0, "ord_data_type": 4,
                "num_pts": 200, "abscissa_min": 0.0, "abscissa_inc": 0.005}  # fmt: skip
    pyuff.UFF(str(folder / "o.uff")).write_sets(function, "add")


def as_strangers_write(folder: Path) -> None:
    """Text in the forms of loggers, phones and monitors."""
    rows = [(k, 1_650_000_000 + k / 200, np.sin(k / 9)) for k in range(60)]
    blanks = [f"{k / 200:.4f},{v:.4f},{'' if k % 4 else f'{v:.3f}'}\n" for k, _, v in rows]
    dates = [f"01.03.2024 12:00:00,{5 * k:03d};{v:.3f};x\n" for k, _, v in rows]
    counts = [f"{int(t * 1e9)},a,{v:.5f}\n" for _, t, v in rows]
    texts = {
        "p.csv": "%time,frame,field.linear_acceleration.x\n" + "".join(counts),
        "q.txt": "".join(f"12:00:{k // 200:02d}.{5 * (k % 200):03d} -> ax:{v:.3f}\tay:{v:.3f}\n" for k, _, v in rows),
        "r.jsonl": "".join(f'{{"ts": {t:.3f}, "imu": {{"force_N": {v:.5f}}}}}\n' for _, t, v in rows),
        "s.csv": "Datum;Kraft [kN];Text\n" + "".join(dates),
        "t.txt": "# fs = 200 Hz\n# ax [g], ay [g]\n" + "".join(f"{v:.4f} {v:.4f}\n" for _, _, v in rows),
        "u.csv": "time [s],ax [m/s^2],force [N]\n" + "".join(blanks),
        "v.csv": "time_s,sensor,value\n" + "".join(f"{k / 200:.4f},force_N,{v:.4f}\n{k / 200:.4f},acc_g,{v:.5f}\n"
                                                   for k, _, v in rows),
        "w.txt": "".join(("" if k % 40 else "Page\nTime Load\n(s) (N)\n") + f"{k / 200:.4f} {v:.5f}\n"
                         for k, _, v in rows),
        "x.csv": "Time,Force\n" + "".join(f"{k / 200:.4f} sec,{v:.5f} N\n" for k, _, v in rows),
        "y.csv": "hour,min,sec,ms,force_N\n" + "".join(f"12,{k // 100},{k % 100 // 2},{k % 2 * 500},{v:.4f}\n"
                                                      for k, _, v in rows),
        "z.txt": "".join(f"[{k / 200:.4f}, {v:.5f}, {v / 2:.5f}]\n" for k, _, v in rows),
        "0.json": f'{{"force_N": {{{", ".join(f"{chr(34)}{k * 5}{chr(34)}: {v:.5f}" for k, _, v in rows)}}}}}',
        "2.csv": '"Run 1: Time\n(s)","Run 1: Force\n(N)","Run 2: Time (s)","Run 2: Force (N)"\n' + "".join(
            f"{k / 200:.4f},{v:.5f},{k / 200:.4f},{v:.5f}\n" for k, _, v in rows),
        "3.csv": "Reading,Unit,Relative Time\n" + "".join(f"{v:.6E},VDC,{k / 200:.4f}\n" for k, _, v in rows),
        "1.jsonl": "".join(f'{{"t0": {k / 20:.3f}, "force_N": {[round(v, 4)] * 10}}}\n' for k, _, v in rows),
    }  # fmt: skip
    for name, text in texts.items():
        (folder / name).write_text(text)
    (folder / "4.csv.gz").write_bytes(gzip.compress(texts["p.csv"].encode()))


def mutated(data: bytes, rng: np.random.Generator) -> bytes:
    """One to eight small accidents."""
    raw = bytearray(data)
    for _ in range(int(rng.integers(1, 9))):
        if not raw:
            break
        at = int(rng.integers(len(raw)))
        length = int(rng.integers(1, 1 + min(64, len(raw) - at)))
        kind = int(rng.integers(9))
        if kind == 0:
            raw[at] ^= 1 << int(rng.integers(8))
        elif kind == 1:
            raw[at : at + length] = rng.integers(0, 256, length, dtype=np.uint8).tobytes()
        elif kind == 2:
            del raw[at : at + length]
        elif kind == 3:
            raw[at:at] = raw[at : at + length] * int(rng.integers(1, 5))
        elif kind == 4:
            token = TOKENS[int(rng.integers(len(TOKENS)))]
            raw[at : at + (length if rng.integers(2) else 0)] = token
        elif kind == 5:
            del raw[at:]
        elif kind == 6:
            lines = bytes(raw).split(b"\n")
            i, j = rng.integers(len(lines), size=2)
            lines[i], lines[j] = lines[j], lines[i]
            raw = bytearray(b"\n".join(lines))
        elif kind == 7:
            old, new = (b".,;\t \n0-"[int(k) : int(k) + 1] for k in rng.integers(8, size=2))
            raw = raw.replace(old, new, int(rng.integers(1, 200)))
        else:
            raw[at : at + length] = bytes(length)
    return bytes(raw)


def mutated_inside(data: bytes, rng: np.random.Generator) -> bytes:
    """Mutate one part of a zip and pack it again."""
    try:
        archive = zipfile.ZipFile(io.BytesIO(data))
        parts = {name: archive.read(name) for name in archive.namelist()}
    except (zipfile.BadZipFile, ValueError, OSError, NotImplementedError):
        return mutated(data, rng)
    names = [name for name in parts if "sheet" in name or "workbook" in name or rng.random() < 0.2]
    names = names or list(parts)
    if not names:
        return mutated(data, rng)
    victim = names[int(rng.integers(len(names)))]
    parts[victim] = mutated(parts[victim], rng)
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as packed:
        for name, part in parts.items():
            packed.writestr(name, part)
    return buffer.getvalue()


def judged(path: Path) -> str:
    """What reading a log came to: ``read``, ``refused``, or what must not be."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            recordings = read(path)
    except InputError as error:
        return "refused" if "\n" not in str(error) else "many lines"
    except Exception:
        return f"traceback: {traceback.format_exc(limit=-4)}"
    good = recordings and all((np.diff(r.time) > 0).all() and len(r.time) > 1 for r in recordings)
    return "read" if good else "bad recording"


def warm(folder: Path, logs: Sequence[tuple[str, bytes]]) -> None:
    """Read each log once as it is."""
    for name, data in logs:
        (folder / name).write_bytes(data)
        with suppress(InputError):  # the folders given may hold malformed samples
            read(folder / name)


def run(
    count: int,
    seed: int,
    folders: list[Path],
    *,
    minutes: float = math.inf,
    keep: Path | None = None,
    progress: bool = False,
) -> tuple[Counter[str], list[str], float, float]:
    """Read ``count`` mutated logs, or as many as ``minutes`` allow; those that fail are kept in ``keep``.

    Returns
    -------
    outcomes : Counter
        ``read``, ``refused`` and what must not be: ``traceback``, ``slow``, ``large``, ``bad recording``, ``died`` …
    failures : list of str
    slowest, largest : float
        Processor time of one log [s], and memory [MB].
    """
    rng = np.random.default_rng(seed)
    logs = seeds(folders)
    often = np.array([RARE if name.startswith("long.") else 1.0 for name, _ in logs])
    often /= often.sum()
    outcomes: Counter[str] = Counter()
    failures: list[str] = []
    slowest, largest, end = 0.0, 0.0, time.monotonic() + 60 * minutes
    with tempfile.TemporaryDirectory() as folder:
        child = Child(Path(folder), partial(warm, logs=logs), judged)
        try:
            for number in range(count):
                if time.monotonic() > end:
                    break
                name, data = logs[int(rng.choice(len(logs), p=often))]
                inside = data[:2] == b"PK" and rng.random() < 0.7
                raw = (mutated_inside if inside else mutated)(data, rng)
                outcome, spent, memory = child.ask(name, raw)
                if memory > MEGABYTES:
                    outcome = f"large: {memory:.0f} MB, {outcome}"
                slowest, largest = max(slowest, spent), max(largest, memory)
                outcomes[outcome.partition(":")[0]] += 1
                if outcome not in ("read", "refused"):
                    failures.append(f"#{number} {name}: {outcome}, {spent:.1f} s")
                    if keep is not None:
                        keep.mkdir(parents=True, exist_ok=True)
                        (keep / f"{seed}-{number}-{name}").write_bytes(raw)
                if progress and number % 1000 == 999:
                    told = f"slowest {slowest:.2f} s, {largest:.0f} MB"
                    print(f"{number + 1}: {dict(outcomes)}, {told}", flush=True)
        finally:
            child.end()
    return outcomes, failures, slowest, largest


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=20_000)
    parser.add_argument("--minutes", type=float, default=math.inf)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--keep", type=Path, help="folder for the files that fail")
    parser.add_argument("folders", nargs="*", type=Path)
    choices = parser.parse_args()
    outcomes, failures, slowest, largest = run(
        choices.count, choices.seed, choices.folders, minutes=choices.minutes, keep=choices.keep, progress=True
    )
    for failure in failures[:20]:
        print(failure[-400:])
    print(f"{dict(outcomes)}; slowest {slowest:.2f} s; peak {largest:.0f} MB; {len(failures)} failures")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
