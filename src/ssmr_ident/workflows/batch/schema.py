"""The tables that a batch leaves: their columns, types and meanings. Words that are not known are empty."""

from __future__ import annotations

from typing import Any

COLUMNS: dict[str, dict[str, tuple[str, str]]] = {
    "sessions": {
        "session": ("string", "folder below the one that was searched"),
        "status": ("string", "done, failed (the session cannot be read or fitted), timeout or killed"),
        "error": ("string", "one line, where it is not done"),
        "name": ("string", "of the session, as its file says"),
        "robot": ("string", "name in the parameter file"),
        "baseline": ("string", "as in session.yaml"),
        "experiments": ("string", "kinds of its recordings, joined by +"),
        "recordings": ("int64", "how many"),
        "logged": ("string", "when its first log was written (UTC, ISO 8601)"),
        "verdict": ("string", "missing_physics, nothing_missing or undetermined"),
        "effects": ("string", "ids of what is missing, joined by +"),
        "elements": ("string", "where each of them acts, joined by +"),
        "confidence": ("double", "of the first of them, 0 … 1"),
        "metric": ("string", "nrmse_percent or log_psd_db"),
        "heldout_before": ("double", "error of the baseline on recordings never fitted, in the metric"),
        "heldout_after": ("double", "the same with what is missing"),
        "noise_floor": ("double", "what noise alone leaves of it"),
        "summary": ("string", "the answer in a sentence"),
        "seconds": ("double", "of a processor"),
    },
    "parameters": {
        "session": ("string", "as above"),
        "robot": ("string", "as above"),
        "logged": ("string", "as above"),
        "source": ("string", "fit (ident fit) or after (the diagnosis, with what was missing)"),
        "parameter": ("string", "dotted path; effects.ID.KEY for those of effects"),
        "value": ("double", "in unit"),
        "std": ("double", "standard deviation, in unit; empty where unknown"),
        "unit": ("string", ""),
    },
    "explanations": {
        "session": ("string", "as above"),
        "explanation": ("string", "ids joined by +; baseline for none"),
        "log_evidence": ("double", "natural, over the baseline's"),
        "heldout_metric": ("double", "in the session's metric"),
        "named": ("bool", "whether the answer names it"),
    },
}


def session_row(row: dict[str, Any]) -> dict[str, Any]:
    """A row of ``sessions`` from what a session came to."""
    found = row.get("diagnosis") or {}
    effects = found.get("effects") or []
    heldout = (found.get("fit") or {}).get("heldout") or {}
    return {
        **{key: row.get(key) for key in ("session", "status", "error", "name", "robot", "baseline", "recordings")},
        "experiments": "+".join(row.get("experiments") or []) or None,
        "logged": row.get("logged"),
        "verdict": found.get("verdict"),
        "effects": "+".join(effect["id"] for effect in effects) if found else None,
        "elements": "+".join(str(effect.get("element") or "") for effect in effects) if found else None,
        "confidence": effects[0].get("confidence") if effects else None,
        "metric": (found.get("fit") or {}).get("metric"),
        "heldout_before": heldout.get("before"),
        "heldout_after": heldout.get("after"),
        "noise_floor": heldout.get("noise_floor"),
        "summary": found.get("summary"),
        "seconds": row.get("seconds"),
    }


def parameter_rows(row: dict[str, Any]) -> list[dict[str, Any]]:
    """Rows of ``parameters``."""
    shared = {key: row.get(key) for key in ("session", "robot", "logged")}
    return [{**shared, **number} for number in row.get("parameters") or []]


def explanation_rows(row: dict[str, Any]) -> list[dict[str, Any]]:
    """Rows of ``explanations``."""
    found = row.get("diagnosis") or {}
    named = "+".join(effect["id"] for effect in found.get("effects") or []) or "baseline"
    return [
        {
            "session": row["session"], "explanation": tried["id"], "log_evidence": tried.get("log_evidence"),
            "heldout_metric": tried.get("heldout_metric"), "named": tried["id"] == named,
        }
        for tried in found.get("explanations_tried") or []
    ]  # fmt: skip
