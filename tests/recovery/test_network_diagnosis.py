"""Physics hidden in a network that scipy moves: named, and at the spring or body where it is."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from made_networks import Chain, noisy, pushed, written

from ssmr_ident.doctor.run import diagnose
from ssmr_ident.experiments.campaign import load
from ssmr_ident.session import read_parameters, write_parameters
from ssmr_ident.workflows.compare import compare_session
from ssmr_ident.workflows.diagnose import write_diagnosis

CHAIN = Chain((2.0, 0.8), (9e4, 3e4), (12.0, 4.0))

pytestmark = pytest.mark.slow


def session(folder: Path, chain: Chain, known: Chain, bodies: int) -> Path:
    """Three runs of a chain, of whose bodies the first have sensors."""
    random, runs = np.random.default_rng(4), []
    for _ in range(3):
        time, push = pushed(CHAIN, random, 30.0, 2.0, 600.0)
        motion = chain.motion(time, push, 0, np.zeros(2 * len(chain.masses)))[:, 2, :bodies]
        runs.append((time, push, noisy(motion, 0.01, random)))
    return written(folder, known.known(1.1), runs, 0)


def test_nothing_is_missing(tmp_path: Path) -> None:
    found = diagnose(load(session(tmp_path, CHAIN, CHAIN, 2)))
    assert (found.verdict, found.effects) == ("nothing_missing", ())


def test_a_spring_that_hardens_is_told_from_the_other(tmp_path: Path) -> None:
    cubic = replace(CHAIN, laws={1: lambda s, v: 4e10 * s**3})
    campaign = load(session(tmp_path, cubic, CHAIN, 2))
    found = diagnose(campaign)
    assert [(e.id, e.element) for e in found.effects] == [("nonlinear_stiffness", "s2")]
    k3 = found.effects[0].parameters["k3_N_m3"]
    assert float(k3.value) == pytest.approx(4e10, rel=0.05)
    assert found.heldout.after < 1.5 * found.heldout.noise_floor < 0.2 * found.heldout.before
    write_diagnosis(found, campaign, tmp_path / "out", report=False)
    text = (tmp_path / "out" / "after.yaml").read_text()
    assert "element: s2" in text
    assert read_parameters(tmp_path / "out" / "after.yaml").effects.keys() == {"nonlinear_stiffness@s2"}
    assert compare_session(tmp_path, str(tmp_path / "out" / "after.yaml")).overall["nrmse_percent"] < 2.5


def test_a_body_that_the_file_has_not(tmp_path: Path) -> None:
    """A third mass on the second, without a sensor, and weighed together with it."""
    longer = Chain((*CHAIN.masses, 0.3), (*CHAIN.stiffness, 1.2e4), (*CHAIN.damping, 1.5))
    weighed = replace(CHAIN, masses=(CHAIN.masses[0], CHAIN.masses[1] + 0.3))
    found = diagnose(load(session(tmp_path, longer, weighed, 2)))
    (effect,) = found.effects
    assert (effect.id, effect.kind, effect.element) == ("flexible_mast", "extra_motion", "m2")
    hz = np.sqrt(1.2e4 / 0.3) / (2.0 * np.pi)
    assert float(effect.parameters["f_mast_Hz"].value) == pytest.approx(hz, rel=0.02)
    assert float(effect.parameters["mass_kg"].value) == pytest.approx(0.3, rel=0.1)
    write_parameters(tmp_path / "after.yaml", found.after)
    assert compare_session(tmp_path, str(tmp_path / "after.yaml")).overall["nrmse_percent"] < 2.5
