"""Laws set as mathematics: the plain text of a formula as MathML, which browsers draw by themselves."""

from __future__ import annotations

import re
from collections.abc import Callable
from html import escape

from latex2mathml.converter import convert

_TOKEN = re.compile(r"\s*(?:(\d+(?:\.\d+)?(?:e[+-]?\d+)?)|([A-Za-z]\w*(?:'s\b)?)('*)|(->|[-+*/^()|=<>,·]))")
_GREEK = {
    "alpha": "α", "gamma": "γ", "zeta": "ζ", "lambda": "λ", "mu": "μ", "omega": "ω", "pi": "π", "tau": "τ", "phi": "φ",
    "theta": "θ",
}  # fmt: skip
_UPRIGHT = {"exp", "min", "max", "sign", "sin", "cos", "tanh"}
_WORDS = re.compile(r"\s+(with)\s+")
_TEXT = re.compile(r"\b(of|for|drawn|follows|slides|rides)\b")
SYMBOLS = {
    "knee_share": "a", "knee": "s_k", "k3_share": "b", "sine_share": "p", "kinetic_share": "r", "exponent": "n",
    "stribeck_velocity": "v_s", "rounding": "v_r", "yield": "y", "gap": "g", "element_stiffness": "k",
    "bandwidth": "f_b", "delay": "tau", "f_mast": "f_m", "damping_ratio": "zeta", "height_above_com": "h",
    "rider_share": "m_r", "rider": "f_r", "rider_ratio": "zeta_r", "eccentricity": "e", "place": "s_0",
    "zero_drift": "z", "gain_drift": "g",
}  # fmt: skip
"""What laws call parameters whose names in files are words."""

_TURNED = {"F": "M", "s": "θ", "x": "θ", "v": "ω"}
"""What a formula of a straight motion calls a moment, an angle and a turning speed."""
_LOWERED = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹", "0123456789")
_OPERATORS = {"-": "−", "*": "·", "->": "→", "<": "&lt;", ">": "&gt;"}


def typeset(text: str, turning: bool = False) -> str:
    """A law as one ``<math>`` element for each of its clauses, with commas between them.

    Parameters
    ----------
    text : str
        As diagnoses write laws (``F = k z, dz/dt = v - |v| k z/F_c``), or LaTeX, which is known by its backslashes.
        What is no formula stays text.
    turning : bool
        Of a rotary rig: F, s and v are a moment, an angle and a turning speed.

    >>> typeset("F = K s")
    '<math><mi>F</mi><mo>=</mo><mi>K</mi><mspace width="0.2em"/><mi>s</mi></math>'
    >>> typeset("F = K s", turning=True)
    '<math><mi>M</mi><mo>=</mo><mi>K</mi><mspace width="0.2em"/><mi>θ</mi></math>'
    >>> typeset("no force for |s| < gap/2"), typeset("something (odd")
    ('no force for |s| &lt; gap/2', 'something (odd')
    """
    if "\\" in text:
        return str(convert(text))
    text = re.sub("[⁰¹²³⁴-⁹]+", lambda found: f"^{found[0].translate(_LOWERED)}", text)
    return ", ".join(_clause(part, turning) for part in _clauses(text))


def symbol(name: str, turning: bool = False) -> str:
    """A parameter's name as ``<math>``.

    >>> symbol("F_c")
    '<math><msub><mi>F</mi><mi mathvariant="normal">c</mi></msub></math>'
    """
    return f"<math>{_named(name, '', turning)}</math>"


def _clauses(text: str) -> list[str]:
    """Parts between semicolons, line ends and commas that no brackets hold."""
    depth, parts = 0, [""]
    for letter in text:
        depth += (letter == "(") - (letter == ")")
        if letter in ";\n" or (letter == "," and depth == 0):
            parts.append("")
        else:
            parts[-1] += letter
    return [part.strip() for part in parts if part.strip()]


def _clause(text: str, turning: bool) -> str:
    if _TEXT.search(text):
        return escape(text)
    try:
        made = [
            f" {part} " if _WORDS.fullmatch(f" {part} ") else f"<math>{_Parser(part, turning).whole()}</math>"
            for part in _WORDS.split(text)
            if part
        ]
    except ValueError:
        return escape(text)
    return "".join(made).strip()


