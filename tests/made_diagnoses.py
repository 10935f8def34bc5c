"""Diagnoses made up for tests of the page: decays, a clean session, a tie on a rig, a swivel."""

from __future__ import annotations

from functools import cache

import numpy as np
from scipy.integrate import solve_ivp

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.diagnose.diagnosis import Conflict, Diagnosis, KindShare, Located, NamedEffect, PredictionQuality, Tried
from ssmr_ident.diagnose.evidence import Drift, Evidence, ForceSurface, Overlay, ResidualMap, SpeedMap

K, MASS, DAMPING, CUBIC = 18000.0, 22.0, 25.0, 3.1e8
RATE = 400.0


def hardening() -> Diagnosis:
    """Missing physics, named: tires that stiffen."""
    before = _robot(
        {"tire.stiffness_y_N_m": Estimate(24100.0, 90.0, "N/m"), "inertia_kg_m2.xx": Estimate(1.94, 0.02, "kg m^2")}
    )
    after = _robot(
        {"tire.stiffness_y_N_m": Estimate(18130.0, 210.0, "N/m"), "inertia_kg_m2.xx": Estimate(1.22, 0.02, "kg m^2")},
        {"nonlinear_stiffness": {"k3_N_m3": Estimate(3.104e8, 0.21e8, "N/m^3")}},
    )
    return Diagnosis(
        "extended-robot-free-response",
        "missing_physics",
        (
            Located(
                "roll-2.xlsx",
                "ay",
                (0.0, 0.62),
                (5.0, 8.0),
                "|roll| > 1.5 deg",
                0.81,
                "81 % of the misfit sits in the first 0.62 s of roll, at 5 to 8 Hz, where the roll exceeds 1.5°.",
            ),
            Located("pitch-1.xlsx", "ax", (0.0, 0.40), (6.1, 9.0), "|pitch| > 0.9 deg", 0.11),
        ),
        (
            Conflict("inertia_kg_m2.xx", 1.21, 1.94, 14.6, "kg m^2"),
            Conflict("tire.stiffness_y_N_m", 18000.0, 24100.0, 1.7, "N/m"),
        ),
        (
            NamedEffect(
                "nonlinear_stiffness",
                "The tires stiffen as they are pressed.",
                "F = K·s + k3·s³",
                {"k3_N_m3": Estimate(3.104e8, 0.21e8, "N/m^3")},
                0.99,
                (),
                "cubic",
            ),
        ),
        _tried("nonlinear_stiffness", 5228.4, 3.4, 22.0),
        "nrmse_percent",
        PredictionQuality(21.4, 3.2, 2.9, ("roll-1.xlsx", "roll-2.xlsx")),
        PredictionQuality(22.0, 3.4, 2.9, ("roll-3.xlsx", "pitch-3.xlsx"), (17.1, 20.2)),
        "",
        before,
        after,
        "The tires stiffen as they are pressed (F = K·s + k3·s³): on held-out decays the model is 22.0 % away without "
        "it, 3.4 % with it; noise alone leaves 2.9 %.",
        ("pitch-2.xlsx is clipped from 0.00 to 0.05 s; this stretch was left out.",),
        Evidence(
            tuple(
                _overlay(f"{m}-3.xlsx", c, k, True)
                for k, (m, c) in enumerate((("roll", "ay"), ("roll", "az"), ("pitch", "ax")))
            ),
            (_map(11.0),),
            (_surface(CUBIC),),
            (_drift("tire.stiffness_y_N_m", 0.34, 0.002), _drift("tire.damping_y_N_s_m", 0.0, 0.41)),
            (),
            {"baseline": 3.1, "scores": 0.8, "refits": 5.4},
        ),
    )


def nothing() -> Diagnosis:
    """The baseline explains everything down to its noise."""
    same = _robot({"tire.stiffness_y_N_m": Estimate(18040.0, 95.0, "N/m")})
    worth = PredictionQuality(2.95, 2.95, 2.91, ("roll-3.xlsx", "yaw-2.xlsx"))
    return Diagnosis(
        "platform-free-response",
        "nothing_missing",
        (),
        (Conflict("tire.stiffness_y_N_m", 18000.0, 18040.0, 0.1, "N/m"),),
        (),
        (Tried("baseline", 2.95, 0.0), Tried("dry_friction", 2.96, -4.1), Tried("nonlinear_stiffness", 2.95, -3.3)),
        "nrmse_percent",
        worth,
        worth,
        "",
        same,
        same,
        "The model explains the recordings down to their noise: 2.95 % on held-out decays, 2.91 % of it noise.",
        ("Dry friction below 0.4 N per tire would not have been seen.",),
        Evidence(
            (_overlay("roll-3.xlsx", "ay", 0, True, 0.0), _overlay("yaw-2.xlsx", "ax", 1, True, 0.0)),
            (_map(0.0),),
            (_surface(0.0),),
            (_drift("tire.stiffness_y_N_m", 0.0, 0.64),),
        ),
    )


