"""session.yaml: which logs, made how, with which role."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

from ssmr_ident.core.errors import InputError, did_you_mean
from ssmr_ident.core.shown import Shown
from ssmr_ident.session.parameters_file import bundled_robots
from ssmr_ident.session.yaml_file import load_mapping

SCHEMA = "ssmr-ident/session/1"
BASELINES = ("rigid6", "decoupled", "sdof", "drag")
EXPERIMENTS = ("free_response", "swivel", "straight", "pull", "wheel_drag", "vertical_compression", "forced")
ROLES = ("target", "calibration", "heldout")
READERS = ("labview-xlsx", "lvm", "tdms", "mtestquattro", "csv")
CABLES = ("steel", "rope")
QUANTITIES = (
    *("force", "torque", "acceleration", "acceleration_2", "velocity", "position", "position_reference"),
    *("angle", "angular_rate", "ax", "ay", "az", "wx", "wy", "wz", "time"),
)


@dataclass(frozen=True)
class Entry:
    """One recording of a session, as session.yaml describes it (units are in the names)."""

    file: str
    experiment: str
    role: str = "target"
    reader: str | None = None
    trial: int | None = None
    motion: str | None = None
    yaw_rate_deg_s: float | None = None
    wheel_speed_m_s: float | None = None
    wheel_log: str | None = None
    floor: str | None = None
    frame: str | None = None
    direction: str | None = None
    speed_mm_s: float | None = None
    height_m: float | None = None
    wheels_gripping: tuple[int, ...] = (1, 2, 3, 4)
    wheel_rate_rad_s: float | None = None
    cable: str | Mapping[str, float] | None = None
    free_normal: bool = True
    channels: Mapping[str, str] = field(default_factory=dict)
    per_volt: Mapping[str, float] = field(default_factory=dict)
    columns: Mapping[str, int | str] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    sheets: Mapping[str, int | str] = field(default_factory=dict)
    sample_rate_hz: float | None = None
    sample: int | None = None
    skip_rows: int | None = None
    time_unit: str | None = None
    decimal: str | None = None
    on_bad: str = "error"
    trim: bool = False
    load_scale: float | None = None


@dataclass(frozen=True)
class Session(Shown):
    """A session folder: its name, robot, baseline and recordings.

    ``robot`` is the path of the parameter file, or the name of a bundled robot.
    """

    name: str
    folder: Path
    robot: str
    baseline: str
    entries: tuple[Entry, ...]

    def path(self, entry: Entry) -> Path:
        return self.folder / entry.file

    def __str__(self) -> str:
        lines = [
            f"session {self.name}: {len(self.entries)} recordings, baseline {self.baseline}",
            f"  robot {self.robot}",
        ]
        lines += [f"  {e.file:<36} {e.experiment:<20} {e.role}" for e in self.entries]
        return "\n".join(lines)


def read_session(path: str | Path) -> Session:
    """Read a session folder, or its session.yaml by path.

    Raises
    ------
    InputError
        Names file and key: a missing or misspelt key, a value outside its list, a path that leaves the
        folder, a log that is not there.
    """
    path = Path(path)
    if not path.exists():
        raise InputError(str(path), "no such session", "Give a folder with a session.yaml, or the path of one")
    file = path / "session.yaml" if path.is_dir() else path
    if path.is_dir() and not file.is_file():
        raise InputError(
            str(path), "has no session.yaml", f"Let one be written: ident new {path}; or name another folder"
        )
    content = load_mapping(file)
    _no_unknown(str(file), content, {"schema", "name", "robot", "baseline", "recordings"})
    if content.get("schema") != SCHEMA:
        raise InputError(f"{file}: schema", f"is {content.get('schema')!r}, expected {SCHEMA!r}")
    rows = content.get("recordings")
    if not isinstance(rows, list) or not rows:
        raise InputError(f"{file}: recordings", "missing or empty", "List at least one log with file and experiment")
    baseline = _one_of(f"{file}: baseline", content.get("baseline", "rigid6"), BASELINES)
    entries = tuple(_entry(file, index, row) for index, row in enumerate(rows))
    _no_repeats(file, entries)
    return Session(str(content.get("name", file.parent.name)), file.parent, _robot(file, content), baseline, entries)


def _robot(file: Path, content: dict[str, Any]) -> str:
    robot = content.get("robot")
    if not isinstance(robot, str):
        raise InputError(f"{file}: robot", "missing", f"Give a parameter file, or one of {', '.join(bundled_robots())}")
    return robot if robot in bundled_robots() else str(_inside(f"{file}: robot", file.parent, robot))


def _entry(file: Path, index: int, row: Any) -> Entry:
    where = f"{file}: recordings[{index}]"
    if not isinstance(row, Mapping):
        raise InputError(where, f"is {row!r}, expected a mapping with file and experiment")
    _no_unknown(where, row, {f.name for f in fields(Entry)})
    for key in ("file", "experiment"):
        if not isinstance(row.get(key), str):
            raise InputError(f"{where}.{key}", "missing", "Every recording needs file and experiment")
    values: dict[str, Any] = {}
    for key, value in row.items():
        if value is not None:
            values[key] = _CHECKS[key](f"{where}.{key}", value) if key in _CHECKS else value
    for key in ("file", "wheel_log"):
        if key in values:
            target = _inside(f"{where}.{key}", file.parent, values[key])
            if not target.is_file():
                raise InputError(f"{where}.{key}", f"{values[key]} is not in {file.parent}", "Check the name")
    return Entry(**values)


def _no_repeats(file: Path, entries: tuple[Entry, ...]) -> None:
    seen: set[tuple[str, int | None]] = set()
    for index, entry in enumerate(entries):
        if (entry.file, entry.sample) in seen:
            raise InputError(f"{file}: recordings[{index}].file", f"{entry.file} is listed twice", "Remove one of them")
        seen.add((entry.file, entry.sample))


def _no_unknown(where: str, mapping: Mapping[str, Any], known: set[str]) -> None:
    for key in mapping:
        if key not in known:
            raise InputError(f"{where}: {key}", "is not a known key", did_you_mean(str(key), known))


def _inside(where: str, folder: Path, name: Any) -> Path:
    """A path within the session folder; what leaves it is refused."""
    if not isinstance(name, str):
        raise InputError(where, f"is {name!r}, expected a file name")
    target = folder / name
    if not target.resolve().is_relative_to(folder.resolve()):
        raise InputError(where, f"{name} leaves the session folder", "Copy the file into the folder")
    return target


def _one_of(where: str, value: Any, known: tuple[str, ...]) -> str:
    if value not in known:
        raise InputError(where, f"is {value!r}", did_you_mean(str(value), known))
    return str(value)


def _choice(*known: str) -> Callable[[str, Any], str]:
    return lambda where, value: _one_of(where, value, known)


def _number(where: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(where, f"is {value!r}, expected a number")
    return float(value)


def _positive(where: str, value: Any) -> float:
    number = _number(where, value)
    if not number > 0:
        raise InputError(where, f"is {number:g}, expected more than 0")
    return number


def _integer(where: str, value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise InputError(where, f"is {value!r}, expected a whole number")
    return value


def _yes_no(where: str, value: Any) -> bool:
    if not isinstance(value, bool):
        raise InputError(where, f"is {value!r}, expected true or false")
    return value


def _wheels(where: str, value: Any) -> tuple[int, ...]:
    if not isinstance(value, list) or not set(map(str, value)) <= {"1", "2", "3", "4"} or len(set(value)) != len(value):
        raise InputError(where, f"is {value!r}, expected a list of different wheels out of 1, 2, 3, 4")
    return tuple(sorted(value))


def _cable(where: str, value: Any) -> str | dict[str, float]:
    if isinstance(value, Mapping):
        _no_unknown(where, value, {"stiffness_N_m", "damping_N_s_m"})
        return {str(key): _positive(f"{where}.{key}", inner) for key, inner in value.items()}
    return _one_of(where, value, CABLES)


def _channels(where: str, value: Any) -> dict[str, str]:
    if not isinstance(value, Mapping):
        raise InputError(where, f"is {value!r}, expected quantity: header")
    for key in value:
        _one_of(f"{where}: {key}", key, QUANTITIES)
    return {str(key): str(header) for key, header in value.items()}


def _mapping_of(check: Callable[[str, Any], Any]) -> Callable[[str, Any], dict[str, Any]]:
    def checked(where: str, value: Any) -> dict[str, Any]:
        if not isinstance(value, Mapping):
            raise InputError(where, f"is {value!r}, expected a mapping")
        return {str(key): check(f"{where}.{key}", inner) for key, inner in value.items()}

    return checked


_CHECKS: dict[str, Callable[[str, Any], Any]] = {
    "experiment": _choice(*EXPERIMENTS),
    "role": _choice(*ROLES),
    "reader": _choice(*READERS),
    "motion": _choice("roll", "pitch", "yaw"),
    "direction": _choice("lateral", "longitudinal"),
    "trial": _integer,
    "sample": _integer,
    "yaw_rate_deg_s": _number,
    "wheel_speed_m_s": _number,
    "wheel_rate_rad_s": _number,
    "speed_mm_s": _positive,
    "height_m": _number,
    "sample_rate_hz": _positive,
    "wheels_gripping": _wheels,
    "cable": _cable,
    "free_normal": _yes_no,
    "channels": _channels,
    "per_volt": _mapping_of(_number),
    "units": _mapping_of(lambda where, value: str(value)),
    "columns": _mapping_of(lambda where, value: value),
    "sheets": _mapping_of(lambda where, value: value),
    "skip_rows": _integer,
    "time_unit": lambda where, value: str(value),
    "decimal": _choice(".", ","),
    "on_bad": _choice("error", "nan"),
    "trim": _yes_no,
    "load_scale": _positive,
    "floor": lambda where, value: str(value),
    "frame": lambda where, value: str(value),
}
