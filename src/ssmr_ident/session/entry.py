"""What session.yaml may say of a recording: each key with its values and its meaning, declared once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Annotated, Any

from ssmr_ident.core.domain import Choice, FileName, Number, Pointer, Text, Whole, YesNo
from ssmr_ident.core.nested_domain import Either, Keyed, Listed, Mapped, declared
from ssmr_ident.core.place import Place, shown
from ssmr_ident.readers.options import DECIMAL, LOAD_SCALE, ON_BAD, RATE, SAMPLE, SKIP, STAMPS

BASELINES = ("rigid6", "decoupled", "sdof", "network", "drag")
BANDED = ("sdof", "network")
"""Baselines whose recordings may have a band."""
EXPERIMENTS = (
    *("free_response", "swivel", "straight", "pull", "wheel_drag", "vertical_compression", "forced", "base_motion"),
)
ROLES = ("target", "calibration", "heldout")
CABLES = ("steel", "rope")
MOTIONS = ("acceleration", "velocity", "position", "angle", "angular_rate")
FURTHER = tuple(f"{name}_{number}" for name in MOTIONS for number in range(2, 10))
"""The same of further sensors."""
QUANTITIES = (
    *("force", "torque", "voltage", "enabled", *MOTIONS, *FURTHER, "position_reference"),
    *("base_acceleration", "base_position", "ax", "ay", "az", "wx", "wy", "wz", "time"),
)


@dataclass(frozen=True)
class PassBand(Listed):
    """Two frequencies, the lower one first."""

    def check(self, place: Place, value: Any) -> tuple[Any, ...]:
        low, high = super().check(place, value)
        if not low < high:
            raise place.error(f"is {shown(value)}, a band without width", "Write [lower, upper]")
        return low, high


BAND = PassBand(Number("Hz", least=0.0, most=1e9), 2, 2)

CABLE = Keyed(
    {
        "stiffness_N_m": (Number("N/m", least=1e-12, infinite=True), ""),
        "damping_N_s_m": (Number("N s/m", above=0.0, most=1e12), ""),
    }
)
CONTROLLER = Keyed(
    {
        "kp_V_rad": (Number("V/rad", above=0.0, most=1e9), "voltage per radian between goal and angle"),
        "limit_V": (Number("V", above=0.0, infinite=True), "most that it gives, either way; left out: no limit"),
    },
    ("kp_V_rad",),
)
SPEED = Number("mm/s", least=1e-9, most=1e7)
HEIGHT = Number("m", least=-1e3, most=1e3)
TURN = Number("deg/s", least=-1e6, most=1e6)
WHEELS = Listed(Choice((1, 2, 3, 4)), distinct=True)
SECONDS = Number("s", least=-1e9, most=1e9)
CHANNEL = Either(
    Text(),
    Keyed(
        {
            "column": (Text(), "its header"),
            "body": (Text(), "of a network: on which it is measured, or acts"),
            "delay_s": (SECONDS, "it comes late"),
        },
        ("column",),
    ),
)


@dataclass(frozen=True, kw_only=True)
class Reading:
    """What a log does not say of itself, for its reader."""

    # a lab may bring a reader of its own, which only the readers' door knows
    reader: Annotated[str | None, Text(longest=80), "left out, the content decides"] = None
    columns: Annotated[
        Mapping[str, int | str], Mapped(Text(), Pointer()), "quantity: column by its number from 0, or its header"
    ] = field(default_factory=dict)
    units: Annotated[Mapping[str, str], Mapped(Text(), Text()), "header: unit"] = field(default_factory=dict)
    sheets: Annotated[
        Mapping[str, int | str], Mapped(Text(), Pointer(1)), "axis: worksheet by its number from 1, or its name"
    ] = field(default_factory=dict)
    sample_rate_hz: Annotated[float | None, RATE, "where the log has no time"] = None
    sample: Annotated[int | None, SAMPLE, "which part of a log that holds several, from 1"] = None
    skip_rows: Annotated[int | None, SKIP, "rows before the numbers"] = None
    time_unit: Annotated[str | None, Text(), "of the time column"] = None
    decimal: Annotated[str | None, DECIMAL, "decimal sign"] = None
    on_bad: Annotated[str, ON_BAD, "what becomes of a cell that is no number"] = "error"
    stamps: Annotated[str, STAMPS, "stamps in bursts made even by regression, or kept"] = "auto"
    trim: Annotated[bool, YesNo(), "whether rows before the first whole one are cut"] = False
    load_scale: Annotated[float | None, LOAD_SCALE, "newtons per unit of a machine's load"] = None


@dataclass(frozen=True)
class LogEntry(Reading):
    """One of the logs of a recording that several machines made."""

    file: Annotated[str, FileName(), "log, relative to this file's folder"]
    delay_s: Annotated[float | None, SECONDS, "by how much its clock reads more; left out, it is found"] = None

    def over(self, entry: Reading) -> Reading:
        """How it is read: as it says itself, and else as its recording's entry says."""
        own = {f.name: getattr(self, f.name) for f in fields(Reading) if getattr(self, f.name) != f.default}
        return replace(Reading(**{f.name: getattr(entry, f.name) for f in fields(Reading)}), **own)


