"""What a case records: the same for the same seed, in the lab's words, explained by its own truth down to the noise."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ssmr_ident.compare import compare
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.experiments.campaign import load
from ssmr_ident.physics.effects import CATALOGUE
from ssmr_proof.drawn.cases import FAMILIES, KINDS, MIMIC, ONE, OUTSIDE, TWO, Case, draw_case
from ssmr_proof.lab.case import Extent, record, write_session

NAMES = (*CATALOGUE, "unlisted", "play", "mast", "hidden", "truth", "mimic", "seed")


def true_parameters(known: ParameterSet, true: dict[str, float]) -> ParameterSet:
    """What the lab would know if it knew all."""
    changes = {key: replace(known[key], value=value) for key, value in true.items() if key in known}
    if "height_m" in true:
        points = np.array(known["contact_points_m"].value)
        points[:, 2] = -true["height_m"]
        changes["contact_points_m"] = replace(known["contact_points_m"], value=points)
        changes["tire.mu_kinetic"] = replace(known["tire.mu_kinetic"], value=true["tire.mu_static"])
    return known.updated(changes)


def test_a_seed_and_a_number_give_the_case() -> None:
    assert draw_case(11, 4) == draw_case(11, 4)
    assert len({str(draw_case(11, number).effects) for number in range(1, 30)}) > 15


def test_all_kinds_and_families_are_drawn() -> None:
    cases = [draw_case(12, number) for number in range(1, 301)]
    kinds, families = Counter(case.kind for case in cases), Counter(case.family for case in cases)
    for kind, share in KINDS.items():
        assert abs(kinds[kind] / 300 - share) < 4.0 * np.sqrt(share * (1.0 - share) / 300)
    assert set(families) == set(FAMILIES)
    assert all((case.kind == "none") == (not case.effects) for case in cases)
    assert all(len(case.effects) == 2 for case in cases if case.kind == "two")
    assert all((effect.strength < 0.0) == (case.kind == "faint") for case in cases for effect in case.effects)


@pytest.mark.slow
@pytest.mark.parametrize("family", FAMILIES)
def test_without_hidden_physics_the_true_parameters_leave_the_noise(family: str, tmp_path: Path, tiny: Extent) -> None:
    """Against the bundled simulator, on recordings of the other engine."""
    recorded = record(Case(21, 1, family, "none", (), "noise"), tiny)
    write_session(recorded, tmp_path / "heldout", heldout=True)
    campaign = load(tmp_path / "heldout")
    compared = compare(campaign, true_parameters(campaign.parameters, dict(recorded.true))).recordings
    for log, row in zip((log for log in recorded.logs if log.heldout), compared, strict=True):
        # over the samples that are compared: until the sensor has settled after the release, none are
        begin = len(log.time) - len(row.prediction.time)
        part = replace(log, time=log.time[begin:], logged=log.logged[begin:], clean=log.clean[begin:])
        assert row.value < 1.03 * part.noise_floor()


@pytest.mark.slow
def test_no_word_of_a_session_tells_what_is_hidden(tmp_path: Path, tiny: Extent) -> None:
    for number, family in enumerate(FAMILIES, start=1):
        draw = ONE[family][0]
        case = Case(22, number, family, "one", (draw(np.random.default_rng(0), 0.7),))
        folder = tmp_path / family
        write_session(record(case, tiny), folder, heldout=False)
        for path in folder.iterdir():
            words = path.name + (path.read_text(encoding="utf-8") if path.suffix == ".yaml" else "")
            words = words.replace("mu_static", "").lower()
            assert not [name for name in NAMES if name in words], path


@pytest.mark.slow
def test_a_session_of_every_effect_can_be_read(tmp_path: Path, tiny: Extent) -> None:
    draws = [(f, draw) for table in (ONE, MIMIC, OUTSIDE) for f in table for draw in table[f]]
    draws += [(family, draw) for family in TWO for pair in TWO[family] for draw in pair]
    random = np.random.default_rng(5)
    seen = set()
    for number, (family, draw) in enumerate(draws):
        effect = draw(random, 1.0)
        if (family, effect.id, effect.form) in seen:
            continue
        seen.add((family, effect.id, effect.form))
        recorded = record(Case(23, number, family, "one", (effect,)), tiny)
        write_session(recorded, tmp_path / str(number), heldout=False)
        assert len(load(tmp_path / str(number)).measurements) == sum(not log.heldout for log in recorded.logs)
        truth = recorded.truth()
        assert truth["verdict"] == "missing_physics"
        assert truth["effects"][0]["id"] in {*CATALOGUE, "unlisted"}
        assert truth["heldout"]["noise_floor"] > 0.0
    assert len(seen) > 25
