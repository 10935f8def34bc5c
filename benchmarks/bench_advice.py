"""Is the advised recording worth making? ``python benchmarks/bench_advice.py -n 40 --seed 1``.

Rigs let go a few times with physics hidden in them; of every session that ends in a tie the advised recording is made
on the true plant, added, and the answer asked again. Printed are the answers, what the advice promised, and what came
of it.
"""

from __future__ import annotations

import argparse
import re
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.diagnose.diagnosis import MISSING, Diagnosis
from ssmr_ident.doctor.next_recording import SHARES
from ssmr_ident.readers.writers import write_csv
from ssmr_ident.workflows.diagnose import diagnose_session
from ssmr_ident.workflows.new.run import Told, draft_session

MASS, SPRING, DAMPER, RATE, SECONDS = 2.0, 3200.0, 1.2, 200.0, 4.0


@dataclass(frozen=True)
class Hidden:
    """A law in a formula of its own, its id, and how large it is (``size`` of the spring's or damper's force)."""

    id: str
    size: float
    reach: float

    def change(self, time: float, state: np.ndarray) -> list[float]:
        """Rates of displacement, velocity and the hidden force, for a solver."""
        s, v, z = state
        size, k = self.size, SPRING * self.reach
        beside, follows = {
            "hysteresis": (z, 0.3 * size * SPRING * (v - abs(v) * z / (0.3 * size * SPRING * 0.3 * self.reach))),
            "dry_friction": (0.02 * size * k * np.tanh(v / (2e-3 * self.reach * 40.0)), 0.0),
            "quadratic_damping": (0.04 * size * k * v * abs(v) / (self.reach * 40.0) ** 2, 0.0),
            "viscoelastic_relaxation": (z, 0.05 * size * SPRING * v - z / 0.05),
            "nonlinear_stiffness": (0.1 * size * k * (s / self.reach) ** 3, 0.0),
        }[self.id]
        return [v, -(SPRING * s + DAMPER * v + beside) / MASS, follows]

    def recorded(self, amplitude: float, noise: float, random: np.random.Generator) -> Recording:
        """What an accelerometer sees after a release from ``amplitude`` [m]; ``noise`` [m/s^2]."""
        time = np.arange(0.0, SECONDS, 1.0 / RATE)
        states = solve_ivp(
            self.change, (0.0, SECONDS), [amplitude, 0.0, 0.0], t_eval=time, rtol=1e-8, atol=1e-12, max_step=2e-3
        ).y.T
        seen = np.array([self.change(0.0, state)[1] for state in states]) + noise * random.standard_normal(len(time))
        return Recording(time, (Channel("acceleration", seen, "m/s^2"),), Provenance("", "", "made"))


def asked(folder: Path) -> Diagnosis:
    for name in ("session.yaml", "rig.yaml"):
        (folder / name).unlink(missing_ok=True)
    draft_session(folder, Told(mass=MASS)).write()
    return diagnose_session(folder)


def names(found: Diagnosis) -> tuple[list[str], list[str]]:
    return [e.id for e in found.effects], [i for e in found.effects for i in e.indistinguishable_from]


def promised(advice: str) -> tuple[int, float, float]:
    """Number of the log that the advice is a variant of, of which share, and the chance that it decides."""
    share = next((share for share, words in SHARES.items() if words and f"with {words} the motion" in advice), 1.0)
    number, chance = re.search(r"decay-(\d+)", advice), re.search(r"probability of (more|less)?\D*(\d+) %", advice)
    assert number is not None
    assert chance is not None
    return int(number[1]), share, float(chance[2]) / 100.0


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-n", type=int, default=40, help="sessions drawn")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    random = np.random.default_rng(options.seed)
    followed: list[tuple[float, bool, bool]] = []
    for number in range(options.n):
        reach = float(random.choice([3e-3, 6e-3]))
        amplitudes = [(reach, reach), (reach, reach, reach), (reach, 0.5 * reach)][random.integers(3)]
        kinds = ("hysteresis", "dry_friction", "quadratic_damping", "viscoelastic_relaxation", "nonlinear_stiffness")
        plant = Hidden(str(random.choice(kinds)), float(10 ** random.uniform(-1.0, 0.3)), reach)
        noise = float(10 ** random.uniform(-1.3, 0.2))
        with tempfile.TemporaryDirectory() as place:
            folder = Path(place)
            for k, amplitude in enumerate(amplitudes):
                write_csv(folder / f"decay-{k}.csv", plant.recorded(amplitude, noise, random), decimals=5)
            first = asked(folder)
            if not first.next_experiment:
                print(f"{number:3d} {plant.id:24s} {first.verdict}, {' '.join(names(first)[0])}", flush=True)
                continue
            of, share, chance = promised(first.next_experiment)
            made = plant.recorded(share * amplitudes[of], noise, random)
            write_csv(folder / f"decay-{len(amplitudes)}.csv", made, decimals=5)
            second = asked(folder)
        ids, ties = names(second)
        decided, right = second.verdict == MISSING and not ties, plant.id in (*ids, *ties)
        followed.append((chance, decided, right))
        was = " or ".join((*names(first)[0], *names(first)[1])) or first.verdict
        print(
            f"{number:3d} {plant.id:24s} {was}; {first.next_experiment}; then {second.verdict}, "
            f"{' '.join(ids)}{' or ' + ' or '.join(ties) if ties else ''}",
            flush=True,
        )
    for low, high in ((0.0, 0.5), (0.5, 1.01)):
        part = [f for f in followed if low <= f[0] < high]
        if part:
            chances, decided, right = (np.array(column, float) for column in zip(*part, strict=True))
            print(
                f"promised {100 * low:.0f} to {100 * min(high, 1):.0f} %: {len(part)} followed, mean promise "
                f"{100 * chances.mean():.0f} %, decided {100 * decided.mean():.0f} %, the true law among the names "
                f"{100 * right.mean():.0f} %, named alone {100 * (decided * right).mean():.0f} %"
            )


if __name__ == "__main__":
    main()
