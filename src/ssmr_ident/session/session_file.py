"""session.yaml: which logs, made how, with which role."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from ssmr_ident.core.domain import Choice, Domain, FileName, Text
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.nested_domain import Keyed, Listed, declared
from ssmr_ident.core.place import Place, short
from ssmr_ident.core.shown import Shown
from ssmr_ident.session.entry import BAND, BANDED, BASELINES, Entry, entry_of
from ssmr_ident.session.parameters_file import bundled_robots
from ssmr_ident.session.yaml_file import expect_schema, load_with_lines

SCHEMA = "ssmr-ident/session/1"
KEYS: dict[str, tuple[Domain, str]] = {
    "schema": (Choice((SCHEMA,)), "what kind of file this is"),
    "name": (Text(one_line=False), "of the session"),
    "robot": (FileName(), "parameter file, or the name of a bundled robot"),
    "baseline": (
        Choice(BASELINES),
        "rigid6: the robot; decoupled: pure rotations; sdof: a rig; network: bodies on springs; drag: a pulled block",
    ),
    "band_hz": (BAND, "of every recording that has none of its own"),
    "recordings": (
        Listed(Keyed(declared(Entry), ("experiment",), ("file", "files")), 1),
        "the logs, each with how it was made",
    ),
}
"""The keys of session.yaml."""

FILE = Keyed(KEYS, ("schema", "robot", "recordings"))


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

    def paths(self, entry: Entry) -> tuple[Path, ...]:
        """The logs of an entry."""
        return tuple(self.folder / name for name in entry.logs)

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
        Names file, line and key: a missing or misspelt key, a value that cannot be, a path that leaves the
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
    place, content = load_with_lines(file)
    expect_schema(place, content, SCHEMA)
    values = FILE.check(place, content)
    rows = values["recordings"]
    entries = tuple(entry_of({"band_hz": values.get("band_hz")} | row) for row in rows)
    baseline = values.get("baseline", "rigid6")
    for here, given in ((place, values), *((place.at("recordings", k), row) for k, row in enumerate(rows))):
        if "band_hz" in given and baseline not in BANDED:
            mend = f"Leave it out: it is for baseline {' and '.join(BANDED)}"
            raise here.at("band_hz").error(f"is not for baseline {baseline}", mend)
    seen: set[tuple[str, int | None]] = set()
    for index, (row, entry) in enumerate(zip(rows, entries, strict=True)):
        here = place.at("recordings", index)
        named: list[tuple[tuple[str, ...], str]] = [(("file",), row["file"])] if "file" in row else []
        named += [(("files", quantity), log.file) for quantity, log in entry.files.items()]
        named += [(("wheel_log",), row["wheel_log"])] if "wheel_log" in row else []
        for keys, name in named:
            if not _inside(here.at(*keys), file.parent, name).is_file():
                raise here.at(*keys).error(f"{short(name)} is not in {file.parent}", "Check the name")
        log = (entry.file, entry.sample)
        if log in seen:
            raise here.at("file").error(f"{short(entry.file)} is listed twice", "Remove one of them")
        seen.add(log)
    robot = values["robot"]
    if robot not in bundled_robots():
        robot = str(_inside(place.at("robot"), file.parent, robot))
    name = values.get("name", file.parent.name)
    return Session(name, file.parent, robot, baseline, entries)


def _inside(place: Place, folder: Path, name: str) -> Path:
    """A path within the session folder; what leaves it is refused."""
    target = folder / name
    try:
        inside = target.resolve().is_relative_to(folder.resolve())
    except (OSError, RuntimeError) as error:  # links in a circle, a name longer than the system's
        raise place.error(f"{short(name)} cannot be followed ({type(error).__name__})", "Check the name") from error
    if not inside:
        raise place.error(f"{short(name)} leaves the session folder", "Copy the file into the folder")
    return target
