"""A case recorded: logs in the lab's own formats, what the lab knows, and the truth."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from ssmr_ident.core.atomic import write_text
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.experiments import EXPERIMENTS
from ssmr_ident.readers.writers import write_csv, write_labview_xlsx, write_lvm, write_mtestquattro
from ssmr_ident.session import write_parameters
from ssmr_proof.drawn.cases import Case
from ssmr_proof.drawn.hidden import Hidden
from ssmr_proof.lab.decays import Programme, decays
from ssmr_proof.lab.logs import Log
from ssmr_proof.lab.pulls import TESTS, Test, pulls
from ssmr_proof.lab.rigs import RUNS, Run, rigs
from ssmr_proof.lab.robots import draw_rig, draw_robot


@dataclass(frozen=True)
class Extent:
    """How much is recorded of each family; the default has the extent of a campaign."""

    decays: Programme = field(default_factory=Programme)
    pulls: tuple[Test, ...] = TESTS
    runs: tuple[Run, ...] = RUNS
    run_seconds: float = 8.0


SMALL = Extent(
    Programme(("roll", "roll", "pitch", "pitch", "yaw", "yaw"), ("roll", "pitch", "yaw"), 2048),
    tuple(test for test in TESTS if test.speed > 0.5),
    RUNS[1:4] + RUNS[6:],
    4.0,
)


@dataclass(frozen=True, eq=False)
class Recorded:
    """A case with its logs.

    Parameters
    ----------
    case : Case
        With the effects as recorded: a clipping sensor has its range by now.
    logs : tuple of Log
    known : ParameterSet
        The lab's robot.yaml.
    true : mapping of str to float
        The robot's or the rig's numbers.
    """

    case: Case
    logs: tuple[Log, ...]
    known: ParameterSet
    true: Mapping[str, float]

    def truth(self) -> dict[str, Any]:
        """The answer, as JSON knows it."""
        case = self.case
        floors = [log.noise_floor() for log in self.logs if log.heldout]
        return {
            "case": case.name,
            "family": case.family,
            "kind": case.kind,
            "trap": case.trap,
            "verdict": "missing_physics" if case.effects else "nothing_missing",
            "effects": [effect.as_dict() for effect in case.effects],
            "metric": "nrmse_percent",
            "heldout": {"noise_floor": float(np.mean(floors)), "noise_floors": floors},
            "true_robot": dict(self.true),
        }

    def truth_text(self) -> str:
        return json.dumps(self.truth(), indent=1, sort_keys=True)


def record(case: Case, extent: Extent | None = None) -> Recorded:
    """Run the plant of a case through its experiments."""
    extent = extent or Extent()
    random = case.random
    biased = case.trap == "priors"
    if case.family == "rig":
        rig = draw_rig(random, biased)
        logs = rigs(case, rig, random, extent.runs, extent.run_seconds)
        known, true = rig.known, rig.true
    else:
        drawn = draw_robot(random, biased)
        if case.family == "decay":
            logs = decays(case, drawn, random, extent.decays)
        else:
            logs = pulls(case, drawn, random, extent.pulls)
        known, true = drawn.known, drawn.true
    return Recorded(_with_range(case, logs), tuple(logs), known, true)


def write_session(recorded: Recorded, folder: Path, heldout: bool) -> None:
    """Write the recordings to be explained, or those held out, as a session folder of their own.

    Names tell motion and number, as a lab's do; nothing tells what is hidden.
    """
    folder.mkdir(parents=True)
    case = recorded.case
    plain = bool(np.random.default_rng([case.seed, case.number, 2]).integers(2))
    entries = []
    for log in recorded.logs:
        if log.heldout == heldout:
            file = _write_log(log, folder, plain)
            entries.append({"file": file, **log.entry, **({"role": "heldout"} if heldout else {})})
    baseline = {"rig": "sdof", "decay": "decoupled" if case.decoupled else "rigid6"}.get(case.family, "rigid6")
    head = {"schema": "ssmr-ident/session/1", "name": case.name, "robot": "robot.yaml", "baseline": baseline}
    text = yaml.safe_dump({**head, "recordings": entries}, sort_keys=False)
    write_text(folder / "session.yaml", text)
    write_parameters(folder / "robot.yaml", recorded.known)


def _write_log(log: Log, folder: Path, plain: bool) -> str:
    experiment = EXPERIMENTS[log.entry["experiment"]]
    if experiment.driven:
        file = f"{log.stem}.csv"
        write_csv(folder / file, log.recording, decimals=8 if "position" in log.names else 4)
    elif experiment.on_a_testing_machine:
        file = f"{log.stem}.{'txt' if plain else 'csv'}"
        facts = {} if plain else {"Sample": "1", "Procedure": "Pull", "Operator": "lab"}
        write_mtestquattro(folder / file, log.recording, style="tab" if plain else "csv", facts=facts)
    elif plain:
        file = f"{log.stem}.lvm"
        write_lvm(folder / file, log.recording, operator="lab")
    else:
        file = f"{log.stem}.xlsx"
        write_labview_xlsx(folder / file, log.recording)
    return file


def _with_range(case: Case, logs: list[Log]) -> Case:
    """The range at which the logs clip, for the truth."""
    effects: list[Hidden] = []
    for effect in case.effects:
        if effect.id == "sensor_saturation":
            level = max(float(np.abs(log.clean).max()) for log in logs)
            effect = replace(effect, parameters={"range_N" if case.family == "pull" else "range_m_s2": level})
        effects.append(effect)
    return replace(case, effects=tuple(effects))
