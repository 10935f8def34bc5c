"""The drawing of a network: every body and spring is there, and what an answer is about has its colour."""

from __future__ import annotations

from ssmr_ident.physics.network import Layout
from ssmr_ident.report import style
from ssmr_ident.report.network_figure import network_figure

LAYOUT = Layout(("table", "tip", "rail"), ("foot", "blade", "link"), ((-1, 0), (1, 0), (0, 2)))


def test_what_is_marked_is_in_colour() -> None:
    axes = network_figure(LAYOUT, ("blade", "rail")).axes[0]
    colours = {text.get_text(): text.get_color() for text in axes.texts}
    assert colours.keys() == {*LAYOUT.bodies, *LAYOUT.springs}
    assert {name for name, colour in colours.items() if colour == style.ORANGE} == {"blade", "rail"}


def test_bodies_stand_as_far_from_the_ground_as_springs_lead() -> None:
    axes = network_figure(LAYOUT).axes[0]
    places = {text.get_text(): text.get_position() for text in axes.texts if text.get_text() in LAYOUT.bodies}
    assert [places[name][0] for name in LAYOUT.bodies] == [1.0, 2.0, 2.0]
    assert places["tip"][1] != places["rail"][1]


def test_a_network_without_a_ground_is_drawn_from_its_first_body() -> None:
    loose = Layout(("a", "b"), ("s",), ((0, 1),))
    places = {text.get_text(): text.get_position()[0] for text in network_figure(loose).axes[0].texts}
    assert places["a"] < places["s"] < places["b"]
