"""How a diagnosis fares against the truth: what the answer is worth, one row per session, rows in files."""

from __future__ import annotations

import hashlib
import itertools
import json
import math
import subprocess
import time
import traceback
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ssmr_ident.core.threads import processors
from ssmr_ident.diagnose.diagnosis import MISSING, NOTHING, UNDETERMINED, Diagnosis

LARGEST_TIE = 3
GOOD = ("right", "tie")
Row = dict[str, Any]


def outcome(truth: Sequence[str], diagnosis: Diagnosis) -> str:
    """What the answer is worth.

    ``right``: verdict and all names; ``tie``: every true name is there or in the tie, of three at most, of a name
    that is, and there is no name more; ``part`` (some of the right names, no wrong ones), ``wrong`` (a name that
    does not belong, beside right ones too), ``missed``, ``false alarm``, ``undetermined``.
    """
    named = [effect.id for effect in diagnosis.effects]
    if not truth:
        return {NOTHING: "right", UNDETERMINED: "undetermined"}.get(diagnosis.verdict, "false alarm")
    if diagnosis.verdict == NOTHING:
        return "missed"
    if diagnosis.verdict == MISSING and sorted(named) == sorted(truth):
        return "right"
    held = [{effect.id, *effect.indistinguishable_from} for effect in diagnosis.effects]
    if len(held) == len(truth) and all(len(group) <= LARGEST_TIE for group in held):
        for order in itertools.permutations(held):
            if all(name in group for name, group in zip(truth, order, strict=True)):
                return "tie"
    if diagnosis.verdict == UNDETERMINED:
        return "undetermined"
    return "part" if set(named) < set(truth) else "wrong"


def row_of(
    name: str,
    truth: Sequence[str],
    run: Callable[[], Diagnosis],
    floors: Mapping[str, float],
    true_effects: Mapping[str, Mapping[str, float]] | None = None,
    true_parameters: Mapping[str, float] | None = None,
    **more: Any,
) -> tuple[Row, Diagnosis | None]:
    """Run a diagnosis and judge it.

    Parameters
    ----------
    name : str
    truth : sequence of str
        Ids of what was left out.
    run : callable
        Gives the diagnosis.
    floors : mapping of str to float
        Noise floor of the metric per recording, from the true signals.
    true_effects, true_parameters : mappings
        Of the plant, as far as the catalogue's formula and file have them.
    **more
        Kept in the row.
    """
    row: Row = {"name": name, "truth": list(truth), "processors": processors(), **more}
    begin = time.perf_counter()
    try:
        diagnosis = run()
    except Exception:  # a session that breaks the engine is a result, and must not end a night's run
        row |= {"outcome": "failed", "seconds": time.perf_counter() - begin, "error": traceback.format_exc(limit=-3)}
        return row, None
    heldout = diagnosis.heldout
    true_floor = [floors[file] for file in heldout.recordings if file in floors]
    row |= {
        "seconds": time.perf_counter() - begin,
        "outcome": outcome(truth, diagnosis),
        "verdict": diagnosis.verdict,
        "named": [effect.id for effect in diagnosis.effects],
        "ties": [list(effect.indistinguishable_from) for effect in diagnosis.effects],
        "confidence": [effect.confidence for effect in diagnosis.effects],
        "before": heldout.before,
        "after": heldout.after,
        "floor_said": heldout.noise_floor,
        "floor": float(np.mean(true_floor)) if true_floor else float("nan"),
        "errors": errors(diagnosis, true_effects or {}, true_parameters or {}),
    }
    return row, diagnosis


def errors(
    diagnosis: Diagnosis, effects: Mapping[str, Mapping[str, float]], parameters: Mapping[str, float]
) -> dict[str, float]:
    """(value − true)/std of every parameter whose truth is known, by its path."""
    found = {}
    for effect in diagnosis.effects:
        for name, true in effects.get(effect.id, {}).items():
            estimate = effect.parameters.get(name)
            if estimate is not None and estimate.std and math.isfinite(estimate.std) and not estimate.fixed:
                found[f"{effect.id}.{name}"] = (float(estimate.value) - true) / estimate.std
    for path, true in parameters.items():
        estimate = diagnosis.after.get(path)
        if estimate is not None and estimate.std and not estimate.fixed:
            found[path] = (float(estimate.value) - true) / estimate.std
    return found


def engine() -> str:
    """The last commit that changed the package; with a digest of its files where they are changed beside it."""
    root = Path(__file__).resolve().parents[1]

    def git(*words: str) -> str:
        return subprocess.run(["git", *words], cwd=root, capture_output=True, text=True, check=True).stdout.strip()

    commit = git("log", "-1", "--format=%h", "--", "src")
    if not git("status", "--porcelain", "--", "src"):
        return commit
    files = sorted((root / "src").rglob("*.py"))
    return f"{commit}+{hashlib.sha256(b''.join(file.read_bytes() for file in files)).hexdigest()[:6]}"


def read(file: Path) -> list[Row]:
    """Rows of a result file, none where there is none."""
    if not file.is_file():
        return []
    return [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines() if line.strip()]


def append(file: Path, row: Row) -> None:
    """One line more."""
    file.parent.mkdir(parents=True, exist_ok=True)
    with file.open("a", encoding="utf-8") as stream:
        stream.write(json.dumps(row, default=float) + "\n")


def share(good: int, of: int) -> str:
    """A rate with its 95 % interval (Clopper-Pearson), in percent."""
    from scipy.stats import beta

    if of == 0:
        return "none"
    low = 0.0 if good == 0 else float(beta.ppf(0.025, good, of - good + 1))
    high = 1.0 if good == of else float(beta.ppf(0.975, good + 1, of - good))
    return f"{good}/{of} = {100 * good / of:.1f} % ({100 * low:.1f} … {100 * high:.1f})"
