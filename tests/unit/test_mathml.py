"""Every law that a diagnosis may print is set as mathematics, and what is none stays text."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree

import pytest

from ssmr_ident.diagnose.words import FORMS, LAWS
from ssmr_ident.physics.effects import CATALOGUE, unlisted
from ssmr_ident.report.mathml import typeset

WORDS = ("m_rim b''", "no force for", "z follows s")
"""Parts of laws that are said in words."""


def test_every_law_is_mathematics_but_what_is_said_in_words() -> None:
    for law in (*LAWS.values(), *FORMS.values(), *(e.equation for e in CATALOGUE.values())):
        made = ElementTree.fromstring(f"<p>{typeset(law)}</p>")
        outside = (made.text or "") + "".join(part.tail or "" for part in made)
        told = outside.replace("with", "").strip(" ,")
        assert not told or told.startswith(WORDS), law


def test_every_term_of_an_unlisted_law() -> None:
    for name in unlisted.TERMS:
        made = typeset(unlisted.law({name: 1.0, "place_m": 0.1}))
        assert made.startswith("<math>"), name


@pytest.mark.parametrize(
    ("text", "inside"),
    [
        ("v - |v| k z/F_c", '<mfrac><mrow><mi>z</mi></mrow><mrow><msub><mi>F</mi>'),
        ("1/(1 + s)", "<mfrac><mrow><mn>1</mn></mrow><mrow><mn>1</mn><mo>+</mo><mi>s</mi></mrow></mfrac>"),
        ("sqrt|v|", '<msqrt><mrow><mrow><mo fence="true">|</mo><mi>v</mi>'),
        ("(a + b)^2", '<mo fence="true">)</mo></mrow></mrow><mrow><mn>2</mn></mrow></msup>'),
        ("q''", "<msup><mi>q</mi><mo>′′</mo></msup>"),
        ("2.5e-3 s²", "<mn>2.5e-3</mn>"),
    ],
)  # fmt: skip
def test_what_a_reader_of_formulas_expects(text: str, inside: str) -> None:
    assert inside in typeset(text)


def test_text_from_outside_is_escaped() -> None:
    assert typeset("<script>") == "&lt;script&gt;"
