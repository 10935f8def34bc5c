"""READMEs of data/raw: what is in a folder, how it was made, and with which numbers."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import ssmr_ident
from generator import pulls, releases, swivels, truth
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.physics.linear import linear_robot
from ssmr_ident.physics.robot import robot_from_parameters
from ssmr_ident.simulate.measure import Converter

_TEMPLATES = Path(__file__).resolve().parent / "templates"
_SHOWN = (
    "mass_kg",
    *(f"inertia_kg_m2.{axis}" for axis in ("xx", "yy", "zz", "xz")),
    *(f"tire.{kind}_{axis}_{unit}" for kind, unit in (("stiffness", "N_m"), ("damping", "N_s_m")) for axis in "xyz"),
    *("tire.mu_static", "tire.mu_kinetic", "tire.lambda_max", "accelerometer.volts_per_m_s2"),
)


def _table(lab: ParameterSet, true: ParameterSet) -> str:
    rows = ["| parameter | unit | robot.yaml | truth |", "| --- | --- | --- | --- |"]
    for key in _SHOWN:
        known, is_ = lab[key], float(true[key].value)
        spread = "" if known.std is None else f" ± {known.std:.3g}"
        rows.append(f"| {key} | {known.unit} | {float(known.value):.5g}{spread} | {is_:.5g} |")
    return "\n".join(rows)


def _floors() -> str:
    rows = ["| floor | mu_static | mu_kinetic | lambda_max |", "| --- | --- | --- | --- |"]
    rows += [
        f"| {name} | " + " | ".join(f"{v:g}" for v in floor.values()) + " |" for name, floor in truth.TRUE_FLOOR.items()
    ]
    return "\n".join(rows)


def _modes() -> str:
    robot = robot_from_parameters(truth.true_robot("frame"))
    modes = linear_robot(robot).modes()
    names = ("pitch with x", "roll with y", "yaw", "pitch above x", "z", "roll above y")
    rows = ["| mode | Hz | omega_n rad/s | xi |", "| --- | --- | --- | --- |"]
    rows += [
        f"| {name} | {m[0] / (2 * np.pi):.3f} | {m[0]:.4f} | {m[1]:.5f} |" for name, m in zip(names, modes, strict=True)
    ]
    return "\n".join(rows)


def write(folder: Path, seed: int) -> None:
    """Write all READMEs of data/raw."""
    noise = (
        f"White noise {truth.WHITE_M_S2:g} m/s² per sample, 60 Hz mains of {truth.HUM_M_S2:g} m/s² with its own\n"
        f"phase per channel, 12 bits over 0–5 V ({Converter().quantum * 1e3:.3f} mV). The thesis prints neither\n"
        "noise nor converter: these are our choice."
    )
    texts = {
        "README.md": _template("raw.md").format(seed=seed, version=ssmr_ident.__version__, floors=_floors()),
        "free_response/README.md": _template("free_response.md").format(
            trials=releases.TRIALS,
            samples=releases.SAMPLES,
            noise=noise,
            modes=_modes(),
            table=_table(truth.lab_robot("frame", "concrete"), truth.true_robot("frame")),
        ),
        "pulls/README.md": _template("pulls.md").format(
            load=truth.LOAD_N,
            weight=float(truth.true_robot("frame")["mass_kg"].value) * 9.8,
            slow=min(pulls.SPIN_RATES),
            fast=max(pulls.SPIN_RATES),
            floors=_floors(),
        ),
    }
    for frame in swivels.FRAMES:
        texts[f"swivel-{frame}/README.md"] = _template("swivel.md").format(
            body="The extended robot (frame, laptop, camera)."
            if frame == "frame"
            else "The bare platform: no frame, no laptop. Its inertia and CoM height are estimates of a box.",
            speeds=", ".join(map(str, swivels.SPEEDS)),
            repeats=f" {swivels.REPEATED} deg/s twice." if frame == "frame" else "",
            noise=noise,
            floors=_floors(),
            table=_table(truth.lab_robot(frame, "concrete"), truth.true_robot(frame)),
        )
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8", newline="\n")


def _template(name: str) -> str:
    return (_TEMPLATES / name).read_text(encoding="utf-8")
