"""Which files of a folder are logs."""

from __future__ import annotations

import json
from pathlib import Path

from ssmr_ident.readers.folder import logs_in


def test_a_json_of_samples_is_a_log_and_one_of_settings_or_results_is_not(tmp_path: Path) -> None:
    rows = [{"t": k / 100, "force_N": float(k)} for k in range(20)]
    for name, content in {
        "rows.json": rows,
        "arrays.json": {"fs": 100, "force_N": [float(k) for k in range(20)]},
        "columns.json": {"force_N": {str(k): float(k) for k in range(20)}},
        "settings.json": {"device": "phone", "sensors": [{"name": "acc"}], "range": [0, 16]},
        "result.json": {"schema": "x/1", "points": [float(k) for k in range(20)]},
    }.items():
        (tmp_path / name).write_text(json.dumps(content))
    files, errors = logs_in([tmp_path])
    assert [file.name for file in files] == ["arrays.json", "columns.json", "rows.json"]
    assert not errors


def test_a_packed_log_is_one_and_other_packed_files_are_not(tmp_path: Path) -> None:
    for name in ("log.csv.gz", "log.lvm.xz", "notes.md.gz", "backup.gz"):
        (tmp_path / name).write_bytes(b"\x1f\x8b")
    files, _ = logs_in([tmp_path])
    assert [file.name for file in files] == ["log.csv.gz", "log.lvm.xz"]
