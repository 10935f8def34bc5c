"""Physics hidden in recordings of a made-up rig, and found again by a diagnosis that is not told of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ssmr_ident.core.atomic import make_folder
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.core.recording import Channel
from ssmr_ident.core.shown import Shown
from ssmr_ident.diagnose.diagnosis import UNIT, Diagnosis
from ssmr_ident.experiments import FREE_RESPONSE, Conditions
from ssmr_ident.experiments.campaign import load
from ssmr_ident.physics.sensor import Noise
from ssmr_ident.readers.writers import write_csv
from ssmr_ident.report.diagnosis_charts import after_name
from ssmr_ident.report.figures_diagnosis import readable
from ssmr_ident.report.numbers import alike, measured, number, share
from ssmr_ident.workflows.diagnose import diagnose, write_diagnosis
from ssmr_ident.workflows.new.run import Told, draft_session
from ssmr_ident.workflows.simulate.request import Request, asked_for, check
from ssmr_ident.workflows.simulate.table import simulated

Progress = Callable[[str, int, int], None]

RIG = ParameterSet(
    "rig",
    {
        "mass_kg": Estimate(2.0, None, "kg"),
        "stiffness_N_m": Estimate(3200.0, None, "N/m"),
        "damping_N_s_m": Estimate(1.2, None, "N s/m"),
    },
    file="the demo's rig",
)
"""A mass on a spring, 6.4 Hz, damping ratio 0.75 %."""

RELEASED_MM = (2.0, 3.0, 4.0, 5.0, 6.0, 7.0)
NOISE = Noise(white=0.05)
"""Of the accelerometer [m/s^2]: a hundredth of the largest acceleration."""

WIDTH = 40
"""Letters of the longest bar."""


@dataclass(frozen=True, eq=False)
class Hidden(Shown):
    """What was hidden, and what came out.

    Parameters
    ----------
    effects : mapping of effect id to parameters
        Hidden; empty hid nothing.
    diagnosis : Diagnosis
    logs, report : Path
        The folder of the recordings, and the page.
    """

    effects: Mapping[str, Mapping[str, Estimate]]
    diagnosis: Diagnosis
    logs: Path
    report: Path

    def as_dict(self) -> dict[str, Any]:
        """For ``--json``."""
        found = self.diagnosis
        hidden = [
            {"id": id, "parameters": {name: float(e.value) for name, e in values.items()}}
            for id, values in self.effects.items()
        ]
        return {"hidden": hidden, "diagnosis": found.as_dict(), "logs": str(self.logs), "report": str(self.report)}

    def __str__(self) -> str:
        return "\n".join((*self._what(), "", *self._how_much(), "", f"report: {self.report}"))

    def _what(self) -> list[str]:
        hidden = [
            ", ".join((id, *(f"{name} = {e.value:g}" for name, e in v.items()))) for id, v in self.effects.items()
        ]
        found = [
            f"{', '.join((e.id, *_measured(e.parameters)))} (probability {share(e.confidence)})"
            for e in self.diagnosis.effects
        ]
        return [
            f"hidden  {'; '.join(hidden) or 'nothing'}",
            f"found   {'; '.join(found) or self.diagnosis.verdict.replace('_', ' ')}",
        ]

    def _how_much(self) -> list[str]:
        """Bars of the error on recordings that were never fitted."""
        quality, of = self.diagnosis.heldout, UNIT[self.diagnosis.metric]
        after = " + ".join(readable(e.id) for e in self.diagnosis.effects) + " added"
        values = {"model before": quality.before}
        if after_name(self.diagnosis):
            values[after] = quality.after
        values["noise alone"] = quality.noise_floor
        largest, texts = max(values.values()), alike(list(values.values()))
        lines = [f"error on {', '.join(quality.recordings)}, which no fit has seen"]
        width = max(map(len, values))
        for (name, value), text in zip(values.items(), texts, strict=True):
            lines.append(f"  {name:<{width}}  {text:>6} {of}  {'█' * max(1, round(WIDTH * value / largest))}")
        return lines


def _measured(parameters: Mapping[str, Estimate]) -> list[str]:
    """What the recordings told of a law."""
    return [
        f"{name} = {measured(float(e.value), e.std, e.unit)}" for name, e in parameters.items() if e.std is not None
    ]


def hide_and_find(hidden: str, output: Path, seed: int, progress: Progress, command: str) -> Hidden:
    """Make recordings with physics in them that no file tells the model of, and diagnose them like any others.

    Parameters
    ----------
    hidden : str
        ``ID:KEY=VALUE,…``; empty hides nothing.
    output : Path
        Gets ``demo-rig`` with the logs and what ``ident new`` writes, and ``demo-diagnosis``.
    seed : int
        Of the noise.
    progress : callable
        Called with the name of a stage, how much of it is done, and of how much.
    command : str
        The call, for the end of the page.

    Raises
    ------
    InputError
        An effect or a parameter that no rig has, or a folder that cannot be written.
    """
    logs, answer = output / "demo-rig", output / "demo-diagnosis"
    effects = asked_for(RIG, Request(FREE_RESPONSE, effects=(hidden,) if hidden else ())).effects
    make_folder(logs)
    _record(hidden, logs, seed, progress)
    for name in ("session.yaml", "rig.yaml"):  # of an earlier run
        (logs / name).unlink(missing_ok=True)
    draft_session(logs, Told(mass=float(RIG["mass_kg"].value))).write()
    campaign = load(logs)
    diagnosis = diagnose(campaign, seed=seed, progress=progress)
    progress("report", 0, 1)
    write_diagnosis(diagnosis, campaign, answer, command, seed)
    progress("report", 1, 1)
    return Hidden(effects, diagnosis, logs, answer / "report.html")


def _record(hidden: str, folder: Path, seed: int, progress: Progress) -> None:
    """An accelerometer's log of the rig let go from each deflection."""
    random = np.random.default_rng(seed)
    for done, deflection in enumerate(RELEASED_MM):
        progress("making recordings", done, len(RELEASED_MM))
        request = Request(
            FREE_RESPONSE,
            Conditions(amplitude_mm=deflection),
            duration_s=4.0,
            rate_hz=200.0,
            effects=(hidden,) if hidden else (),
        )
        check(request)
        exact = simulated(asked_for(RIG, request), request)
        seen = NOISE.add(exact["acceleration"], exact.time, random)
        log = exact.with_channels([Channel("acceleration", seen, "m/s^2")])
        write_csv(folder / f"decay-{number(deflection)}mm.csv", log, decimals=4)
    progress("making recordings", len(RELEASED_MM), len(RELEASED_MM))