LOG = Either(FileName(), Keyed(declared(LogEntry), ("file",)))


@dataclass(frozen=True)
class Entry(Reading):
    """One recording of a session, as session.yaml describes it (units are in the names).

    Where several machines logged it, ``file`` is what it is called: the names of ``files`` together.
    """

    file: Annotated[str, FileName(), "log, relative to this file's folder"]
    experiment: Annotated[str, Choice(EXPERIMENTS), "how it was made"]
    role: Annotated[str, Choice(ROLES), "calibration: made without the puzzling condition; heldout: never fitted"] = (
        "target"
    )
    trial: Annotated[int | None, Whole(least=-(2**31)), "number of the repetition"] = None
    motion: Annotated[str | None, Choice(("roll", "pitch", "yaw")), "of a robot's free response"] = None
    yaw_rate_deg_s: Annotated[float | None, TURN, "wanted yaw rate of a swivel"] = None
    wheel_speed_m_s: Annotated[float | None, Number("m/s", least=-1e4, most=1e4), "(right - left)/2 of a swivel"] = None
    wheel_log: Annotated[str | None, FileName(), "log of the wheels: time, v_left, v_right"] = None
    floor: Annotated[str | None, Text(), "label"] = None
    frame: Annotated[str | None, Text(), "label"] = None
    direction: Annotated[str | None, Choice(("lateral", "longitudinal")), "of a pull"] = None
    speed_mm_s: Annotated[float | None, SPEED, "of the machine's head"] = None
    height_m: Annotated[float | None, HEIGHT, "of the cable above the floor"] = None
    wheels_gripping: Annotated[tuple[int, ...], WHEELS, "the others stand on oiled plates"] = (1, 2, 3, 4)
    wheel_rate_rad_s: Annotated[float | None, Number("rad/s", least=-1e6, most=1e6), "of wheels spun in a pull"] = None
    cable: Annotated[str | Mapping[str, float] | None, Either(Choice(CABLES), CABLE), "of a pull"] = None
    free_normal: Annotated[bool, YesNo(), "whether a dragged wheel can move off the surface"] = True
    channels: Annotated[Mapping[str, str], Mapped(Choice(QUANTITIES), CHANNEL), "quantity: header without unit"] = (
        field(default_factory=dict)
    )
    per_volt: Annotated[
        Mapping[str, float],
        Mapped(Choice(QUANTITIES), Number(least=-1e15, most=1e15, nonzero=True)),
        "quantity: SI units per volt",
    ] = field(default_factory=dict)
    files: Annotated[
        Mapping[str, LogEntry], Mapped(Choice(QUANTITIES), LOG), "in place of file: quantity: its log, one event in all"
    ] = field(default_factory=dict)
    release_s: Annotated[
        tuple[float, ...], Either(SECONDS, Listed(SECONDS, 1, 1000, distinct=True)), "when it was let go, or struck"
    ] = ()
    delay_s: Annotated[
        Mapping[str, float], Mapped(Choice(QUANTITIES), SECONDS), "quantity: by how much its channel comes late"
    ] = field(default_factory=dict)
    band_hz: Annotated[
        tuple[float, float] | None, BAND, "[lower, upper]: in which alone a rig or network is fitted and judged"
    ] = None
    controller: Annotated[
        Mapping[str, float] | None, CONTROLLER, "of a drive: position_reference is its goal, and it stands in the loop"
    ] = None
    bodies: Mapping[str, str] = field(default_factory=dict)
    """Quantity: body of a network, as ``channels`` says."""

    @property
    def logs(self) -> tuple[str, ...]:
        """Names of its files."""
        return tuple(dict.fromkeys(log.file for log in self.files.values())) or (self.file,)


def entry_of(values: Mapping[str, Any]) -> Entry:
    """An entry from checked values: a log alone is its name, a release alone a list of one."""
    made = dict(values)
    files = {
        quantity: LogEntry(**log) if isinstance(log, Mapping) else LogEntry(log)
        for quantity, log in made.get("files", {}).items()
    }
    if files:
        made |= {"files": files, "file": " + ".join(dict.fromkeys(log.file for log in files.values()))}
    if isinstance(made.get("release_s"), float):
        made["release_s"] = (made["release_s"],)
    columns = {quantity: c for quantity, c in made.get("channels", {}).items() if isinstance(c, Mapping)}
    late = {quantity: c["delay_s"] for quantity, c in columns.items() if "delay_s" in c}
    made["bodies"] = {quantity: c["body"] for quantity, c in columns.items() if "body" in c}
    made["channels"] = dict(made.get("channels", {})) | {quantity: c["column"] for quantity, c in columns.items()}
    made["delay_s"] = dict(made.get("delay_s", {})) | late
    return Entry(**made)