def _named(name: str, primes: str, turning: bool) -> str:
    base, _, below = SYMBOLS.get(name, name).partition("_")
    if turning:
        base = _TURNED.get(base, base)
    letter, digits = re.fullmatch(r"(.*?)(\d*)", base).groups()  # type: ignore[union-attr]
    below = " ".join(part for part in (digits, below.replace("_", " ")) if part)
    text = _GREEK.get(letter, letter)
    upright = ' mathvariant="normal"' if letter in _UPRIGHT or (len(text) > 1 and not letter.startswith("d")) else ""
    set_ = f"<mi{upright}>{text}</mi>"
    if below:
        set_ = f'<msub>{set_}<mi mathvariant="normal">{_GREEK.get(below, below)}</mi></msub>'
    return f"<msup>{set_}<mo>{'′' * len(primes)}</mo></msup>" if primes else set_


class _Parser:
    """Sums of products of powers, with fractions and roots; a product is written by a space."""

    def __init__(self, text: str, turning: bool) -> None:
        self.turning = turning
        self.tokens: list[tuple[str, str, str, str]] = []
        place = 0
        while place < len(text):
            found = _TOKEN.match(text, place)
            if found is None:
                raise ValueError(text)
            self.tokens.append(tuple(part or "" for part in found.groups()))  # type: ignore[arg-type]
            place = found.end()
        self.at = 0

    @property
    def operator(self) -> str:
        return self.tokens[self.at][3] if self.at < len(self.tokens) else ""

    def whole(self) -> str:
        made = self.listed(inside_bars=False)
        if self.at < len(self.tokens):
            raise ValueError(self.operator)
        return made

    def listed(self, inside_bars: bool) -> str:
        """Sums with relations or commas between them."""
        made = self.sum(inside_bars)
        while (sign := self.operator) in ("=", "<", ">", "->", ","):
            self.at += 1
            made += f"<mo>{_OPERATORS.get(sign, sign)}</mo>{self.sum(inside_bars)}"
        return made

    def sum(self, inside_bars: bool) -> str:
        made = ""
        while self.operator in ("+", "-"):
            made, self.at = f"{made}<mo>{_OPERATORS.get(self.operator, '+')}</mo>", self.at + 1
        made += self.product(inside_bars)
        while (sign := self.operator) in ("+", "-"):
            self.at += 1
            made += f"<mo>{_OPERATORS.get(sign, sign)}</mo>{self.product(inside_bars)}"
        return made

    def product(self, inside_bars: bool) -> str:
        factors, gap = [self.power()], '<mspace width="0.2em"/>'
        while self.at < len(self.tokens):
            sign = self.operator
            if sign == "/":
                self.at += 1
                factors[-1] = f"<mfrac>{_row(factors[-1])}{_row(self.power())}</mfrac>"
            elif sign in ("*", "·"):
                self.at += 1
                factors[-1] += f"<mo>·</mo>{self.power()}"
            elif sign == "" or sign == "(" or (sign == "|" and not inside_bars):
                factors.append(self.power())
            else:
                break
        return gap.join(factors)

    def power(self) -> str:
        base = self.single()
        if self.operator == "^":
            self.at += 1
            return f"<msup>{_row(base, keep=True)}{_row(self.single())}</msup>"
        return base

    def single(self) -> str:
        if self.at >= len(self.tokens):
            raise ValueError("ends early")
        number, name, primes, sign = self.tokens[self.at]
        self.at += 1
        if number:
            return f"<mn>{number}</mn>"
        if name == "sqrt":
            return f"<msqrt>{_row(self.single())}</msqrt>"
        if name in _UPRIGHT and self.operator in ("(", "|"):  # a function and what it is of are one factor
            return f"{_named(name, primes, self.turning)}{self.single()}"
        if name:
            return _named(name, primes, self.turning)
        if sign == "(":
            return self.fenced("(", ")", lambda: self.listed(inside_bars=False))
        if sign == "|":
            return self.fenced("|", "|", lambda: self.sum(inside_bars=True))
        if sign == "-":
            return f"<mo>−</mo>{self.single()}"
        raise ValueError(sign)

    def fenced(self, left: str, right: str, inside: Callable[[], str]) -> str:
        made = inside()
        if self.operator != right:
            raise ValueError(self.operator)
        self.at += 1
        return f'<mrow><mo fence="true">{left}</mo>{made}<mo fence="true">{right}</mo></mrow>'


def _row(made: str, keep: bool = False) -> str:
    """One element; round brackets go where a bar, a root or a raised place holds together."""
    fenced = re.fullmatch(r'<mrow><mo fence="true">\(</mo>(.*)<mo fence="true">\)</mo></mrow>', made)
    if fenced and not keep and fenced[1].count("<mrow>") == fenced[1].count("</mrow>"):
        return f"<mrow>{fenced[1]}</mrow>"
    return f"<mrow>{made}</mrow>"
