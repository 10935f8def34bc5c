"""Put the choices that a log needs into its entry of session.yaml, and leave every other line as it is."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import yaml

from ssmr_ident.core.atomic import write_bytes
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.whole_file import read_whole
from ssmr_ident.readers.options import ReadOptions, numbered

MOST_BYTES = 4_000_000


def save_choices(session: Path, log: Path, options: ReadOptions) -> None:
    """Write what ``options`` say into the entry of ``log``.

    Parameters
    ----------
    session : Path
        An existing session.yaml.
    log : Path
        Its entry is the one whose ``file`` leads there.

    Raises
    ------
    InputError
        No such session, no entry for the log, or an entry that is not written line by line.
    """
    choices: dict[str, Any] = {
        "reader": options.reader,
        "columns": {k: _by_number(v) for k, v in options.columns.items()} or None,
        "units": dict(options.units) or None,
        "sheets": {k: _by_number(v) for k, v in options.sheets.items()} or None,
        "sample_rate_hz": options.fs,
        "sample": options.sample,
        "skip_rows": None if options.skip == "auto" else int(options.skip),
        "time_unit": options.time_unit,
        "decimal": options.decimal,
        "stamps": None if options.stamps == "auto" else options.stamps,
        "on_bad": None if options.on_bad == "error" else options.on_bad,
        "trim": options.trim or None,
        "load_scale": options.load_scale,
    }
    choices = {key: value for key, value in choices.items() if value is not None}
    session = session / "session.yaml" if session.is_dir() else session
    try:
        text = read_whole(session, MOST_BYTES, "Name a session.yaml.").decode()
        root = yaml.compose(text, Loader=yaml.SafeLoader)
    except OSError as error:
        raise InputError(str(session), f"cannot be read ({error.strerror})", "Write the session first.") from error
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise InputError(str(session), "is not valid YAML", "Mend it first.") from error
    entry = _entry(session, log, root)
    lines = text.splitlines()
    spans = {
        key.value: (key.start_mark.line, _last_line(lines, value))
        for key, value in entry.value
        if isinstance(key, yaml.ScalarNode)
    }
    column = entry.value[0][0].start_mark.column
    edits = []
    for key, value in choices.items():
        # JSON is YAML as well, and quotes what needs quoting
        new = f"{key}: {json.dumps(value, ensure_ascii=False)}"
        first, last = spans.get(key, (spans["file"][1] + 1, spans["file"][1]))
        dash = first == entry.start_mark.line  # the entry's first key stands behind its dash
        edits.append((first, last, (lines[first][:column] if dash else " " * column) + new))
    for first, last, new in sorted(edits, key=lambda edit: -edit[0]):
        lines[first : last + 1] = [new]
    result = "\n".join(lines) + "\n"
    _check(session, log, result, choices)
    write_bytes(session, result.encode())


def _by_number(which: int | str) -> int | str:
    number = numbered(which)
    return which if number is None else number


def _entry(session: Path, log: Path, root: Any) -> yaml.MappingNode:
    if not isinstance(root, yaml.MappingNode):
        raise InputError(str(session), "is no session", "Name a session.yaml.")
    recordings = next((v for k, v in root.value if k.value == "recordings"), None)
    for node in recordings.value if isinstance(recordings, yaml.SequenceNode) else ():
        if not isinstance(node, yaml.MappingNode):
            continue
        for key, value in node.value:
            if key.value == "file" and (session.parent / str(value.value)).resolve() == log.resolve():
                if node.flow_style:
                    where = f"{session}:{node.start_mark.line + 1}"
                    raise InputError(where, "the entry stands in braces", "Write it line by line first.")
                return node
    raise InputError(str(session), f"has no recording with file: {log.name}", "Add the entry first, then save.")


def _last_line(lines: list[str], value: yaml.Node) -> int:
    """Last line of a value; the end mark of a block stands behind the blanks and comments that follow it."""
    end = int(value.end_mark.line)
    if isinstance(value, yaml.ScalarNode) or getattr(value, "flow_style", False):
        return end
    last = min(end - (1 if value.end_mark.column <= value.start_mark.column else 0), len(lines) - 1)
    while last > value.start_mark.line and lines[last].lstrip()[:1] in ("", "#"):
        last -= 1
    return last


def _check(session: Path, log: Path, result: str, choices: dict[str, Any]) -> None:
    """The text must say what was meant before it replaces the old one."""
    try:
        content = yaml.safe_load(result)
        entries = [e for e in content["recordings"] if (session.parent / e["file"]).resolve() == log.resolve()]
        good = len(entries) >= 1 and all(entries[0].get(key) == value for key, value in choices.items())
    except (yaml.YAMLError, KeyError, TypeError, ValueError, RecursionError):
        good = False
    if not good:
        raise InputError(
            str(session),
            "the entry could not be changed safely",
            f"Add by hand: {choices}",
        )
