"""The reference campaign's swivels against what a lab knows, law by law: distance [dB] and amplitude of a_y [m/s^2].

    python benchmarks/swivel_mismatch.py

The table of docs/theory/swivel_mismatch.md.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from ssmr_ident.compare.comparison import measure
from ssmr_ident.compare.turning import predict
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.experiments.campaign import load_logs
from ssmr_ident.session import read_parameters, read_session
from ssmr_ident.signals.filters import low_pass

RAW = Path(__file__).resolve().parents[1] / "data" / "raw"
SPEEDS = (10, 30, 60)  # deg/s
FLAT = {"floor.height_m": Estimate(0.0, None, "m", fixed=True)}


def under(parameters: ParameterSet, law: str) -> ParameterSet:
    return replace(parameters, choices={"tire.contact": law})


def amplitude(samples: np.ndarray, sample_rate: float) -> float:
    """Half of what the motion below 50 Hz spans, as the thesis takes it."""
    return float(np.ptp(low_pass(samples - samples.mean(), sample_rate, 50.0))) / 2.0


if __name__ == "__main__":
    for frame in ("frame", "platform"):
        for floor in ("concrete", "tile", "carpet"):
            path = RAW / f"swivel-{frame}" / f"{floor}.yaml"
            session = read_session(path)
            kept = tuple(e for e in session.entries if e.yaw_rate_deg_s in SPEEDS and e.trial == 1)
            campaign = load_logs(replace(session, entries=kept))
            lab, truth = campaign.parameters, read_parameters(path.with_name(f"truth-{floor}.yaml"))
            limit = {**FLAT, "tire.lambda_max": truth["tire.lambda_max"]}
            models = {
                "cone": under(lab, "cone"),
                "relay": under(lab.updated(FLAT), "relay"),
                "relay, lambda_max of the truth": under(lab.updated(limit), "relay"),
                "truth": truth,
            }
            for m in campaign.measurements:
                said = []
                for name, parameters in models.items():
                    found = predict(parameters, m)
                    size = amplitude(found.simulated[:, 1], found.sample_rate)
                    said.append(f"{name}: {measure(found)[0]:.1f} dB, {size:.2f}")
                size = amplitude(found.measured[:, 1], found.sample_rate)
                print(
                    f"{frame} {floor} {m.entry.yaw_rate_deg_s:g} deg/s: recorded {size:.2f}",
                    *said,
                    sep="; ",
                    flush=True,
                )
