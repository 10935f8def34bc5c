"""Networks: what a file may say, the linear motion against closed forms and scipy, and parameters that come back."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import jsonschema
import numpy as np
import pytest
import yaml
from made_networks import Chain, noisy, pushed, write_log, write_session, written

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import Estimate
from ssmr_ident.estimate.network import bare
from ssmr_ident.estimate.node import stepped
from ssmr_ident.estimate.pieces import Seen
from ssmr_ident.experiments import EXPERIMENTS, Conditions
from ssmr_ident.experiments.campaign import load
from ssmr_ident.physics.network import network_from_parameters
from ssmr_ident.session import read_parameters, write_parameters
from ssmr_ident.session.json_schema import parameters_schema
from ssmr_ident.workflows.compare import compare_session
from ssmr_ident.workflows.fit.run import fit_session
from ssmr_ident.workflows.simulate.request import Request
from ssmr_ident.workflows.simulate.run import simulate_to_file

CHAIN = Chain((2.0, 0.4), (9e4, 7e3), (12.0, 0.8))
TEXT = """schema: ssmr-ident/parameters/1
bodies:
  table: {mass_kg: {value: 2.0, std: 0.02}}
  tip: {mass_kg: {value: 0.4}}
springs:
  foot: {between: [ground, table], stiffness_N_m: {value: 9.0e4}, damping_N_s_m: {value: 12}}
  blade: {between: [table, tip], stiffness_N_m: {value: 7.0e3}, damping_N_s_m: {value: 0.8}}
