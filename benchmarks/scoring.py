"""How a diagnosis fares against the truth: one row per session, and the summary of many."""

from __future__ import annotations

import hashlib
import itertools
import json
import math
import subprocess
import time
import traceback
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ssmr_ident.core.atomic import write_text
from ssmr_ident.core.threads import processors
from ssmr_ident.diagnose.diagnosis import MISSING, NOTHING, UNDETERMINED, Diagnosis
from ssmr_ident.diagnose.weigh import CERTAIN

LARGEST_TIE = 3
UNSEEN = 1.02
"""Held-out error of the baseline over the noise floor up to which nothing could be gained by naming anything."""

GOOD = ("right", "tie", "clean")
UNNAMED = ("missed", "part")
Row = dict[str, Any]


def outcome(truth: Sequence[str], diagnosis: Diagnosis) -> str:
    """What the answer is worth.

    ``right``: verdict and all names; ``tie``: every true name is there or in the tie, of three at most, of a name
    that is, and there is no name more; ``part`` (some of the right names, no wrong ones), ``wrong`` (a name that is
    none, beside right ones too), ``missed``, ``false alarm``, ``undetermined``.
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


def write(file: Path, rows: Sequence[Row]) -> None:
    """All lines anew, complete or not at all."""
    write_text(file, "".join(json.dumps(row, default=float) + "\n" for row in rows))


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


def is_unseen(row: Row) -> bool:
    """Missed, or named in part, where the session does not show what was not named.

    The baseline explains even recordings that were never fitted down to their noise, or the truth itself, refitted from
    the true values, has no more evidence with that effect than noise alone gives some (``visible.true_evidence``).
    """
    if row["outcome"] not in UNNAMED:
        return False
    evidence = row.get("true_evidence") or {}
    hidden = [evidence.get(name, float("inf")) < CERTAIN for name in row["truth"] if name not in row["named"]]
    return all(hidden) or (row["outcome"] == "missed" and bool(row["before"] <= UNSEEN * row["floor"]))


def summary(rows: Sequence[Row], by: str = "family") -> str:
    """Outcomes, confusion, held-out errors, parameter errors and seconds."""
    parts = [_outcomes(rows, by), _confusion(rows), _heldout(rows), _parameters(rows), _seconds(rows, by)]
    return "\n\n".join(part for part in parts if part)


def _outcomes(rows: Sequence[Row], by: str) -> str:
    groups: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        groups[str(row.get(by, ""))].append(row)
        groups["all"].append(row)
    nulls = [row for row in rows if not row["truth"]]
    missing = [row for row in rows if row["truth"]]
    visible = [row for row in missing if not is_unseen(row)]
    lines = [
        f"{len(rows)} sessions",
        f"  nulls clean                      {share(sum(r['outcome'] == 'clean' for r in nulls), len(nulls))}",
        f"  something missing: right or tie  {share(sum(r['outcome'] in GOOD for r in missing), len(missing))}",
        f"  … without what nobody could see  {share(sum(r['outcome'] in GOOD for r in visible), len(visible))}",
        "",
        f"{by:<14}" + "".join(f"{name:>13}" for name in _OUTCOMES),
    ]
    for name in [*sorted(n for n in groups if n != "all"), "all"]:
        counts = Counter(row["outcome"] if not is_unseen(row) else "unseen" for row in groups[name])
        lines.append(f"{name:<14}" + "".join(f"{counts[o] or '·':>13}" for o in _OUTCOMES))
    return "\n".join(lines)


_OUTCOMES = (
    "clean", "right", "tie", "unseen", "missed", "part", "extra", "wrong", "undetermined", "false alarm", "failed",
)  # fmt: skip


def _confusion(rows: Sequence[Row]) -> str:
    cells: dict[str, Counter[str]] = defaultdict(Counter)
    for row in rows:
        truth = "+".join(row["truth"]) or "nothing"
        if row["outcome"] == "failed":
            cells[truth]["failed"] += 1
        else:
            cells[truth]["as it is" if row["outcome"] in GOOD else _said(row)] += 1
    lines = ["what was missing: what was said (how often)"]
    for truth in sorted(cells):
        said = ", ".join(f"{name} {count}" for name, count in cells[truth].most_common())
        lines.append(f"  {truth:<44} {said}")
    return "\n".join(lines)


def _said(row: Row) -> str:
    names = "+".join(row["named"]) or "nothing"
    tie = sorted({name for ties in row["ties"] for name in ties})
    doubt = "? " if row["verdict"] == UNDETERMINED else ""
    return doubt + names + (f" (or {', '.join(tie)})" if tie else "")


def _heldout(rows: Sequence[Row]) -> str:
    judged = [r for r in rows if r["outcome"] != "failed" and r["floor"] > 0]
    missing = [r for r in judged if r["truth"] and not is_unseen(r)]
    if not judged:
        return ""
    lines = ["held-out error over the noise floor of the true signals (median, 90th of 100)"]
    for name, part in (("something missing", missing), ("nothing missing", [r for r in judged if not r["truth"]])):
        if part:
            for when in ("before", "after", "floor_said"):
                ratio = np.array([r[when] / r["floor"] for r in part])
                label = "floor as said" if when == "floor_said" else when
                lines.append(f"  {name:<18} {label:<14} {np.median(ratio):6.2f} {np.percentile(ratio, 90):8.2f}")
    # one part in a thousand: two fits of the same data end as far apart
    worse = [r["name"] for r in judged if r["after"] > 1.001 * r["before"]]
    lines.append(f"  after worse than before: {share(len(worse), len(judged))} {' '.join(worse[:12])}")
    return "\n".join(lines)


def _parameters(rows: Sequence[Row]) -> str:
    kinds: dict[str, list[float]] = {"effects": [], "baseline": []}
    for row in rows:
        if row["outcome"] in GOOD:
            for path, error in row["errors"].items():
                kinds["effects" if path.split(".")[0] in row["named"] else "baseline"].append(error)
    lines = ["parameter errors in standard deviations, sessions answered right: within 3, median |error|"]
    for name, found in kinds.items():
        if found:
            inside = sum(abs(error) < 3.0 for error in found)
            lines.append(f"  {name:<10} {share(inside, len(found))}, {np.median(np.abs(found)):.2f}")
    return "\n".join(lines) if len(lines) > 1 else ""


def _seconds(rows: Sequence[Row], by: str) -> str:
    groups: dict[str, list[float]] = defaultdict(list)
    for row in rows:
        groups[str(row.get(by, ""))].append(row["seconds"])
    parts = [f"{name} {np.median(found):.1f} / {max(found):.1f}" for name, found in sorted(groups.items())]
    return f"seconds, median / most: {', '.join(parts)}; {sum(sum(g) for g in groups.values()):.0f} in all"


def table(rows: Iterable[Row]) -> str:
    """One line per session, as Markdown."""
    lines = [
        "| session | missing | said | outcome | before | after | noise floor | after/floor | s |",
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for r in rows:
        truth = ", ".join(r["truth"]) or "nothing"
        if r["outcome"] == "failed":
            lines.append(f"| {r['name']} | {truth} | – | failed | | | | | {r['seconds']:.1f} |")
            continue
        numbers = [r["before"], r["after"], r["floor"], r["after"] / r["floor"] if r["floor"] else math.nan]
        cells = " | ".join("" if math.isnan(n) else f"{n:.3g}" for n in numbers)
        lines.append(f"| {r['name']} | {truth} | {_said(r)} | {r['outcome']} | {cells} | {r['seconds']:.1f} |")
    return "\n".join(lines)
