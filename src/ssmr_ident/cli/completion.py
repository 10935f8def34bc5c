"""What the tab key offers beside verbs, options and files; the shell's part is typer's (``--install-completion``)."""

from __future__ import annotations

from collections.abc import Iterator


def effect_ids(incomplete: str) -> Iterator[tuple[str, str]]:
    """Ids of the catalogue, each with its sentence."""
    from ssmr_ident.physics.effects import CATALOGUE

    yield from ((id, effect.sentence) for id, effect in CATALOGUE.items() if id.startswith(incomplete))


def robots(incomplete: str) -> Iterator[str]:
    """Bundled robots, then parameter files here."""
    from pathlib import Path

    from ssmr_ident.session import bundled_robots

    yield from (name for name in bundled_robots() if name.startswith(incomplete))
    yield from (str(path) for path in sorted(Path().glob(f"{incomplete}*.yaml")))


def bundled(incomplete: str) -> Iterator[str]:
    """Bundled robots alone."""
    from ssmr_ident.session import bundled_robots

    yield from (name for name in bundled_robots() if name.startswith(incomplete))


def experiments(incomplete: str) -> Iterator[str]:
    from ssmr_ident.session.entry import EXPERIMENTS

    yield from (name for name in EXPERIMENTS if name.startswith(incomplete))


def baselines(incomplete: str) -> Iterator[str]:
    from ssmr_ident.session.entry import BASELINES

    yield from (name for name in BASELINES if name.startswith(incomplete))


def contacts(incomplete: str) -> Iterator[str]:
    from ssmr_ident.session.schema import CHOICES

    yield from (name for name in map(str, CHOICES["tire.contact"][0].known) if name.startswith(incomplete))