"""


def read(folder: Path, text: str):
    (folder / "rig.yaml").write_text(text)
    return read_parameters(folder / "rig.yaml")


def test_a_file_comes_back_bit_for_bit(tmp_path: Path) -> None:
    first = read(tmp_path, TEXT.replace("tip", "on_off"))
    write_parameters(tmp_path / "again.yaml", first)
    again = read_parameters(tmp_path / "again.yaml")
    assert (again.estimates, again.between) == (first.estimates, first.between)
    jsonschema.validate(yaml.safe_load((tmp_path / "again.yaml").read_text()), parameters_schema())


def test_an_effect_at_two_springs_is_a_list(tmp_path: Path) -> None:
    laws = {
        "nonlinear_stiffness@foot": {"k3_N_m3": Estimate(1e9, 1e7, "N/m^3")},
        "nonlinear_stiffness@blade": {"k3_N_m3": Estimate(2e9, None, "N/m^3")},
        "dry_friction@blade": {"F_c_N": Estimate(0.5, None, "N")},
    }
    write_parameters(tmp_path / "rig.yaml", replace(read(tmp_path, TEXT), effects=laws))
    content = yaml.safe_load((tmp_path / "rig.yaml").read_text())
    assert [one["element"] for one in content["effects"]["nonlinear_stiffness"]] == ["foot", "blade"]
    jsonschema.validate(content, parameters_schema())
    assert read_parameters(tmp_path / "rig.yaml").effects == laws


WRONG = {
    "which is no body": ("[table, tip]", "[table, tipp]"),
    "is held to nothing else": ("[table, tip]", "[ground, table]"),
    "what the bodies stand on": ("tip: {mass", "ground: {mass"),
    "is missing": (", damping_N_s_m: {value: 0.8}", ""),
    "is of the other kind of network": ("damping_N_s_m: {value: 0.8}", "damping_N_m_s_rad: {value: 0.8}"),
    "mixes mass_kg and inertia_kg_m2": ("tip: {mass_kg", "tip: {inertia_kg_m2"),
    "Add fixed: true": ("{value: 7.0e3}", "{value: 0}"),
    "something stands twice": ("[table, tip]", "[tip, tip]"),
    "stands beside bodies": ("bodies:", "mass_kg: 3\nbodies:"),
    "expected a name": ("tip:", "2nd tip:"),
    "has bodies": (TEXT[TEXT.index("springs") :], ""),
}


@pytest.mark.parametrize("problem", WRONG)
def test_what_no_network_is(tmp_path: Path, problem: str) -> None:
    with pytest.raises(InputError, match=problem) as refused:
        read(tmp_path, TEXT.replace(*WRONG[problem]))
    assert str(refused.value).startswith(f"{tmp_path / 'rig.yaml'}")


CHANNELS = {
    "is 'tup', which is no body": "acceleration: {column: a, body: tup}, force: {column: F, body: tip}",
    "names no body": "acceleration: {column: a, body: tip}, force: F",
}


@pytest.mark.parametrize("problem", CHANNELS)
def test_a_channel_belongs_to_a_body(tmp_path: Path, problem: str) -> None:
    write_log(tmp_path / "a.csv", np.arange(9.0), {"a [m/s^2]": np.arange(9.0), "F [N]": np.arange(9.0)})
    known = read(tmp_path, TEXT)
    entry = f"{{file: a.csv, experiment: forced, channels: {{{CHANNELS[problem]}}}}}"
    with pytest.raises(InputError, match=problem):
        load(write_session(tmp_path, known, [entry]))
    with pytest.raises(InputError, match="bodies:"):
        load(write_session(tmp_path, known, [entry], baseline="sdof"))


def test_eigenvalues_of_two_masses(tmp_path: Path) -> None:
    """Roots of the characteristic polynomial, written out by hand."""
    network = network_from_parameters(read(tmp_path, TEXT))
    m1, m2, c1, k1, c2, k2 = network.values
    polynomial = np.polymul([m1, c1 + c2, k1 + k2], [m2, c2, k2])
    polynomial[-3:] -= np.polymul([c2, k2], [c2, k2])
    roots = np.roots(polynomial)
    roots = roots[roots.imag > 0][np.argsort(np.abs(roots[roots.imag > 0]))]
    hz, ratio, shapes = network.modes()
    np.testing.assert_allclose(hz, np.abs(roots) / (2 * np.pi), rtol=1e-9)
    np.testing.assert_allclose(ratio, -roots.real / np.abs(roots), rtol=1e-7)
    # the tip over the table, by the second row of the equations
    follows = (c2 * roots + k2) / (m2 * roots**2 + c2 * roots + k2)
    np.testing.assert_allclose(shapes[1] / shapes[0], follows.real, rtol=1e-4)


def simulated(folder: Path, experiment: str, at: str, **options: str) -> np.ndarray:
    request = Request(EXPERIMENTS[experiment], Conditions(at=at), **options)
    recording = simulate_to_file(str(folder / "rig.yaml"), request, folder / f"{experiment}-{at}.csv")
    names = [n for n in recording.names if n not in ("force", "base_position")]
    return np.stack([recording[name] for name in names], axis=1)


def test_the_motion_is_that_of_an_integrator(tmp_path: Path) -> None:
    write_parameters(tmp_path / "rig.yaml", CHAIN.known())
    time, push = pushed(CHAIN, np.random.default_rng(2), 20.0, 0.1, 2000.0)
    write_log(tmp_path / "F.csv", time, {"force [N]": push})
    chain = Chain(CHAIN.masses, CHAIN.stiffness, tuple(2.0 * c for c in CHAIN.damping))
    exact = chain.motion(time, push, 1, np.zeros(4)).transpose(0, 2, 1).reshape(len(time), -1)
    found = simulated(tmp_path, "forced", "m2", force=str(tmp_path / "F.csv"))
    assert np.abs(found - exact).max(axis=0) == pytest.approx(np.zeros(6), abs=2e-3 * np.abs(exact).max())


def test_a_law_at_a_spring_moves_as_an_integrator_says(tmp_path: Path) -> None:
    known = CHAIN.known()
    law = {"nonlinear_stiffness@s2": {"k3_N_m3": Estimate(2e9, None, "N/m^3")}}
    write_parameters(tmp_path / "rig.yaml", replace(known, effects=law))
    time, push = pushed(CHAIN, np.random.default_rng(2), 60.0, 0.1, 2000.0)
    write_log(tmp_path / "F.csv", time, {"force [N]": push})
    plain = Chain(CHAIN.masses, CHAIN.stiffness, tuple(2.0 * c for c in CHAIN.damping))
    chain = replace(plain, laws={1: lambda s, v: 2e9 * s**3})
    exact, linear = (
        c.motion(time, push, 1, np.zeros(4)).transpose(0, 2, 1).reshape(len(time), -1) for c in (chain, plain)
    )
    found = simulated(tmp_path, "forced", "m2", force=str(tmp_path / "F.csv"))
    assert np.abs(found - exact).max() < 2e-3 * np.abs(exact).max()
    assert np.abs(linear - exact).max() > 0.1 * np.abs(exact).max()


@pytest.mark.parametrize("law", ["hysteresis:alpha=0.5,yield_m=2e-4", "viscoelastic_relaxation:K_m_N_m=2e4,tau_s=0.02"])
def test_a_network_of_one_body_is_a_rig(tmp_path: Path, law: str) -> None:
    """What remembers, by the loop that fits and by the rig's own simulator."""
    time, push = pushed(CHAIN, np.random.default_rng(2), 60.0, 0.3, 2000.0)
    write_log(tmp_path / "F.csv", time, {"force [N]": push})
    rig = "mass_kg: {value: 2.0}\nstiffness_N_m: {value: 9.0e4}\ndamping_N_s_m: {value: 12}\n"
    read(tmp_path, f"schema: ssmr-ident/parameters/1\n{rig}")
    alone = simulated(tmp_path, "forced", "", force=str(tmp_path / "F.csv"), effects=(law,))
    effect, pairs = law.split(":")
    values = ", ".join(f"{name}: {{value: {value}}}" for name, value in (pair.split("=") for pair in pairs.split(",")))
    one = TEXT[: TEXT.index("  tip")] + TEXT[TEXT.index("springs") : TEXT.index("  blade")]
    read(tmp_path, f"{one}effects:\n  {effect}: {{element: foot, {values}}}\n")
    found = simulated(tmp_path, "forced", "", force=str(tmp_path / "F.csv"))
    assert np.abs(found - alone).max() < 2e-3 * np.abs(alone).max()


