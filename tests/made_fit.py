"""A fit made up for tests of its page: one parameter told by the data, one by the prior, one in conflict."""

from __future__ import annotations

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.identify.lmfit_report import Variable
from ssmr_ident.workflows.fit.result import SessionFit


def made_fit() -> SessionFit:
    """Of a robot; no figures."""
    before = ParameterSet("robot", {"mass_kg": Estimate(31.0, 0.4, "kg"), "tire.mu_static": Estimate(0.86, 0.05, "1")})
    after = before.updated({"mass_kg": Estimate(33.04, 0.02, "kg", "fit")})
    return SessionFit(
        "my-session",
        before,
        after,
        ("mass_kg", "tire.mu_static"),
        ("2 recordings",),
        {"roll-1.csv": ("omega_n 38.8 rad/s",), "roll-2.csv": ("omega_n 38.7 rad/s",)},
        {"roll-1.csv": {}, "roll-2.csv": {}},
        findings=("the mass is not what the scales said",),
        conflicts=({"parameter": "mass_kg", "prior": 31.0, "fitted": 33.04, "sigmas": 5.1},),
        variables=(
            Variable("tire.mu_static", 0.86, 0.05, "1", 0.86, 0.05, "prior"),
            Variable("mass_kg", 33.04, 0.02, "kg", 31.0, 0.4, "data"),
            Variable("offset", 0.1, None, "N"),
        ),
    )
