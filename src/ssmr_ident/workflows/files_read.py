"""Which files an answer rests on: the session, what it says of the robot, its logs, and the parameters given."""

from __future__ import annotations

from pathlib import Path

from ssmr_ident.session import Session, read_session


def files_read(session: str | Path | Session, params: str = "") -> list[Path]:
    """Every file that was read.

    Parameters
    ----------
    session : path or Session
        Folder, or session.yaml by path; or what was read from it as its folder's session.yaml.
    params : str
        Parameter file, or a bundled robot, which is no file of the user's.
    """
    read = session if isinstance(session, Session) else read_session(session)
    file = read.folder / "session.yaml" if isinstance(session, Session) or Path(session).is_dir() else Path(session)
    robots = [Path(read.robot), *([Path(params)] if params else [])]
    logs = [path for entry in read.entries for path in read.paths(entry)]
    logs += [read.folder / entry.wheel_log for entry in read.entries if entry.wheel_log]
    return [file, *(robot for robot in robots if robot.is_file()), *logs]