WRONG_EFFECTS = {
    "which is no spring": "nonlinear_stiffness: {element: blad, k3_N_m3: {value: 1}}",
    "acts at no spring": "nonlinear_stiffness: {k3_N_m3: {value: 1}}",
    "act at blade and foot": "nonlinear_stiffness: [{element: blade, k3_N_m3: {value: 1}}, {element: foot}]",
    "stands twice": "nonlinear_stiffness: [{element: blade, k3_N_m3: {value: 1}}, {element: blade}]",
}


@pytest.mark.parametrize("problem", WRONG_EFFECTS)
def test_effects_say_where_they_act(tmp_path: Path, problem: str) -> None:
    (tmp_path / "rig.yaml").write_text(TEXT + f"effects:\n  {WRONG_EFFECTS[problem]}\n")
    with pytest.raises(InputError, match=problem):
        simulated(tmp_path, "free_response", "tip")


def test_what_pushes_at_one_and_is_felt_at_the_other_may_be_exchanged(tmp_path: Path) -> None:
    """Maxwell and Betti's reciprocity."""
    read(tmp_path, TEXT)
    time, push = pushed(CHAIN, np.random.default_rng(2), 20.0, 0.4, 1000.0)
    write_log(tmp_path / "F.csv", time, {"force [N]": push})
    first, second = (simulated(tmp_path, "forced", at, force=str(tmp_path / "F.csv")) for at in ("table", "tip"))
    np.testing.assert_allclose(first[:, 3:], second[:, :3], atol=1e-9 * np.abs(first).max())
    assert np.abs(first[:, :3] - second[:, 3:]).max() > 0.1 * np.abs(first).max()


def test_without_dampers_energy_stays(tmp_path: Path) -> None:
    read(tmp_path, TEXT.replace("value: 12", "value: 0").replace("value: 0.8", "value: 0"))
    q1, v1, _, q2, v2, _ = simulated(tmp_path, "free_response", "tip").T
    energy = 0.5 * (2.0 * v1**2 + 0.4 * v2**2 + 9e4 * q1**2 + 7e3 * (q2 - q1) ** 2)
    assert q2[0] == pytest.approx(3e-4)
    np.testing.assert_allclose(energy, energy[0], rtol=1e-9)


def test_a_shaken_foot_pushes_through_its_spring(tmp_path: Path) -> None:
    read(tmp_path, TEXT)
    time = np.arange(800) / 2000.0
    base, rate = (f(2 * np.pi * 15 * time) * np.hanning(800) for f in (np.sin, np.cos))
    base = 1e-3 * base
    rate = np.gradient(base, time, edge_order=2)
    write_log(tmp_path / "B.csv", time, {"base_position [m]": base})
    write_log(tmp_path / "F.csv", time, {"force [N]": 9e4 * base + 12.0 * rate})
    shaken = simulated(tmp_path, "base_motion", "", base=str(tmp_path / "B.csv"))
    moved = simulated(tmp_path, "forced", "table", force=str(tmp_path / "F.csv"))
    assert np.abs(shaken - moved).max(axis=0) == pytest.approx(np.zeros(6), abs=2e-3 * np.abs(moved).max())


@pytest.mark.slow
def test_a_fit_finds_stiffness_that_nobody_knew(tmp_path: Path) -> None:
    random, known = np.random.default_rng(5), CHAIN.known(off=1.4)
    network = network_from_parameters(CHAIN.known())
    network.values[[2, 4]] = CHAIN.damping
    seen = Seen((2, 2), (0, 1), False, 0)
    (transition, now, later, *_), (rows, by_drive, *_) = stepped(bare(network), network.values, seen, 1.0 / 500.0)
    runs = []
    for _ in range(3):
        time, push = pushed(CHAIN, random, 20.0, 3.0, 500.0)
        states = np.zeros((len(push), 4))
        for k in range(len(push) - 1):
            states[k + 1] = transition @ states[k] + now * push[k] + later * push[k + 1]
        runs.append((time, push, noisy(states @ rows.T + np.outer(push, by_drive), 0.01, random)))
    folder = written(tmp_path, known, runs, 0)
    found = fit_session(folder)
    truth = dict(zip(network.layout.keys, network.values, strict=True))
    for key in found.changed:
        estimate = found.parameters[key]
        assert abs(float(estimate.value) - truth[key]) < 5.0 * estimate.std + 5e-3 * truth[key], key
    write_parameters(tmp_path / "fitted.yaml", found.parameters)
    assert compare_session(folder, str(tmp_path / "fitted.yaml")).overall["nrmse_percent"] < 2.0
    assert "bodies.m1.mass_kg" in str(found)
    assert "Modes" in str(found)
