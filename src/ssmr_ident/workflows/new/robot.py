"""A parameter file to start from: what the logs tell at first sight, and a question for everything else."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.core.place import Place
from ssmr_ident.session import read_parameters
from ssmr_ident.session.parameters_text import parameters_text
from ssmr_ident.session.schema import KEYS
from ssmr_ident.workflows.new.log import LogGuess

QUESTIONS = {
    "mass_kg": "weigh it",
    "inertia_kg_m2.xx": "from CAD, or from `ident geometry` (weighings and a list of parts)",
    "inertia_kg_m2.yy": "likewise",
    "inertia_kg_m2.zz": "likewise",
    "contact_points_m": "four rows [x, y, z] from the centre of mass: rear left, front left, front right, rear right",
    "accelerometer.position_m": "[x, y, z] from the centre of mass, x forward, y left, z up",
    "accelerometer.volts_zero": "reading without acceleration, by the data sheet",
    "accelerometer.volts_per_m_s2": "sensitivity, by the data sheet",
    "tire.radius_m": "of the wheels",
}


def robot_text(name: str, template: str, guesses: Sequence[LogGuess], answers: Mapping[str, Any] | None = None) -> str:
    """robot.yaml of a robot: a bundled one's values where ``template`` names it, else questions.

    What the logs do not need is not asked for: the sensor's place without accelerations, its volts without volts.

    Raises
    ------
    InputError
        An unknown template.
    """
    known = read_parameters(template or "p3at-extended")
    units = {c.unit for guess in guesses if guess.kind == "robot" for c in guess.recording.channels}
    asked = set(QUESTIONS) - (set() if units else {"accelerometer.position_m"})
    asked -= set() if "V" in units else {"accelerometer.volts_zero", "accelerometer.volts_per_m_s2"}
    changes = {}
    answers = answers or {}
    for key, estimate in known.estimates.items():
        if key in answers:
            changes[key] = replace(
                estimate,
                value=KEYS[key].domain.check(Place("--set", (key,)), answers[key]),
                std=None,
                source="given to ident new",
            )
        elif template:
            changes[key] = replace(estimate, source=f"{template}: {estimate.source}" if estimate.source else template)
        elif key in asked:
            changes[key] = replace(estimate, value=math.nan, std=None, source="")
        elif key.startswith("inertia"):
            changes[key] = replace(estimate, value=0.0, std=None, source="taken as symmetric")
        elif key.startswith(("accelerometer.", "noise.")):
            changes[key] = replace(estimate, std=None, source="the p3at's sensor: see your data sheet")
        elif not estimate.fixed:
            changes[key] = replace(estimate, std=None, source="the p3at's: a start for the fit, no knowledge")
    text = parameters_text(ParameterSet(name, {**known.estimates, **changes}))
    head = [
        "# Written by `ident new`. std is the standard deviation that you believe in; left out, it means unknown, and",
        "# the fit starts from the value without being held by it. fixed: true leaves a value alone.",
        f"# Values of the bundled robot {template}: replace what you know of yours."
        if template
        else "# A line that says TODO needs a number. `ident new --robot p3at-extended` starts from that robot's.",
    ]
    return "\n".join([*head, ""]) + _asked(text)


def _asked(text: str) -> str:
    """NaN becomes TODO with a question."""
    lines = []
    for line in text.splitlines():
        if "value: nan" in line:
            key = line.split(":", 1)[0].strip()
            question = next(q for path, q in QUESTIONS.items() if path.rsplit(".", 1)[-1] == key)
            unit = line.split("unit: ", 1)[1].split('"')[1]
            line = f'{line.split("{", 1)[0]}{{value: TODO, unit: "{unit}"}}  # {question}'
        lines.append(line)
    return "\n".join(lines) + "\n"
