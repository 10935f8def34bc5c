"""Write docs/reference/effects.md from the catalogue: ``python docs/make_effects.py``."""

from __future__ import annotations

from pathlib import Path

from ssmr_ident.core.parameter import Parameter
from ssmr_ident.physics.effect import Effect
from ssmr_ident.physics.effects import CATALOGUE
from ssmr_ident.workflows.effects.catalogue import bearer

PAGE = Path(__file__).parent / "reference" / "effects.md"


def page() -> str:
    """The whole page."""
    lines = [
        "# The physics that a model may have left out",
        "",
        "Written by `python docs/make_effects.py` from the declarations in `src/ssmr_ident/physics/effects/`;",
        "edit those. Every effect has a value at which it vanishes, so the model without it is the same model.",
        "`ident effects` lists them, `ident effects ID -o FIGURE.png` draws what one does to a recording.",
        "",
        "| effect | in a sentence | seen in |",
        "| --- | --- | --- |",
    ]
    lines += [f"| [`{e.id}`](#{e.id}) | {e.sentence} | {', '.join(e.experiments)} |" for e in CATALOGUE.values()]
    for effect in CATALOGUE.values():
        lines += ["", *section(effect)]
    return "\n".join(lines) + "\n"


def section(effect: Effect) -> list[str]:
    """One effect."""
    where = ", ".join(site.value for site in effect.acts)
    lines = [f"## {effect.id}", "", effect.sentence, "", f"$$ {effect.equation} $$", ""]
    lines += [f"*How it shows*: {effect.signature}.", ""]
    lines += [f"*Acts on*: {where} of {bearer(effect)}.  "]
    lines += [f"*Source*: {effect.source}.", ""]
    lines += ["| parameter | unit | nominal | bounds | off | |", "| --- | --- | --- | --- | --- | --- |"]
    return lines + [_row(parameter) for parameter in effect.parameters]


def _row(p: Parameter) -> str:
    off = "–" if p.off is None else f"{p.off:g}"
    meaning = p.meaning.replace("|", r"\|")  # |v| would end the cell
    return f"| `{p.name}` | {p.unit} | {p.nominal:g} | {p.lower:g} … {p.upper:g} | {off} | {meaning} |"


if __name__ == "__main__":
    PAGE.parent.mkdir(parents=True, exist_ok=True)
    PAGE.write_text(page(), encoding="utf-8")
    print(f"written to {PAGE}")
