"""``ident compare FIRST SECOND``: two parameter files, or two diagnoses, before and after a repair for instance."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import Any

import numpy as np

from ssmr_ident.compare.change import Changes, Side, changes
from ssmr_ident.core.atomic import make_folder, write_text
from ssmr_ident.core.errors import InputError
from ssmr_ident.report.changes_page import changes_page
from ssmr_ident.report.html import file_hashes, write_page
from ssmr_ident.session import read_parameters
from ssmr_ident.session.yaml_file import load_with_lines


def compare_two(
    first: Path,
    second: Path,
    output: Path | None = None,
    command: str = "ssmr_ident.workflows.compare_two, from Python",
) -> Changes:
    """What has changed from one to the other.

    Parameters
    ----------
    first, second : Path
        A parameter file, or the folder that ``ident diagnose -o`` has written.
    output : Path or None
        Folder for ``report.html`` and ``changes.csv``.
    command : str
        The call, for the end of the page.

    Raises
    ------
    InputError
        Neither a parameter file nor a diagnosis; units that differ; nothing in common.
    """
    sides = [_side(Path(path)) for path in (first, second)]
    found = changes(sides[0][0], sides[1][0])
    if output is not None:
        make_folder(output)
        _write_table(found, output / "changes.csv")
        files = file_hashes([file for _, read in sides for file in read])
        write_page(output / "report.html", changes_page(found, command, files))
    return found


def _side(path: Path) -> tuple[Side, list[Path]]:
    """What is compared, and the files that it was read from."""
    if not path.is_dir():
        return Side(str(path), read_parameters(path)), [path]
    answer, after = path / "diagnosis.yaml", path / "after.yaml"
    for file in (answer, after):
        if not file.is_file():
            mend = "Name a parameter file, or a folder that ident diagnose -o has written"
            raise InputError(str(path), f"holds no {file.name}", mend)
    place, told = load_with_lines(answer)
    try:
        quality: dict[str, Any] = told["fit"]["heldout"]
        error = tuple(quality[key] for key in ("before", "after", "noise_floor"))
        effects = tuple(str(effect["id"]) for effect in told["effects"])
        verdict, metric = str(told["verdict"]), str(told["fit"]["metric"])
        curves = {str(effect["id"]): effect["curve"] for effect in told["effects"] if effect.get("curve")}
        for curve in curves.values():
            np.column_stack([np.asarray(curve[key], dtype=float) for key in ("points", "force", "std")])
            str(curve["variable"])
    except (KeyError, TypeError, ValueError, AttributeError):
        raise InputError(place.file, "is no diagnosis of ident diagnose", "Write it anew") from None
    known = None if None in error else (float(error[0]), float(error[1]), float(error[2]))
    return Side(str(path), read_parameters(after), verdict, effects, metric, known, curves), [answer, after]


def _write_table(found: Changes, path: Path) -> None:
    stream = io.StringIO(newline="")
    rows = found.as_dict()["changes"]
    writer = csv.DictWriter(stream, rows[0].keys())
    writer.writeheader()
    writer.writerows(rows)
    write_text(path, stream.getvalue())
