"""The catalogue: one left-out effect per file. The folder is the list."""

from __future__ import annotations

import importlib
import pkgutil

from ssmr_ident.physics.effect import Effect


def _read() -> dict[str, Effect]:
    found: dict[str, Effect] = {}
    for module in sorted(pkgutil.iter_modules(__path__), key=lambda m: m.name):
        effect = importlib.import_module(f"{__name__}.{module.name}").EFFECT
        if effect.id != module.name:
            raise ImportError(f"effects/{module.name}.py declares the id {effect.id!r}; expected {module.name!r}")
        found[effect.id] = effect
    return found


CATALOGUE: dict[str, Effect] = _read()
