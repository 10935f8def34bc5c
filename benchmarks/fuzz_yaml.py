"""Mutated session.yaml, robot.yaml and rig.yaml: each is read, or refused in one line; nothing else may happen.

Each input is read by a warm child under a limit of memory and of processor time: a child that passes one is ended and
replaced, so that what hangs or swells is counted and found.

    python benchmarks/fuzz_yaml.py --count 50000
"""

from __future__ import annotations

import argparse
import copy
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from limited_child import MEGABYTES, Child

from ssmr_ident.core.errors import InputError
from ssmr_ident.session import bundled_robots, read_parameters, read_session

VALUES = (
    "0", "-0", "-1", "1e308", "-1e308", "5e-324", ".nan", ".inf", "-.inf", "1e999", "0x" + "f" * 4000, "9" * 5000,
    "1_0", "1:1:1:1", "0o17", "true", "no", "~", "''", '"\\0"', '"\\u202e"', "[]", "[[]]", "[1, 2]", "['1', 2]", "{}",
    "{a: 1}", "{value: {value: 1}}", "2012-02-30", "2012-05-01", "2012-05-01 10:11:12",
    "!!python/object/apply:os.system [ls]", "!!binary aGVsbG8=", "!!set {a, b}", "!!omap [a: 1]", "&a [*a]", "*a",
    "<<: {a: 1}", "x" * 5000,
    "../../etc/passwd", "/dev/zero", "/dev/stdin", "con", "…", "\U0001f600", "TODO", "|\n   text", ">-\n   text", "? a",
    "- - - -", "[" * 200, "{a: " * 200, "[" * 20_000, "%YAML 9.9", "---", "...", "\t", "\r", "\x00", "\ufeff", "\x85",
    "@",
    "`", "'", '"', "#",
)  # fmt: skip
"""What is put in a value's place."""

SESSION = """\
schema: ssmr-ident/session/1
name: s
robot: robot.yaml
baseline: rigid6
recordings:
  - {file: a.csv, experiment: free_response, motion: roll, trial: 1}
  - file: b.csv
    experiment: pull
    direction: lateral
    speed_mm_s: 1.0
    height_m: 0.05
    wheels_gripping: [1, 2]
    cable: {stiffness_N_m: 1.0e+6}
    channels: {force: F, position: s}
    per_volt: {force: 2.0}
    role: heldout
  - {file: c.csv, experiment: swivel, yaw_rate_deg_s: 30, floor: tile, reader: csv, columns: {time: 0}, skip_rows: 2}
"""
RIG = """\
schema: ssmr-ident/parameters/1
name: r
mass_kg: {value: 8.0, std: 0.1, unit: kg, source: "weighed"}
stiffness_N_m: {value: 20000, std: 2000, unit: N/m}
damping_N_s_m: {value: 50, unit: N s/m, fixed: true}
effects:
  nonlinear_stiffness: {k3_N_m3: {value: 6.0e+8, unit: N/m^3}}
  dry_friction: {F_c_N: 1.0}
"""


def seeds() -> list[tuple[str, str]]:
    """Name and text of the files to begin with."""
    robots = [Path(read_parameters(name).file).read_text(encoding="utf-8") for name in bundled_robots()]
    return [
        ("session.yaml", SESSION),
        ("session.yaml", SESSION),
        ("rig.yaml", RIG),
        *(("robot.yaml", r) for r in robots),
    ]


def mutated(text: str, random: np.random.Generator) -> bytes:
    """One to four accidents: values of another kind, keys moved, lines lost, bytes changed."""
    for _ in range(int(random.integers(1, 5))):
        lines = text.split("\n")
        at = int(random.integers(len(lines)))
        kind = int(random.integers(9))
        value = VALUES[int(random.integers(len(VALUES)))]
        if kind < 4 and ":" in lines[at]:
            lines[at] = _with_value(lines[at], value, random)
        elif kind == 4:
            del lines[at]
        elif kind == 5:
            lines.insert(int(random.integers(len(lines) + 1)), lines[at])
        elif kind == 6:
            lines[at] = " " * int(random.integers(9)) + lines[at].strip()
        elif kind == 7:
            place = int(random.integers(len(lines[at]) + 1))
            lines[at] = lines[at][:place] + value + lines[at][place:]
        else:
            letters = list(lines[at]) or [""]
            letters[int(random.integers(len(letters)))] = chr(int(random.integers(1, 0x300)))
            lines[at] = "".join(letters)
        text = "\n".join(lines)
    raw = bytearray(text.encode("utf-8", errors="surrogatepass"))
    if random.random() < 0.1 and raw:
        raw[int(random.integers(len(raw)))] ^= 1 << int(random.integers(8))
    return bytes(raw)


