"""Swivel sessions drawn at random, diagnosed, and counted: right, tied, false alarms.

    python benchmarks/bench_swivel.py effects 60 --seed 1 -o effects.jsonl
    python benchmarks/bench_swivel.py null 20 --seed 2 -o null.jsonl
    python benchmarks/bench_swivel.py repeat 200 --seed 3 -o repeat.jsonl
    python benchmarks/bench_swivel.py loose 20 --seed 4 -o loose.jsonl
    python benchmarks/bench_swivel.py drawn 29180:ground_joints:calibrated 29181:stribeck:loose -o drawn.jsonl
    python benchmarks/bench_swivel.py ten 4 --seed 5 -o ten.jsonl
    python benchmarks/bench_swivel.py report effects.jsonl repeat.jsonl loose.jsonl

``null`` are sessions with nothing missing, two of three with calibration; ``repeat`` have calibration, and only those
whose targets do not repeat it within chance are diagnosed further, since a diagnosis of the others ends there;
``loose`` have none; ``ten`` are sessions of ten recordings, for what they take.

Sessions are those of ``bank.swivels``. Results are appended one by one: a run may be broken off and taken up.
"""

from __future__ import annotations

import argparse
import json
import time
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
from bank.swivels import DRAWS, VISIBLE, draw_session
from scipy.stats import beta

from ssmr_ident.diagnose.diagnosis import MISSING, NOTHING
from ssmr_ident.doctor.swivels.anchor import scale_of
from ssmr_ident.doctor.swivels.assemble import MODEL_SPREAD, SPREAD_FACTOR, diagnosis_of
from ssmr_ident.doctor.swivels.bench import Bench
from ssmr_ident.doctor.swivels.conditions import conditions_of
from ssmr_ident.doctor.swivels.engine import examine, repeated
from ssmr_ident.doctor.swivels.outcome import Outcome
from ssmr_ident.doctor.swivels.verdict import LEFT, findings_of
from ssmr_ident.experiments.campaign import Campaign


def row_of(outcome: Outcome, truth: dict, begun: float) -> dict:
    """What the whole diagnosis says, and the numbers behind it."""
    answer = diagnosis_of(outcome, str(truth["seed"]))
    seconds = time.perf_counter() - begun
    fitted = {
        one.id: {free.name: (one.values[free.name], None if one.spread is None else float(one.spread[i]), free.log)
                 for i, free in enumerate(one.candidate.free)}
        for one in outcome.explanations
    }  # fmt: skip
    named = [name for one in answer.effects for name in (one.id, *one.indistinguishable_from)]
    heldout = (answer.heldout.before, answer.heldout.after, answer.heldout.noise_floor)
    return {
        **truth, "verdict": answer.verdict, "named": named, "heldout_db": heldout,
        "findings": findings_of(outcome).as_dict(), "fitted": fitted, "seconds": round(seconds, 1),
    }  # fmt: skip


