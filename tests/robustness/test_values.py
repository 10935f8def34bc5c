"""Values that cannot be: one line with file, line, key, what was got and what was expected, before any work is done.

``jsonschema`` is the independent judge: what the readers refuse, the shipped schemas refuse, and the other way round.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import yaml
from driven_session import LOG, RIG, SESSION, written
from typer.testing import CliRunner

from ssmr_ident import cli
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.place import Place
from ssmr_ident.session import read_parameters
from ssmr_ident.session.json_schema import MADE, schema_file
from ssmr_ident.session.parameters_file import parameters_of
from ssmr_ident.session.session_file import FILE
from ssmr_ident.session.yaml_file import load_mapping

IN_SESSION = {
    "a sample before the first": (
        "    experiment",
        "    sample: 0\n    experiment",
        7,
        "sample: is 0, expected a whole",
    ),
    "rows from behind": ("    experiment", "    skip_rows: -1\n    experiment", 7, "skip_rows: is -1"),
    "a column in a list": ("    experiment", "    columns: {time: [0]}\n    experiment", 7, "columns.time: is [0]"),
    "wheels of two kinds": ("    experiment", "    wheels_gripping: ['1', 2]\n    experiment", 7, "[0]: is '1'"),
    "a wheel twice": ("    experiment", "    wheels_gripping: [2, 2]\n    experiment", 7, "stands twice"),
    "no end of samples": ("    experiment", "    sample_rate_hz: .inf\n    experiment", 7, "sample_rate_hz: is inf"),
    "no samples": ("    experiment", "    sample_rate_hz: 0\n    experiment", 7, "sample_rate_hz: is 0"),
    "a name of a NUL": ("file: log.csv", 'file: "lo\\0g.csv"', 6, "which no file can be called"),
    "a name of 4,000 letters": ("file: log.csv", f"file: {'x' * 4000}", 6, "which no file can be called"),
    "a number for a name": ("file: log.csv", "file: 7", 6, "file: is 7, expected a file name"),
    "a turn that is none": ("    experiment", "    yaw_rate_deg_s: .nan\n    experiment", 7, "yaw_rate_deg_s: is nan"),
    "endless height": ("    experiment", "    height_m: .inf\n    experiment", 7, "height_m: is inf"),
    "a volt of nothing": ("    experiment", "    per_volt: {force: .nan}\n    experiment", 7, "per_volt.force: is nan"),
    "a volt of nought": ("    experiment", "    per_volt: {force: 0}\n    experiment", 7, "and not 0"),
    "a list as name": ("name: s", "name: [s]", 2, "name: is ['s'], expected text"),
    "no schema": ("schema: ssmr-ident/session/1\n", "", None, "schema: is missing, expected ssmr-ident/session/1"),
    "no recordings": (SESSION[SESSION.index("recordings:") :], "recordings: []\n", 5, "recordings: is []"),
    "digits without end": (
        "    experiment",
        f"    trial: 0x{'f' * 5000}\n    experiment",
        7,
        "a number of 6021 digits",
    ),
    "digits for a word": (
        "    experiment",
        f"    decimal: 0x{'f' * 5000}\n    experiment",
        7,
        "decimal: is a number of 6021 digits",
    ),
    "digits for a key": (
        "    experiment",
        f"    ? 0x{'f' * 5000}\n    : 1\n    experiment",
        7,
        "a key must be a plain word",
    ),
    "a date as number": ("    experiment", "    speed_mm_s: 2012-05-01\n    experiment", 7, "is 2012-05-01"),
    "a channel in a list": ("force: F", "force: [F]", 8, "channels.force: is ['F']"),
}
IN_RIG = {
    "no mass": ("value: 8.0", "value: 0", 3, "mass_kg.value: is 0, expected a finite number ≥ 1e-15"),
    "a mass below nothing": ("value: 8.0", "value: -8", 3, "mass_kg.value: is -8"),
    "a mass beyond": ("value: 8.0", "value: 1e308", 3, "mass_kg.value: is 1e+308"),
    "no doubt": ("std: 0.1", "std: 0", 3, "mass_kg.std: is 0, expected more than 0. Write fixed: true"),
    "doubt below nothing": ("std: 0.1", "std: -1", 3, "mass_kg.std: is -1"),
    "doubt that is none": ("std: 0.1", "std: .nan", 3, "mass_kg.std: is nan"),
    "no spring": ("value: 20000", "value: 0", 4, "stiffness_N_m: is 0, expected more than 0. Add fixed: true"),
    "a wall": ("value: 20000", "value: .inf", 4, "stiffness_N_m.value: is inf"),
    "a push": ("value: 50", "value: -1", 5, "damping_N_s_m.value: is -1"),
    "a pull without end": ("value: 50", "value: -.inf", 5, "damping_N_s_m.value: is -inf"),
    "an effect of another name": ("nonlinear_stiffness", "nonlinear_stifness", 6, "Did you mean 'nonlinear_stiffness'"),
    "a parameter of another name": ("k3_N_m3", "k4_N_m3", 6, "is no parameter of this effect. Did you mean 'k3_N_m3'"),
    "an effect in pounds": ("unit: N/m^3", "unit: lbf/in^3", 6, "unit is 'lbf/in^3', expected 'N/m^3'"),
    "an effect in turns": ("unit: N/m^3", "unit: N m/rad^3", 6, "unit is 'N m/rad^3', expected 'N/m^3'"),
    "an effect that is none": ("6.0e+8", ".nan", 6, "k3_N_m3.value: is nan"),
    "a range from behind": (
        "effects",
        "accelerometer: {range_m_s2: -5}\neffects",
        6,
        "accelerometer.range_m_s2: is -5",
    ),
    "no band": ("effects", "accelerometer: {bandwidth_hz: 0}\neffects", 6, "accelerometer.bandwidth_hz: is 0"),
    "no schema": ("schema: ssmr-ident/parameters/1\n", "", None, "schema: is missing, expected"),
    "a list as name": ("name: r", "name: [r]", 2, "name: is ['r'], expected text"),
    "a question of a page": (
        "value: 8.0",
        f"source: {'x' * 5000}, value: TODO",
        3,
        "still says TODO: mass_kg: {source: xx",
    ),
    "quoted": ("value: 8.0", 'value: "8.0"', 3, "mass_kg.value: is '8.0', expected a finite number"),
}


@pytest.mark.parametrize(
    ("file", "old", "new", "line", "told"),
    [pytest.param("session.yaml", *case, id=f"session: {name}") for name, case in IN_SESSION.items()]
    + [pytest.param("rig.yaml", *case, id=f"rig: {name}") for name, case in IN_RIG.items()],
)
def test_one_line_before_any_work(tmp_path: Path, file: str, old: str, new: str, line: int | None, told: str) -> None:
    text = {"session.yaml": SESSION, "rig.yaml": RIG}[file]
    assert old in text
    changed = text.replace(old, new, 1)
    folder = written(tmp_path, **{file.removesuffix(".yaml"): changed})
    for verb in ("fit", "compare"):
        done = CliRunner().invoke(cli.app, [verb, str(folder)])
        assert isinstance(done.exception, InputError), done.exception
        message = str(done.exception)
        assert message.startswith(str(folder / file) + (f":{line}: " if line else ": ")), message
        assert told in message
        assert "\n" not in message
        assert len(message) < 400 + len(str(folder))
    assert sorted(path.name for path in folder.iterdir()) == ["log.csv", "rig.yaml", "session.yaml"]


OPTIONS = {
    "--duration-s nan": "--duration-s: is nan",
    "--duration-s inf": "--duration-s: is inf",
    "--rate-hz -1": "--rate-hz: is -1.0",
    "--amplitude-mm inf": "--amplitude-mm: is inf",
    "--duration-s 1e5 --rate-hz 1e5": "ask for 1e+10 samples",
    "-e pull --speed-mm-s 0": "--speed-mm-s: is 0.0",
    "-e pull --height-m nan": "--height-m: is nan",
    "-e pull --wheels-gripping 1,5": "--wheels-gripping[1]: is '5'",
    "-e swivel --yaw-rate-deg-s inf": "--yaw-rate-deg-s: is inf",
    "--effect dry_friction:F_c_N=nan": "dry_friction.F_c_N",
}


@pytest.mark.parametrize("options", OPTIONS)
def test_options_are_asked_by_the_same_declaration(tmp_path: Path, options: str) -> None:
    words = ["simulate", "p3at-extended", "-e", "free_response", *options.split(), "-o", str(tmp_path / "r.csv")]
    done = CliRunner().invoke(cli.app, words)
    assert isinstance(done.exception, InputError), done.exception
    assert OPTIONS[options] in str(done.exception)
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
@pytest.mark.parametrize("name", MADE)
def test_shipped_schemas_are_the_declaration(name: str) -> None:
    shipped = json.loads(schema_file(name).read_text(encoding="utf-8"))
    assert shipped == json.loads(json.dumps(MADE[name]())), "python -m ssmr_ident.session.json_schema"
    jsonschema.Draft202012Validator.check_schema(shipped)


AWKWARD = (
    0,
    -1,
    1,
    1.0,
    2.5,
    1e308,
    -1e308,
    1e-300,
    True,
    False,
    "",
    "x",
    "roll",
    "1",
    [],
    [1],
    [1, 1],
    {},
    {"a": 1},
    None,
)
"""Values tried at every place. NaN and infinity are not JSON's, and what a schema makes of them is nobody's word."""


def _ways(content: Any, way: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    inner = content.items() if isinstance(content, dict) else enumerate(content) if isinstance(content, list) else ()
    return [way, *(deeper for key, value in inner for deeper in _ways(value, (*way, key)))]


def _with(content: Any, way: tuple[Any, ...], value: Any) -> Any:
    if not way:
        return value
    changed = dict(content) if isinstance(content, dict) else list(content)
    changed[way[0]] = _with(content[way[0]], way[1:], value)
    return changed


FULL_ENTRY = {
    "file": "log.csv", "experiment": "pull", "role": "target", "reader": "csv", "trial": 1, "motion": "roll",
    "yaw_rate_deg_s": 30, "wheel_speed_m_s": 0.1, "floor": "tile", "frame": "none", "direction": "lateral",
    "speed_mm_s": 1.0, "height_m": 0.05, "wheels_gripping": [1, 2], "wheel_rate_rad_s": 0.5,
    "cable": {"stiffness_N_m": 1e6, "damping_N_s_m": 3.0}, "free_normal": True, "channels": {"force": "F"},
    "per_volt": {"force": 2.0}, "columns": {"time": 0, "force": "F"}, "units": {"F": "N"}, "sheets": {"x": 1},
    "sample_rate_hz": 100, "sample": 1, "skip_rows": 0, "time_unit": "ms", "decimal": ".", "on_bad": "nan",
    "trim": True, "load_scale": 10.0,
}  # fmt: skip


def _refused(read: Any, content: Any) -> str:
    try:
        read(content)
    except InputError as error:
        return str(error)
    return ""


@pytest.mark.slow
@pytest.mark.parametrize("name", MADE)
def test_schemas_and_readers_agree(name: str) -> None:
    """Every awkward value at every place of a full file, and a key nobody knows in every mapping."""
    place = Place(name)
    if name == "session":
        content = yaml.safe_load(SESSION) | {"recordings": [FULL_ENTRY]}
        read = partial(FILE.check, place)
    else:
        bundled = load_mapping(Path(read_parameters("p3at-extended").file))
        rig = yaml.safe_load(RIG)
        kept = ("schema", "name", "inertia_kg_m2", "accelerometer", "noise")
        content = {key: bundled[key] for key in kept} | {key: rig[key] for key in ("stiffness_N_m", "effects")}
        content["contact_points_m"] = bundled["contact_points_m"]["value"]
        read = partial(parameters_of, place)
    judge = jsonschema.Draft202012Validator(MADE[name]())
    assert _refused(read, content) == ""
    assert judge.is_valid(content)
    tried = 0
    for way in _ways(content):
        inside = content
        for key in way:
            inside = inside[key]
        values = AWKWARD if way else ()  # a file that holds no mapping is refused as it is loaded
        for value in (*values, {**inside, "nobody_knows": 1}) if isinstance(inside, dict) else values:
            changed = _with(content, way, value)
            message = _refused(read, changed)
            if " unit is " not in message:  # which has many spellings
                assert judge.is_valid(changed) == (not message), (way, value, message)
                tried += 1
    assert tried > 500


@pytest.mark.parametrize("value", ["1e308", "-1e150"])
def test_a_sample_that_no_sensor_gives(tmp_path: Path, value: str) -> None:
    (tmp_path / "log.csv").write_text(LOG.replace("\n0.1,", f"\n0.1,{value},0\n#").replace("#", "0.10005,"))
    done = CliRunner().invoke(cli.app, ["inspect", str(tmp_path / "log.csv")])
    told = " ".join(str(done.exception).split()) + done.output
    assert f"F is {float(value):g} N at 0.1 s, beyond anything that is measured" in told


@pytest.mark.parametrize("values", [lambda i: 5.0, lambda i: 1e-200 * (i % 3)])
def test_a_channel_that_does_not_change(tmp_path: Path, values: Callable[[int], float]) -> None:
    folder = written(tmp_path)
    rows = "".join(f"{i / 1000},{(i % 7) - 3.0},{values(i)}\n" for i in range(300))
    (folder / "log.csv").write_text("time [s],F [N],a [m/s^2]\n" + rows)
    for verb in ("fit", "compare"):
        done = CliRunner().invoke(cli.app, [verb, str(folder)])
        assert isinstance(done.exception, InputError), done.exception
        told = f"{folder / 'log.csv'}: acceleration does not change from beginning to end. Look whether the sensor"
        assert str(done.exception).startswith(told)