def undetermined() -> Diagnosis:
    """Two explanations fit alike; an experiment is proposed. A single recording, no interval."""
    rig = {"stiffness_N_m": Estimate(2010.0, 11.0, "N/m"), "damping_N_s_m": Estimate(4.1, 0.4, "N s/m")}
    before = ParameterSet("rig", rig)
    after = ParameterSet("rig", rig, {"quadratic_damping": {"d2_N_s2_m2": Estimate(8.1, None, "N s^2/m^2")}})
    return Diagnosis(
        "rig-forced",
        "undetermined",
        (Located("shaker-1.csv", "acceleration", (2.0, 9.5), (3.0, 12.0), "|v| > 0.2 m/s", 0.64),),
        (Conflict("damping_N_s_m", 2.0, 4.1, 4.2, "N s/m"),),
        (
            NamedEffect(
                "quadratic_damping",
                "Damping grows with the square of the speed.",
                "F = d2·v·|v|",
                {"d2_N_s2_m2": Estimate(8.1, None, "N s^2/m^2")},
                0.52,
                ("dry_friction", "hysteresis"),
                kind="static_force",
                element="spring",
                curve={"variable": "displacement [m]", "points": [0.0, 0.1], "force": [0.0, 2.0], "std": [0.0, 0.1]},
            ),
        ),
        _tried("quadratic_damping", 41.3, 6.1, 9.8, "dry_friction", "hysteresis"),
        "nrmse_percent",
        PredictionQuality(9.2, 5.8, 4.9, ("shaker-1.csv",)),
        PredictionQuality(9.8, 6.1, 4.9, ("shaker-2.csv",)),
        "Sweep the force slowly from 1 N to 12 N at 4 Hz, 3 repeats: quadratic damping and dry friction then differ by "
        "18 % of the response, enough to tell them apart 95 times in 100.",
        before,
        after,
        "Something takes energy out of the rig; quadratic damping, dry friction and hysteresis fit alike.",
        (),
        Evidence((_overlay("shaker-2.csv", "acceleration", 3, True, 0.2, 60.0),), (_map(6.0),), (), ()),
        (KindShare("static_force", "spring", 0.94, 1210.0), KindShare("memory", "spring", 0.9, 1140.0)),
    )


def swivel() -> Diagnosis:
    """Spectra over speed: a wheel out of round."""
    parameters = _robot({"tire.mu_kinetic": Estimate(0.71, 0.01, "1")})
    effect = {"wheel_eccentricity": {"eccentricity_m": Estimate(1.1e-3, 0.9e-4, "m")}}
    return Diagnosis(
        "swivel-carpet",
        "missing_physics",
        (
            Located(
                "v0-w60-t20-frame-carpet.xlsx",
                "az",
                (0.0, 20.0),
                (1.9, 2.3),
                "at the wheel's turning rate",
                0.57,
                "A line in az follows the wheel's turning rate through all seven speeds.",
            ),
        ),
        (),
        (
            NamedEffect(
                "wheel_eccentricity",
                "A wheel is out of round and lifts the robot once a turn.",
                "h = e·cos φ",
                effect["wheel_eccentricity"],
                0.97,
            ),
        ),
        _tried("wheel_eccentricity", 212.0, 2.1, 5.2),
        "log_psd_db",
        PredictionQuality(5.0, 1.9, 1.6),
        PredictionQuality(5.2, 2.1, 1.6, ("v0-w45-t20-frame-carpet.xlsx",)),
        "",
        parameters,
        _robot({"tire.mu_kinetic": Estimate(0.70, 0.01, "1")}, effect),
        "A wheel is out of round: held-out swivels are 5.2 dB away without it, 2.1 dB with it; noise leaves 1.6 dB.",
        (),
        Evidence((), (), (), (), (_speeds("az"), _speeds("ay"))),
    )


EVERY = (hardening, nothing, undetermined, swivel)


def _robot(changed: dict[str, Estimate], effects: dict | None = None) -> ParameterSet:
    return ParameterSet("robot", {"mass_kg": Estimate(22.3, 0.1, "kg", fixed=True), **changed}, effects or {})