def _with_value(line: str, value: str, random: np.random.Generator) -> str:
    """A line with one of its values replaced."""
    places = [index for index, letter in enumerate(line) if letter == ":"]
    begin = places[int(random.integers(len(places)))] + 1
    ends = [index for index in range(begin, len(line)) if line[index] in ",}"]
    end = ends[0] if ends and random.random() < 0.8 else len(line)
    return f"{line[:begin]} {value}{line[end:]}"


def structured(text: str, random: np.random.Generator) -> bytes:
    """The same file as a tree, one node of which is another's or none of the tree's own."""
    content = copy.deepcopy(_tree(text))
    ways = list(_ways(content))
    way, other = (ways[int(index)] for index in random.integers(len(ways), size=2))
    odd = (0, -1, 2.5, 1e308, float("nan"), float("inf"), True, None, "", "x" * 4000, [], {}, [1], {"value": 1})
    value = _at(content, other) if random.random() < 0.5 else odd[int(random.integers(len(odd)))]
    if way and way[: len(other)] != other:
        _at(content, way[:-1])[way[-1]] = value
    elif way:
        _at(content, way[:-1])[way[-1]] = odd[int(random.integers(len(odd)))]
    return yaml.dump(content, Dumper=_Plain, sort_keys=False).encode()


@cache
def _tree(text: str) -> Any:
    return yaml.safe_load(text)


class _Plain(yaml.SafeDumper):
    """Without the aliases that YAML writes where a value stands twice."""

    def ignore_aliases(self, data: Any) -> bool:
        return True


def _ways(content: Any, way: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    yield way
    inner = content.items() if isinstance(content, dict) else enumerate(content) if isinstance(content, list) else ()
    for key, value in inner:
        yield from _ways(value, (*way, key))


def _at(content: Any, way: tuple[Any, ...]) -> Any:
    for key in way:
        content = content[key]
    return content


def judged(path: Path) -> str:
    """What reading a file came to: ``read``, ``refused``, or what must not be."""
    read: Callable[[Path], Any] = read_session if path.name == "session.yaml" else read_parameters
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            read(path)
    except InputError as error:
        text = str(error)
        return "refused" if "\n" not in text and len(text) < 1000 else f"many words: {text[:200]!r}"
    except Exception:
        return f"traceback: {traceback.format_exc(limit=-3)}"
    return "read"


def _warm(folder: Path) -> None:
    """The catalogue is loaded before anything is measured."""
    read_parameters(bundled_robots()[0])
    for name, text in seeds():
        (folder / name).write_text(text, encoding="utf-8")
        judged(folder / name)


def run(count: int, seed: int, progress: bool = False) -> tuple[Counter[str], list[str], float]:
    """Read ``count`` mutated files; outcomes by their first word, failures, and the longest processor time."""
    random = np.random.default_rng(seed)
    texts = seeds()
    outcomes: Counter[str] = Counter()
    failures: list[str] = []
    longest = 0.0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for log in "abc":
            (folder / f"{log}.csv").write_text("t,a\n0,0\n", encoding="utf-8")
        reader = Child(folder, _warm, judged, MEGABYTES)
        try:
            for number in range(count):
                file, text = texts[int(random.integers(len(texts)))]
                raw = (structured if random.random() < 0.4 else mutated)(text, random)
                outcome, spent, _ = reader.ask(file, raw)
                longest = max(longest, spent)
                outcomes[outcome.partition(":")[0]] += 1
                if outcome not in ("read", "refused"):
                    failures.append(f"#{number} {file}: {outcome}: {raw[:2000]!r}")
                if progress and number % 1000 == 999:
                    print(f"{number + 1}: {dict(outcomes)}, longest {longest:.2f} s", flush=True)
        finally:
            reader.end()
    return outcomes, failures, longest


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=5_000)
    parser.add_argument("--seed", type=int, default=0)
    choices = parser.parse_args()
    begun = time.monotonic()
    outcomes, failures, longest = run(choices.count, choices.seed, progress=True)
    for failure in failures[:20]:
        print(failure[-600:])
    spent = time.monotonic() - begun
    print(f"{choices.count} files, seed {choices.seed}: {dict(outcomes)}; {len(failures)} failures; "
          f"longest {longest:.2f} s of processor; {spent:.0f} s in all")  # fmt: skip
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
