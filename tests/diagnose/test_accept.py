"""What is good enough to be named."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.diagnose import accept
from ssmr_ident.diagnose.accept import as_near, may_mend, mends, promises, relieves, touches, within_file
from ssmr_ident.diagnose.weigh import Explanation
from ssmr_ident.identify.fitting.coordinates import Model
from ssmr_ident.identify.fitting.joint import JointFit
from ssmr_ident.identify.posterior.objective import Unknown


@pytest.mark.parametrize(
    ("std", "found", "within"),
    [(10.0, 60.0, True), (10.0, 50.0, False), (None, 75.0, True), (None, 70.0, False)],
)
def test_a_sensor_is_slow_beyond_what_its_sheet_leaves_open(std: float | None, found: float, within: bool) -> None:
    model, begin = Model(()).with_effect("sensor_bandwidth", {"bandwidth_hz": found}, {})
    known = ParameterSet("robot", {"accelerometer.bandwidth_hz": Estimate(80.0, std, "Hz")})
    assert within_file(JointFit((), model, begin, (), (), ()), known) is within
    assert not within_file(JointFit((), Model(()), begin[:0], (), (), ()), known)


@pytest.mark.parametrize(("offset", "within"), [(0.008, True), (0.012, False)])
def test_a_centre_of_mass_is_off_beyond_what_the_file_leaves_open(offset: float, within: bool) -> None:
    shift = Unknown("contact_shift_y_m", "m", 0.0, 0.003, positive=False)
    at = {"offset_x_m": 0.0, "offset_y_m": offset}
    model, begin = Model((shift,)).with_effect("com_offset", at, {"offset_x_m": 0.01, "offset_y_m": 0.01})
    fit = JointFit((), model, np.concatenate([[0.0], begin]), (), (), ())
    assert within_file(fit, ParameterSet("robot", {})) is within
    # the same place, half of it by contacts that are elsewhere
    shared = JointFit((), model, np.array([-0.5 * offset / 0.003, 0.0, begin[1] / 2.0]), (), (), ())
    assert within_file(shared, ParameterSet("robot", {})) is within


@pytest.mark.parametrize(("bent", "left", "relieved"), [(6.0, 1.0, True), (3.0, 1.0, False), (6.0, 1.2, False)])
def test_an_effect_takes_back_what_the_baseline_bent(bent: float, left: float, relieved: bool) -> None:
    """What six deviations ask is more than chance and a table of effects can: 2 ln 1000."""

    def explained(point: float, parts: float) -> Explanation:
        model = Model((Unknown("contact_shift_x_m", "m", 0.0, 0.005, positive=False),))
        fit = SimpleNamespace(model=model, point=np.array([point]), parts=np.array([parts]))
        return Explanation(fit, fit)  # type: ignore[arg-type]

    assert relieves(explained(0.0, left), explained(bent, 1.0)) is relieved


@pytest.mark.parametrize(
    ("fitted", "kept", "answers"),
    [
        ([1.07, 1.31, 2.15], [2.99, 1.67], True),  # a drift: one recording kept back is left with 9.0 without it
        ([1.07, 1.31, 2.15], [2.61, 9.01], False),
        ([1.07, 1.31, 1.50], [2.61, 9.01], True),
    ],
)
def test_an_answer_mends_what_the_baseline_leaves_wherever_it_shows(
    fitted: list[float], kept: list[float], answers: bool
) -> None:
    assert touches(_leaving(fitted, kept), _leaving([1.23, 1.62, 2.23], [2.61, 9.01])) is answers


@pytest.mark.parametrize(("others", "answers"), [([1.38, 1.01, 0.96, 1.09], True), ([1.58, 1.55, 1.38, 1.56], False)])
def test_one_loud_recording_does_not_speak_against_what_the_others_show(others: list[float], answers: bool) -> None:
    before = _leaving([2.19, 1.58, 1.55, 1.38], [1.56])
    assert touches(_leaving([2.0, *others[:3]], others[3:]), before) is answers


@pytest.mark.parametrize(
    ("bent", "chance", "answers"),
    [
        (9.5, 0.2, True),  # contacts 47 mm off, and 2.6 times the noise of coloured noise everywhere
        (9.5, 1e-8, False),  # something moves that the offset leaves as it is
        (2.0, 0.2, False),
    ],
)
def test_an_offset_that_only_the_priors_name_need_not_mend_what_noise_of_a_colour_leaves(
    bent: float, chance: float, answers: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(accept, "predictions", lambda fit: [])
    monkeypatch.setattr(accept, "worth", lambda *_: SimpleNamespace(before=2.0, noise_floor=1.0))
    monkeypatch.setattr(accept, "reddest", lambda found: 5.7)
    monkeypatch.setattr(accept, "grows_with_motion", lambda found: chance)
    left = [2.6, 2.5, 2.7], [2.6, 2.6]
    assert touches(_leaving(*left), _leaving(*left, bent)) is answers


@pytest.mark.parametrize(("fitted", "answers"), [([5.1, 1.4, 0.6, 7.7], True), ([5.1, 2.4, 2.6, 7.7], False)])
def test_an_offset_in_pulls_need_not_mend_one_or_two_that_lie_in_hollows(
    fitted: list[float], answers: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(accept, "_beyond_noise", lambda explanation: True)
    left = fitted, [1.0, 1.3]
    assert touches(_leaving(*left, slides=True), _leaving(*left, 8.0, slides=True)) is answers


@pytest.mark.parametrize(
    ("fitted", "kept", "near"),
    [
        ([12.0, 60.0], [130.0], True),
        # stribeck beside a stretching cable, in pulls without teeth: four and fifteen times as much is left of these
        ([30.5, 600.0], [130.0], False),
        ([12.0, 60.0], [210.0], False),
        ([30.0, 30.0], [130.0], True),
    ],
)
def test_a_rival_is_near_in_what_was_fitted_and_in_what_was_kept(
    fitted: list[float], kept: list[float], near: bool
) -> None:
    chosen = _leaving([8.0, 40.0], [100.0])
    assert as_near(_leaving(fitted, kept), chosen) == near
    more = named("pair", _leaving(fitted, kept))
    more.fit.model.ids = ("one", "two")  # type: ignore[misc]
    assert not as_near(more, chosen)


def _leaving(fitted: list[float], kept: list[float], bent: float = 0.0, slides: bool = False) -> Explanation:
    model = Model((Unknown("contact_shift_x_m", "m", 0.0, 0.005, positive=False),))

    def fit(parts: list[float]) -> SimpleNamespace:
        trials = [SimpleNamespace(size=100, searched=slides) for _ in parts]
        return SimpleNamespace(parts=np.array(parts) * 100.0, trials=trials, model=model, point=np.array([bent]))

    return Explanation(fit(fitted), fit(kept))  # type: ignore[arg-type]


def test_what_lies_below_the_noise_does_not_speak_against_a_second_effect() -> None:
    """A recording that leaves a hundredth of what was taken for noise, and then three of them, is explained by both."""

    def explained(parts: list[float], kept: float) -> Explanation:
        def fit(values: list[float]) -> SimpleNamespace:
            size, random = 500, np.random.default_rng(1)
            trial = SimpleNamespace(size=size, by_channel=lambda left: left[:, None], nuisances=(), idle={})
            noise = random.standard_normal((len(values), size))
            return SimpleNamespace(
                model=Model(()), point=np.zeros(0), parts=size * np.array(values), counted=np.full(len(values), 300.0),
                states=0, trials=[trial] * len(values),
                residuals=[np.sqrt(v) * n for v, n in zip(values, noise, strict=True)],
            )  # fmt: skip

        return Explanation(fit(parts), fit([kept]))  # type: ignore[arg-type]

    single, others = explained([8.0, 0.33, 0.01, 3.9], 10.0), ([0.15, 0.27, 0.03, 3.1], [8.0, 0.27, 0.03, 3.1])
    assert mends(named("pair", explained(others[0], 6.0)), named("single", single))
    assert not mends(named("pair", explained(others[1], 9.0)), named("single", single))


def named(name: str, explanation: Explanation) -> Explanation:
    """With an id of its own, as evidence is told by id."""
    explanation.fit.model = SimpleNamespace(ids=(name,), physics=(), free=(), held={})  # type: ignore[misc, assignment]
    return explanation


@pytest.mark.parametrize(
    ("share", "before", "after", "taken"),
    [
        (0.76, 1e-4, 0.5, True),  # hardening under a tilted sensor: 0.76, and what follows the motion is gone
        (0.76, 0.02, 0.5, False),  # what the first one leaves is as noise might leave it
        (0.81, 2e-28, 1e-14, False),  # relaxation beside a hardening that is a sinh takes a part of that
        (0.92, 6e-4, 0.5, True),  # play and relaxation in three times the noise that was told
        (0.92, 6e-4, 4e-2, False),
        (0.96, 6e-4, 0.5, False),  # all but nothing
        (0.65, 0.5, 0.5, True),
    ],
)
def test_a_second_effect_that_takes_less_has_to_leave_nothing_that_follows_the_motion(
    share: float, before: float, after: float, taken: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(accept, "certain", lambda pair, single: True)
    _chance_is_told(monkeypatch)
    assert mends(_by_chance(1.4 * share, after), _by_chance(1.4, before)) is taken


def _by_chance(left: float, chance: float) -> Explanation:
    trials = [SimpleNamespace(size=900, searched=False) for _ in range(6)]
    fit = SimpleNamespace(parts=np.full(6, 900.0 * left), trials=trials, chance=chance)
    return Explanation(fit, fit)  # type: ignore[arg-type]


def _chance_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(accept, "predictions", lambda fit: [fit.chance])
    monkeypatch.setattr(accept, "grows_with_motion", lambda found: found[0])


@pytest.mark.parametrize(
    ("share", "before", "after", "may"),
    [
        (0.78, 0.5, 0.5, True),  # being led on may bring it below 0.7
        (0.83, 1e-4, 5e-5, False),  # a centre of mass that is off beside wheels that lift (practice 05)
        (0.83, 1e-4, 5e-3, True),
        (0.83, 0.02, 0.5, False),
    ],
)
def test_a_pair_is_led_on_that_may_mend_then(
    share: float, before: float, after: float, may: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    _chance_is_told(monkeypatch)
    assert may_mend(_by_chance(1.4 * share, after), _by_chance(1.4, before)) is may


@pytest.mark.parametrize(("left", "promising"), [(0.98, False), (0.9, True)])
def test_a_pair_that_takes_next_to_nothing_is_not_led_on(left: float, promising: bool) -> None:
    single = _leaving([400.0, 300.0], [200.0])
    pair = _leaving([400.0 * left, 300.0 * left], [200.0 * left])
    assert promises(pair, single) == promising


def test_what_lies_below_the_noise_hides_no_promise() -> None:
    """Of recordings that are explained but for one, that one is asked."""
    single, pair = _leaving([4.0, 0.01], [0.01]), _leaving([2.0, 0.015], [0.015])
    assert promises(pair, single)