def _tried(best: str, evidence: float, metric: float, baseline: float, *tied: str) -> tuple[Tried, ...]:
    others = (
        "dry_friction",
        "free_play",
        "quadratic_damping",
        "hysteresis",
        "sensor_bandwidth",
        "unlisted",
        "com_offset",
    )
    tried = [Tried(best, metric, evidence), *(Tried(id, metric + 0.1, evidence - 0.8) for id in tied)]
    others = tuple(id for id in others if id not in (best, *tied))
    for rank, id in enumerate(others, 1):
        share = 0.8 / rank
        tried.append(Tried(id, baseline - share * (baseline - metric), evidence * share - 3.0))
    tried.append(Tried(f"{best}+free_play", metric - 0.02, evidence - 2.9))
    return (*tried, Tried("baseline", baseline, 0.0))


@cache
def _motion(cubic: float, release: float, seconds: float = 2.5) -> tuple[np.ndarray, np.ndarray]:
    """Displacement and velocity of a mass on a spring, let go at ``release`` [m]."""
    time = np.arange(0, seconds, 1 / RATE)

    def change(_: float, x: np.ndarray) -> list[float]:
        return [x[1], -(K * x[0] + cubic * x[0] ** 3 + DAMPING * x[1]) / MASS]

    motion = solve_ivp(change, (0, seconds), [release, 0.0], t_eval=time, method="DOP853", rtol=1e-8, atol=1e-10).y
    return time, motion


def _overlay(
    recording: str, channel: str, seed: int, heldout: bool, cubic: float = CUBIC, seconds: float = 2.5
) -> Overlay:
    random = np.random.default_rng(seed)
    time, exact = _motion(cubic, 0.006, seconds)
    _, plain = _motion(0.0, 0.006, seconds)
    scale = K / MASS
    measured = -scale * exact[0] + 0.05 * random.standard_normal(len(time))
    after = -scale * exact[0]
    before = -scale * plain[0] if cubic else after
    return Overlay(recording, channel, "m/s^2", heldout, time + 12.0, measured, before, after, (22.0 - seed, 3.4, 2.9))


def _map(excess: float) -> ResidualMap:
    random = np.random.default_rng(3)
    time, frequency = np.linspace(12.05, 14.45, 49), np.linspace(1, 50, 50)
    noise = 10 * np.log10(random.chisquare(8, (50, 49)) / 8)
    patch = excess * np.exp(-(((frequency[:, None] - 6.5) / 3) ** 2) - (((time - 12.0) / 0.7) ** 2))
    return ResidualMap("roll-2.xlsx", "ay", time, frequency, noise + patch, noise, 6.2)


def _surface(cubic: float) -> ForceSurface:
    _, (displacement, velocity) = _motion(CUBIC, 0.006)
    noise = 0.9 * np.random.default_rng(4).standard_normal(len(displacement))
    return ForceSurface(
        "roll-2.xlsx", "lateral deflection of the tires", displacement, velocity, noise - cubic * displacement**3, noise
    )


def _drift(parameter: str, slope: float, p_value: float) -> Drift:
    position = np.array([0.4, 0.9, 1.6, 2.4, 3.5, 4.8])
    value = 1 + slope * (position / position.max()) ** 2 - slope / 3 + 0.01 * np.array([1, -1, 0.5, -0.4, 0.8, -1])
    reading = "Stiffer at larger amplitudes: the spring hardens." if slope else ""
    return Drift(parameter, "amplitude", "mm", position, value, np.full(6, 0.02), p_value, reading)


def _speeds(channel: str) -> SpeedMap:
    random = np.random.default_rng(7)
    speed = np.deg2rad([15, 30, 45, 60, 75, 90, 105.0])
    frequency = np.arange(1.0, 50.0)
    wheel = speed * 0.26 / 0.11 / (2 * np.pi) * 6
    broad = -20 - 0.25 * frequency + 12 * np.exp(-(((frequency - 8) / 2) ** 2)) + 6 * speed[:, None]
    line = 14 * np.exp(-(((frequency - wheel[:, None]) / 1.0) ** 2))
    recorded = broad + line + random.standard_normal(broad.shape)
    return SpeedMap(
        channel,
        speed,
        frequency,
        recorded,
        broad,
        broad + line,
        (("wheel's turning rate × 6", wheel), ("roll, 8 Hz", np.full(7, 8.0))),
    )
