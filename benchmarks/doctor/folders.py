"""Sessions with known answers that lie in folders beside the checkout: practice sessions, and strangers' logs."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from doctor.frozen import Case
from doctor.opened import Opened
from ssmr_ident.compare import compare, predict
from ssmr_ident.diagnose.diagnosis import NOTHING, Diagnosis
from ssmr_ident.experiments.campaign import load

SHARED = Path(__file__).resolve().parents[3] / "shared"
FAMILY = {
    "free": "decays", "decoupled": "decays", "pull": "pulls", "drag": "pulls", "forced": "rigs", "swivel": "swivels",
}  # fmt: skip
PATHS = {
    "m": "mass_kg", "Ixx": "inertia_kg_m2.xx", "Iyy": "inertia_kg_m2.yy", "Izz": "inertia_kg_m2.zz",
    "Ixz": "inertia_kg_m2.xz", "Kx": "tire.stiffness_x_N_m", "Ky": "tire.stiffness_y_N_m",
    "Kz": "tire.stiffness_z_N_m", "Dx": "tire.damping_x_N_s_m", "Dy": "tire.damping_y_N_s_m",
    "Dz": "tire.damping_z_N_s_m", "mus": "tire.mu_static", "k": "stiffness_N_m", "d": "damping_N_s_m",
}  # fmt: skip


def practice_cases() -> Iterator[Case]:
    """Of the robot, of rigs, and of the robot in other formulas."""
    for name in ("practice", "practice-rigs", "practice-robot"):
        for file in sorted((SHARED / name).glob("*/truth.json")):
            truth = json.loads(file.read_text(encoding="utf-8"))
            family = FAMILY[truth.get("family", "forced")]
            if truth["verdict"] == NOTHING:
                family = f"{family[:-1]}-nulls"
            yield Case(family, f"{name}/{file.parent.name}")


def from_practice(key: str) -> Opened:
    """What is held out lies in a folder of its own, which the engine never sees."""
    folder = SHARED / key
    truth = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
    effects = {
        effect["id"]: {n: float(v["value"]) for n, v in effect["parameters"].items() if isinstance(v, dict)}
        for effect in truth["effects"]
    }

    def heldout(diagnosis: Diagnosis) -> tuple[float, float, float]:
        further = load(folder / "heldout")
        before, after = (
            float(np.mean(list(compare(further, known).overall.values())))
            for known in (diagnosis.before, diagnosis.after)
        )
        return before, after, float(truth["heldout"]["noise_floor"])

    known = {PATHS[name]: float(value) for name, value in truth["true_robot"].items() if name in PATHS}
    return Opened(load(folder / "session"), 0, (tuple(sorted(effects)),), effects, known, heldout=heldout)


def from_practice_rigs(key: str) -> Opened:
    """Any one of some names is right; what noise leaves is told of unfiltered signals."""
    folder = SHARED / key
    truth = json.loads((folder / "truth.json").read_text(encoding="utf-8"))

    def heldout(diagnosis: Diagnosis) -> tuple[float, float, float]:
        further, left = load(folder / "heldout"), []
        for known in (diagnosis.before, diagnosis.after):
            predictions = [predict(further, measurement, known) for measurement in further.measurements]
            left.append(
                float(np.mean([100.0 * (p.measured - p.simulated).std() / p.measured.std() for p in predictions]))
            )
        return left[0], left[1], float(truth["noise_percent"])

    right = tuple((name,) for name in truth["right"]) or ((),)
    return Opened(load(folder / "session"), 0, right, parameters={"mass_kg": float(truth["mass"])}, heldout=heldout)


def stranger_cases() -> Iterator[Case]:
    """Sessions of which a diagnosis is asked."""
    for collection in ("strangers", "strangers/more"):
        for name, expected in _expected(collection).items():
            if "ident diagnose" in expected["command"]:
                verdict = _answer(expected["right"]).get("verdict")
                drags = "block" in name
                family = ("pull" if drags else "rig") + ("-nulls" if verdict == NOTHING else "s")
                yield Case(family, f"{collection}/{name}")


def from_strangers(key: str) -> Opened:
    """A verdict, the names that may stand first, and numbers."""
    collection, name = key.rsplit("/", 1)
    answer = _answer(_expected(collection)[name]["right"])
    if answer.get("verdict") == NOTHING:
        right: tuple[tuple[str, ...], ...] = ((),)
    elif "effects" in answer:
        right = (tuple(sorted(answer["effects"])),)
    else:
        first = answer["first"] if isinstance(answer["first"], list) else [answer["first"]]
        right = tuple((one,) for one in first)
        right += tuple(tuple(sorted((one, *answer["and"]))) for one in first if "and" in answer)
    numbers = {path: float(value) for path, value in answer.items() if isinstance(value, int | float)}
    numbers |= {path: float(value["value"]) for path, value in answer.get("parameters", {}).items()}
    effects = {one: numbers for names in right for one in names}
    return Opened(load(SHARED / key), 0, right, effects, numbers)


def _expected(collection: str) -> dict[str, Any]:
    file = SHARED / collection / "expected.yaml"
    found: dict[str, Any] = yaml.safe_load(file.read_text(encoding="utf-8")) if file.is_file() else {}
    return found


def _answer(right: dict[str, Any]) -> dict[str, Any]:
    """What is said of the diagnosis, in whichever of the two forms."""
    said = right.get("diagnosis", right)
    return {"verdict": said, **right} if isinstance(said, str) else said
