"""What peers say when something is missing and when nothing is: rigs of practice/ and random ones, side by side.

Least squares with residual tests, PySINDy on the residual force, mujoco.sysid (``pip install 'ssmr_ident[peers]'``);
the diagnosis is run on the same sessions.

    python benchmarks/bench_peers.py --count 24
"""

from __future__ import annotations

import argparse
import time
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from bank import draw
from doctor.folders import SHARED
from scoring import append, read, share

from ssmr_ident.diagnose.diagnosis import NOTHING
from ssmr_ident.experiments.campaign import Campaign, load
from ssmr_ident.workflows.diagnose import diagnose
from ssmr_proof.peers import PEERS

RIGS = ("15", "16", "17", "18", "19", "23")
TURN = ("none", "one", "none", "other", "none", "one", "none", "unlisted")


def ours(campaign: Campaign) -> dict[str, Any]:
    begin = time.perf_counter()
    found = diagnose(campaign)
    named = [effect.id for effect in found.effects]
    return {
        "missing": found.verdict != NOTHING,
        "claims": named,
        "effects": named,
        "seconds": time.perf_counter() - begin,
    }


def theirs(name: str, campaign: Campaign) -> dict[str, Any]:
    said = PEERS[name](campaign)
    return {
        "missing": said.says_missing, "claims": list(said.claims), "effects": list(said.effects),
        "seconds": said.seconds, "parameters": {k: list(v) for k, v in said.parameters.items()},
    }  # fmt: skip


def sessions(first: int, count: int) -> Iterator[tuple[str, tuple[str, ...], dict[str, float], Callable[[], Campaign]]]:
    """Name, what is missing, true parameters, and how to get the campaign."""
    import json

    for number in RIGS:
        folder = SHARED / "practice" / f"practice-{number}"
        if folder.is_dir():
            truth = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
            robot = truth["true_robot"]
            known = {"mass_kg": robot["m"], "damping_N_s_m": robot["d"], "stiffness_N_m": robot["k"]}
            ids = tuple(effect["id"] for effect in truth["effects"])
            yield f"practice-{number}", ids, known, lambda folder=folder: load(folder / "session")  # type: ignore[misc]
    for seed in range(first, first + count):
        # plain sizes: what a peer does not see here it will not see smaller
        drawn = draw("forced", TURN[seed % len(TURN)], seed, size=0.7)
        yield f"forced-{seed}", drawn.truth.ids, dict(drawn.truth.parameters), lambda drawn=drawn: drawn.campaign  # type: ignore[misc]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--first", type=int, default=700_000, help="first seed")
    parser.add_argument("--count", type=int, default=24)
    parser.add_argument("--only", help="peers, comma-separated; 'diagnosis' is ours")
    parser.add_argument("--out", type=Path, default=Path("out/peers.jsonl"))
    parser.add_argument("--summary", action="store_true")
    arguments = parser.parse_args()
    names = arguments.only.split(",") if arguments.only else ["diagnosis", *PEERS]
    done = {(row["name"], row["peer"]) for row in read(arguments.out)}
    for name, truth, known, campaign in () if arguments.summary else sessions(arguments.first, arguments.count):
        for peer in names:
            if (name, peer) in done:
                continue
            said = ours(campaign()) if peer == "diagnosis" else theirs(peer, campaign())
            append(arguments.out, {"name": name, "truth": list(truth), "known": known, "peer": peer, **said})
            print(
                f"{name:<16}{'+'.join(truth) or 'nothing':<26}{peer:<15}{'; '.join(said['claims']) or 'nothing'}",
                flush=True,
            )
    report(read(arguments.out))


def report(rows: list[dict[str, Any]]) -> None:
    """Rates per peer."""
    by_peer: dict[str, list[dict[str, Any]]] = defaultdict(list)
    for row in rows:
        by_peer[row["peer"]].append(row)
    for peer, part in by_peer.items():
        nulls, missing = [r for r in part if not r["truth"]], [r for r in part if r["truth"]]
        named = sum(set(r["truth"]) == set(r["effects"]) for r in missing)
        print(f"{peer}: {np.median([r['seconds'] for r in part]):.1f} s a session (median)")
        alarms, seen = (share(sum(r["missing"] for r in group), len(group)) for group in (nulls, missing))
        print(f"  says that something is missing where nothing is   {alarms}")
        print(f"  … and where something is                          {seen}")
        print(f"  names it and nothing else                         {share(named, len(missing))}")
        inside, total, off = 0, 0, []
        for r in missing:
            for key, (value, half) in r.get("parameters", {}).items():
                off.append(abs(value / r["known"][key] - 1.0))
                if np.isfinite(half):
                    total, inside = total + 1, inside + (abs(value - r["known"][key]) <= half)
        if off:
            print(f"  parameters where something is missing: median error {100 * np.median(off):.1f} %", end="")
            print(f", true value in its 95 % interval {share(inside, total)}" if total else ", no intervals")
        said = Counter(claim.split(" · ")[-1] for r in nulls for claim in r["claims"])
        print(f"  said of nulls: {', '.join(f'{claim} ({n})' for claim, n in said.most_common(5)) or 'nothing'}")


if __name__ == "__main__":
    main()
