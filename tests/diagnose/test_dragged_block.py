"""A block on a stiff rope, by the closed form: nothing until the rope is tight, then mu m g."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.experiments.campaign import Campaign, Measurement
from ssmr_ident.physics.rig import Block
from ssmr_ident.session import Entry, Session
from ssmr_ident.simulate.bench import pull_block
from ssmr_ident.workflows.diagnose import diagnose

pytestmark = pytest.mark.slow

RATE, MASS, MU = 100.0, 2.0, 0.4
KNOWN = ParameterSet(
    "block",
    {
        "mass_kg": Estimate(2.01, 0.01, "kg"),
        "mu_static": Estimate(0.42, 0.04, "1"),
        "mu_kinetic": Estimate(0.42, 0.04, "1"),
        "cable.stiffness_N_m": Estimate(np.inf, None, "N/m", fixed=True),
    },
)


CABLE = 13.7e3
STRETCHES = KNOWN.updated({"cable.stiffness_N_m": Estimate(CABLE, 0.11 * CABLE, "N/m")})


def dragged(drift: float = 0.0, jolt: float = 0.0, cable: float = np.inf) -> Campaign:
    """Five drags, the last two kept back; the cell's zero drifts [N/s], the tightening rope overshoots [N] and has a
    stiffness [N/m]."""
    random = np.random.default_rng(8)
    made = []
    for number, speed in enumerate((1.0, 0.5, 2.0, 0.7, 1.5)):
        time = np.arange(round(12.0 / speed * RATE)) / RATE
        slack = round(random.uniform(0.1, 0.4) * RATE)
        force = np.where(np.arange(len(time)) < slack, 0.0, MU * MASS * 9.81) + drift * time
        force[slack] += jolt * speed
        if np.isfinite(cable):
            force = np.minimum(force, cable * 1e-3 * speed * np.maximum(time - time[slack], 0.0))
        force += 0.05 * random.standard_normal(len(time)) + random.normal(0.0, 0.1)
        channels = Channel("position", 1e-3 * speed * time, "m"), Channel("force", force, "N")
        role = "heldout" if number > 2 else "target"
        entry = Entry(f"drag-{number}.csv", "wheel_drag", role=role, speed_mm_s=speed)
        made.append(Measurement(entry, Recording(time, channels, Provenance(entry.file, "", "test"))))
    return Campaign(Session("block", Path(), "block", "drag", tuple(m.entry for m in made)), KNOWN, tuple(made))


@pytest.mark.parametrize("jolt", [0.0, 4.0])
def test_nothing_is_missing_where_nothing_is(jolt: float) -> None:
    """A rope that tightens with a jolt of one sample names nothing, though it is left."""
    found = diagnose(dragged(jolt=jolt))
    assert found.verdict == ("undetermined" if jolt else "nothing_missing")
    assert found.effects == ()
    assert found.before["mu_kinetic"].value == pytest.approx(MU, rel=0.02)


def test_a_zero_that_drifts_is_named_with_its_rate() -> None:
    """At one force a zero and a gain that drift are the same line: it is told as the zero's."""
    found = diagnose(dragged(drift=0.05))
    assert [e.id for e in found.effects] == ["load_cell_drift"]
    drift = {name: float(e.value) for name, e in found.effects[0].parameters.items()}
    assert drift["zero_drift_N_s"] == pytest.approx(0.05, rel=0.03)
    assert found.training.after < 1.1 * found.training.noise_floor < 0.3 * found.training.before


@pytest.mark.parametrize(("further", "said"), [(5.1e3, ["cable_compliance"]), (np.inf, [])])
def test_a_cable_that_gives_far_more_than_the_file_says_is_named(further: float, said: list[str]) -> None:
    """One in series with another: the baseline makes the same of it, 12 deviations from what is known."""
    found = diagnose(replace(dragged(cable=1.0 / (1.0 / CABLE + 1.0 / further)), parameters=STRETCHES))
    assert [e.id for e in found.effects] == said
    if said:
        assert found.effects[0].parameters["K_cable_N_m"].value == pytest.approx(further, rel=0.25)
        assert found.heldout.after < 1.2 * found.heldout.noise_floor


def test_a_head_that_goes_on_drags_to_the_last_sample() -> None:
    block = Block(MASS, MU, MU, np.inf)
    head = 1e-6 * np.arange(6000)
    dragging = pull_block(block, head, 1.0 / RATE) > 0.0
    assert not dragging[0]
    assert dragging[1:-1].all()
    stopped = pull_block(block, np.append(head, np.full(50, head[-1])), 1.0 / RATE) > 0.0
    assert stopped[1:5999].all()
    assert not stopped[5999:].any()