def run_many(kind: str, count: int, seed: int, output: Path) -> None:
    done = {json.loads(line)["seed"] for line in output.read_text().splitlines()} if output.exists() else set()
    names = list(DRAWS)
    for i in range(count):
        number = 1000 * seed + i
        if number in done:
            continue
        effect = names[i % len(names)] if kind == "effects" else None
        one(number, effect, kind != "loose" and (i + i // len(names)) % 3 != 2, output)


def drawn(tokens: list[str], output: Path) -> None:
    """Sessions by name: SEED:EFFECT:calibrated or SEED:EFFECT:loose, ``none`` for nothing missing."""
    for token in tokens:
        number, effect, how = token.split(":")
        one(int(number), None if effect == "none" else effect, {"calibrated": True, "loose": False}[how], output)


def one(number: int, effect: str | None, calibrated: bool, output: Path) -> None:
    """Draw one session, diagnose it, and append what was said."""
    campaign, truth = draw_session(number, effect, calibrated)
    begun = time.perf_counter()
    row = truth if campaign is None else row_of(examine(campaign), truth, begun)
    with output.open("a") as file:
        file.write(json.dumps(row) + "\n")
    said = (row["verdict"], row["named"], np.round(row["heldout_db"], 1).tolist()) if campaign else "cannot be seen"
    print(number, effect, row.get("calibrated"), row.get("seconds"), said, flush=True)


def repeats(count: int, seed: int, output: Path) -> None:
    """Null sessions with calibration: the whole diagnosis of those alone whose targets do not repeat it within chance.

    A diagnosis of the others ends there, with nothing missing.
    """
    rows = [json.loads(line) for line in output.read_text().splitlines()] if output.exists() else []
    done = {row["seed"] for row in rows}
    for number in range(1000 * seed, 1000 * seed + count):
        if number in done:
            continue
        campaign, truth = draw_session(number, None, calibrated=True)
        conditions, _ = conditions_of(campaign, campaign.parameters)
        calibration = tuple(c for c in conditions if c.role == "calibration")
        targets = tuple(c for c in conditions if c.role == "target")
        found = repeated(Bench(campaign.parameters), calibration, targets, scale_of(calibration), (1, 2))
        row = {**truth, "verdict": NOTHING, "named": []}
        if found.left > LEFT:
            begun = time.perf_counter()
            row = row_of(examine(campaign), truth, begun)
            print(number, round(found.left, 1), row["verdict"], row["named"], flush=True)
        rows.append({**row, "left": found.left})
        with output.open("a") as file:
            file.write(json.dumps(rows[-1]) + "\n")
        if len(rows) % 20 == 0:
            said = Counter(row["verdict"] for row in rows if row["left"] > LEFT)
            alarms = sum(row["verdict"] == MISSING for row in rows)
            print(f"{len(rows)} null sessions: {said.total()} above {LEFT:g}: {dict(said)}; "
                  f"false alarms {_interval(alarms, len(rows))}", flush=True)  # fmt: skip


def ten(count: int, seed: int, output: Path) -> None:
    """How long ten recordings take: five speeds before and after, in turn with eight targets and two kept back."""
    names = [name for name in DRAWS if name not in ("wheel_lift", "coriolis")]
    for i in range(count):
        campaign, truth = draw_session(1000 * seed + i, names[i % len(names)], i % 2 == 0, 5 if i % 2 == 0 else 8)
        if campaign is None:
            continue
        kept = campaign.measurements
        if truth["calibrated"]:  # five speeds twice are ten: the middle one is kept back by the diagnosis
            kept = tuple(m for m in kept if m.entry.role != "heldout")
        entries = tuple(m.entry for m in kept)
        campaign = Campaign(replace(campaign.session, entries=entries), campaign.parameters, kept)
        begun, busy = time.perf_counter(), time.process_time()
        row = row_of(examine(campaign), truth, begun)
        row["processor_seconds"] = round(time.process_time() - busy, 1)
        with output.open("a") as file:
            file.write(json.dumps(row) + "\n")
        print(len(kept), truth["effect"], truth["calibrated"], row["seconds"], row["processor_seconds"], row["named"],
              np.round(row["heldout_db"], 1).tolist(), flush=True)  # fmt: skip


def report(paths: list[Path]) -> None:
    """Rates with exact intervals, and the confusion matrix, of what was stored."""
    rows = [json.loads(line) for path in paths for line in path.read_text().splitlines()]
    unseen = Counter(row["effect"] for row in rows if "verdict" not in row)
    rows = [row for row in rows if "verdict" in row]
    for calibrated in (True, False, None):
        part = [row for row in rows if calibrated is None or row["calibrated"] == calibrated]
        label = {True: "with calibration", False: "without calibration", None: "all"}[calibrated]
        nulls = [row for row in part if row["effect"] is None]
        drawn = [row for row in part if row["effect"] is not None]
        right = sum(row["effect"] in row["named"] for row in drawn)
        alone = sum(row["named"] == [row["effect"]] for row in drawn)
        alarms = sum(row["verdict"] == "missing_physics" for row in nulls)
        unsure = sum(row["verdict"] == "undetermined" for row in nulls)
        print(f"\n{label}: {len(drawn)} sessions with an effect, {right} right or tied "
              f"({_interval(right, len(drawn))}), {alone} right alone; "
              f"{len(nulls)} null sessions, {alarms} false alarms "
              f"({_interval(alarms, len(nulls))}), {unsure} undetermined")  # fmt: skip
    drawn = [row for row in rows if row["effect"] is not None]
    print("\n| acted | sessions | right or tied | alone | first named (times) |\n| --- | --- | --- | --- | --- |")
    for effect in DRAWS:
        mine = [row for row in drawn if row["effect"] == effect]
        if mine:
            first = Counter((row["named"] or [row["verdict"]])[0] for row in mine)
            said = ", ".join(f"`{name}` {times}" for name, times in first.most_common())
            print(f"| `{effect}` | {len(mine)} | {sum(effect in row['named'] for row in mine)} "
                  f"| {sum(row['named'] == [effect] for row in mine)} | {said} |")  # fmt: skip
    named = [row for row in drawn if row["named"][:1] == [row["effect"]]]
    if named:
        before, after, floor = np.array([row["heldout_db"] for row in named]).T
        print(f"\nheld out, effect named first: median {np.median(before):.1f} dB to {np.median(after):.1f} dB, "
              f"cut by a third or more in {np.sum(after < 2 / 3 * before)} of {len(named)}, "
              f"within 1.5 dB of repeatability in {np.sum(after < floor + 1.5)}")  # fmt: skip
        for width in (1.0, 2.0, 3.0):
            inside = [ok for row in named for ok in _inside(row, width)]
            print(f"parameters within {width:g} printed standard deviations: {sum(inside)} of {len(inside)}")
    if unseen:
        print(f"\nnever moved the spectra by {VISIBLE:g} times their scatter: {dict(unseen)}")
    seconds = [row["seconds"] for row in rows if "seconds" in row]
    print(f"\nseconds per whole diagnosis: median {np.median(seconds):.0f}, longest {np.max(seconds):.0f}")


def _interval(hits: int, count: int) -> str:
    """Clopper and Pearson, 95 %."""
    if not count:
        return "-"
    low = beta.ppf(0.025, hits, count - hits + 1) if hits else 0.0
    high = beta.ppf(0.975, hits + 1, count - hits) if hits < count else 1.0
    return f"{low:.1%} to {high:.1%}"


def _inside(row: dict, width: float) -> list[bool]:
    """Whether each fitted parameter of the effect that acted lies within ``width`` printed standard deviations."""
    found = []
    for name, (value, spread, log) in row["fitted"].get(row["effect"], {}).items():
        true = row["effects"].get(row["effect"], {}).get(name)
        if spread is None or true is None:
            continue
        sigma = np.hypot(SPREAD_FACTOR * spread, MODEL_SPREAD if log else 0.0)
        found.append(bool(abs(np.log(value / true) if log else value - true) < width * sigma))
    return found


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kind", choices=("effects", "null", "loose", "drawn", "repeat", "ten", "report"))
    parser.add_argument("arguments", nargs="+")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("-o", "--output", type=Path, default=Path("swivel.jsonl"))
    given = parser.parse_args()
    if given.kind == "report":
        report([Path(path) for path in given.arguments])
    elif given.kind == "drawn":
        drawn(given.arguments, given.output)
    elif given.kind == "repeat":
        repeats(int(given.arguments[0]), given.seed, given.output)
    elif given.kind == "ten":
        ten(int(given.arguments[0]), given.seed, given.output)
    else:
        run_many(given.kind, int(given.arguments[0]), given.seed, given.output)
