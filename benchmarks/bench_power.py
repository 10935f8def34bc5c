"""How large must an effect be to be named right in 95 % of cases?

For every effect of a family sessions are drawn at sizes from the limit to plain sight (``bank``), and the share that is
named right (or in a tie of at most three) is fitted by a logistic curve over the size. Sizes mean different things for
different effects, so the curve is also read against what the effect does: the held-out error of the baseline at its
best over the noise floor.

    python benchmarks/bench_power.py --family forced --sessions 24 --out out/power.jsonl
    python benchmarks/bench_power.py --family decays --short --sessions 12 --out out/power.jsonl
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from bank import draw
from bank.pulls import BLOCKS
from bank.rig_physics import LISTED
from bank.robot_physics import BENCH, DECAYS, PULLS
from scipy.optimize import brentq, minimize
from scipy.special import expit
from scoring import GOOD, Row, append, engine, read, row_of

from ssmr_ident.workflows.diagnose import diagnose

EFFECTS = {
    "decays": tuple(DECAYS), "pulls": tuple(PULLS), "bench": BENCH, "block": tuple(BLOCKS), "forced": tuple(LISTED),
    "rig_decay": tuple(name for name in LISTED if not name.startswith("sensor")),
}  # fmt: skip
WANTED = 0.95


def logistic(x: np.ndarray, hit: np.ndarray) -> tuple[float, float]:
    """Place and slope of the curve, most probable with a weak prior that keeps a perfect separation finite."""

    def cost(p: np.ndarray) -> float:
        u = np.exp(p[1]) * (x - p[0])
        log_likelihood = np.sum(np.where(hit, np.log(expit(u) + 1e-12), np.log(expit(-u) + 1e-12)))
        return float(-log_likelihood + 0.5 * ((p[1] - np.log(6.0 / max(np.ptp(x), 1e-9))) / 0.7) ** 2)

    middle = float(np.mean(x))
    starts = [np.array([place, np.log(6.0 / max(np.ptp(x), 1e-9))]) for place in (x.min(), middle, x.max())]
    best = min((minimize(cost, start, method="Nelder-Mead") for start in starts), key=lambda found: found.fun)
    return float(best.x[0]), float(np.exp(best.x[1]))


def needed(x: np.ndarray, hit: np.ndarray) -> float:
    """Where the curve reaches 95 %: the least that was drawn where all of it was named, infinite beyond what was drawn,
    by half of its range and more."""
    place, slope = logistic(x, hit)
    at = float(brentq(lambda v: expit(slope * (v - place)) - WANTED, -1e3, 1e3))
    return max(at, float(x.min())) if at <= x.max() + 0.5 * np.ptp(x) else float("inf")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--family", default="forced", choices=sorted(EFFECTS))
    parser.add_argument("--effects", help="comma-separated; all of the family otherwise")
    parser.add_argument("--sessions", type=int, default=24, help="per effect, sizes spread evenly")
    parser.add_argument("--first", type=int, default=500_000, help="first seed")
    parser.add_argument("--short", action="store_true", help="fewer and shorter recordings, which show less")
    parser.add_argument("--out", type=Path, default=Path("out/power.jsonl"))
    parser.add_argument("--summary", action="store_true")
    arguments = parser.parse_args()
    effects = arguments.effects.split(",") if arguments.effects else EFFECTS[arguments.family]
    done = {(row["family"], row["effect"], row["seed"], row.get("short", False)) for row in read(arguments.out)}
    version = engine()
    for effect in () if arguments.summary else effects:
        for index in range(arguments.sessions):
            seed = arguments.first + index
            if (arguments.family, effect, seed, arguments.short) in done:
                continue
            size = (index + 0.5) / arguments.sessions
            drawn = draw(arguments.family, "one", seed, effect, size, arguments.short)
            row, _ = row_of(
                f"{effect}-{seed}",
                drawn.truth.ids,
                lambda drawn=drawn: diagnose(drawn.campaign, seed=drawn.seed),  # type: ignore[misc]
                drawn.truth.noise_floor,
                drawn.truth.effects,
                drawn.truth.parameters,
                family=arguments.family,
                effect=effect,
                seed=seed,
                size=size,
                short=arguments.short,
                strength=dict(drawn.truth.effects[effect]),
                engine=version,
            )
            append(arguments.out, row)
    print(report(read(arguments.out)))


def report(rows: list[dict]) -> str:
    """One line per effect."""
    lines = [
        "95 % named right (or in a tie) from …",
        f"{'family':<16}{'effect':<26}{'n':>4}{'right':>7}{'size':>7}{'baseline/noise floor':>22}   parameter there",
    ]
    for family, effect, short in sorted({_asked(row) for row in rows}):
        part = [r for r in rows if _asked(r) == (family, effect, short) and r["outcome"] != "failed"]
        if len(part) < 8:
            continue
        hit = np.array([r["outcome"] in GOOD for r in part])
        size = np.array([r["size"] for r in part])
        contrast = np.log(np.maximum(np.array([r["before"] / r["floor"] for r in part]) - 1.0, 1e-3))
        at, ratio = needed(size, hit), 1.0 + float(np.exp(needed(contrast, hit)))
        name, values = next(
            ((k, [r["strength"].get(k, np.nan) for r in part]) for k in part[0]["strength"] if _varies(part, k, size)),
            ("", [np.nan] * len(part)),
        )
        there = f"{name} {np.interp(at, size, np.abs(values)):.3g}" if name and np.isfinite(at) else ""
        shown = [f"{v:.2f}" if np.isfinite(v) else "beyond" for v in (at, ratio)]
        of = f"{family}, short" if short else family
        lines.append(f"{of:<16}{effect:<26}{len(part):>4}{hit.sum():>7}{shown[0]:>7}{shown[1]:>22}   {there}")
    return "\n".join(lines)


def _asked(row: Row) -> tuple[str, str, bool]:
    """Family and effect of a session, and whether its recordings are few and short."""
    return row["family"], row["effect"], row.get("short", False)


def _varies(part: list[dict], name: str, size: np.ndarray) -> bool:
    """Whether a parameter is what the size sets: in step with it over the sessions."""
    values = np.abs([r["strength"].get(name, np.nan) for r in part])
    return bool(np.ptp(values) > 0 and abs(np.corrcoef(np.argsort(np.argsort(values)), size)[0, 1]) > 0.6)


if __name__ == "__main__":
    main()
