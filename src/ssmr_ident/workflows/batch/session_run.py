"""One session of many: fitted, diagnosed, its files written, and its row."""

from __future__ import annotations

import time
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from ssmr_ident.core.atomic import write_text
from ssmr_ident.core.documents import json_text
from ssmr_ident.core.errors import InputError, SimulationError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.experiments.campaign import Campaign, load_logs
from ssmr_ident.physics.effects import effects_of
from ssmr_ident.session import read_parameters, read_session, write_parameters
from ssmr_ident.workflows.batch.task import ROW, Task
from ssmr_ident.workflows.fit.run import fit_campaign


def run_session(task: Task) -> str:
    """Fit and diagnose one session, write its files, and tell what came out.

    Returns
    -------
    str
        One line of JSON, as it stands in the session's folder of results: ``session``, ``status`` (``done`` or
        ``failed``), ``error``, ``seconds`` (of this process), ``fingerprint``, and where the session could be read:
        ``name``, ``robot``, ``baseline``, ``experiments``, ``recordings``, ``logged``, ``parameters``, ``diagnosis``.
    """
    begun = time.process_time()
    row: dict[str, Any] = {"session": task.name, "status": "done", "error": "", "fingerprint": ""}
    out = Path(task.out)
    out.mkdir(parents=True, exist_ok=True)
    try:
        with effects_of(*task.effects):
            session = read_session(task.folder)
            row["fingerprint"] = task.fingerprint(session)
            campaign = load_logs(session)
            row |= _facts(campaign)
            _answers(task, campaign, row, out)
    except (InputError, SimulationError) as error:
        row |= {"status": "failed", "error": " ".join(str(error).split())}
    except Exception as error:  # a fault of this package costs the one session, and is told as such
        row |= {"status": "failed", "error": f"{type(error).__name__}: {' '.join(str(error).split())}"}
    row["fingerprint"] = row["fingerprint"] or task.fingerprint()
    row["seconds"] = time.process_time() - begun
    told = json_text(row)
    write_text(out / ROW, told)
    return told


def _answers(task: Task, campaign: Campaign, row: dict[str, Any], out: Path) -> None:
    known = read_parameters(task.params) if task.params else None
    fit = fit_campaign(campaign, seed=task.seed, parameters=known)
    write_parameters(out / "params.yaml", fit.parameters)
    row["parameters"] = _numbers(fit.parameters, "fit", fit.changed)
    if task.diagnose:
        from ssmr_ident.workflows.diagnose import diagnose, write_diagnosis

        found = diagnose(campaign, known, task.seed)
        write_diagnosis(found, campaign, out, f"ident diagnose {task.name}", task.seed, report=task.report)
        row["diagnosis"] = found.as_dict()
        row["parameters"] += _numbers(found.after, "after", fit.changed)


def _facts(campaign: Campaign) -> dict[str, Any]:
    session = campaign.session
    logged = min(path.stat().st_mtime for entry in session.entries for path in session.paths(entry))
    return {
        "name": session.name,
        "robot": campaign.parameters.name,
        "baseline": session.baseline,
        "experiments": sorted({entry.experiment for entry in session.entries}),
        "recordings": len(session.entries),
        "logged": datetime.fromtimestamp(logged, UTC).isoformat(timespec="seconds"),
    }


def _numbers(parameters: ParameterSet, source: str, changed: tuple[str, ...]) -> list[dict[str, Any]]:
    """Scalars that were fitted, and those of effects, as rows."""
    rows = [(path, parameters[path]) for path in changed if path in parameters]
    if source == "after":
        rows += [(f"effects.{i}.{key}", e) for i, block in parameters.effects.items() for key, e in block.items()]
    return [
        {"source": source, "parameter": path, "value": float(e.value), "std": e.std, "unit": e.unit}
        for path, e in rows
        if isinstance(e.value, float | int)
    ]
