"""Parquet through pyarrow, which an extra brings."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Any

from ssmr_ident.core.errors import InputError


def refuse_without_parquet() -> None:
    """Ask before long work whether its tables can be written, without the time that an import takes.

    Raises
    ------
    InputError
        pyarrow is not installed.
    """
    if find_spec("pyarrow") is None:
        raise InputError("pyarrow", "is not installed", "pip install 'ssmr_ident[batch]'")


def parquet() -> Any:
    """The module ``pyarrow`` with its Parquet part.

    Raises
    ------
    InputError
        It is not installed.
    """
    refuse_without_parquet()
    import pyarrow
    import pyarrow.parquet

    return pyarrow
