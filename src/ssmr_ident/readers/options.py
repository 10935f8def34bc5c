"""What a user can tell a reader: nothing is needed when the file speaks for itself."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

from ssmr_ident.core.domain import Choice, Number, Whole
from ssmr_ident.core.place import Place

RATE = Number("Hz", least=1e-6, most=1e10)
LOAD_SCALE = Number("N", least=1e-12, most=1e12)
SAMPLE, SKIP = Whole(least=1), Whole()
ON_BAD, STAMPS, DECIMAL = Choice(("error", "nan")), Choice(("auto", "even", "logged")), Choice((".", ","))
"""What options and keys of a session may be."""


@dataclass(frozen=True)
class ReadOptions:
    """Choices for reading a log.

    Parameters
    ----------
    reader : str or None
        ``labview-xlsx``, ``lvm``, ``tdms``, ``mtestquattro`` or ``csv``; None lets the content decide.
    fs : float or None [Hz]
        Sampling rate that replaces the file's time column, or stands in for a missing one.
    units : mapping of str to str
        Unit by column: header, canonical name or start of either (``{"load": "lbf"}``). Wins over the file.
    columns : mapping of str to int or str
        Column by quantity, as number from 0 or as header (``{"time": 0, "force": 2}``); only these and the time are
        read, or all where the time alone is named.
    channels : mapping of str to str
        Header by quantity, whatever its words suggest (``{"angular_rate": "velocity"}``); all others are read as well.
    skip : int or "auto"
        Rows of the numeric block of a workbook's sheet to pass over; 10 is the thesis' ``11:end``.
    sheets : mapping of str to int or str
        Worksheet by axis, as number from 1 or as name (``{"x": 4, "y": 3, "z": 2}``).
    time_unit : str or None
        Unit of the time column when the file does not say (``ms``, ``us``).
    stamps : {"auto", "even", "logged"}
        Whether stamps that come in bursts or are coarser than the sampling become even by regression (``auto``), all
        stamps do, or none.
    on_bad : {"error", "nan"}
        What a cell that is no number does inside the data: stop, or become NaN (a row without time is dropped).
    trim : bool
        Cut axes or channels of different length to the samples that all of them have.
    load_scale : float or None
        Newton per unit of LOAD in ``.mtwData`` files; None takes 10 with a warning.
    sample : int or None
        Which recording (from 1) of a file that holds several.
    decimal : {".", ","} or None
        Decimal sign of a text log, where its numbers could be read either way.

    Raises
    ------
    InputError
        A choice that cannot be.
    """

    reader: str | None = None
    fs: float | None = None
    units: Mapping[str, str] = field(default_factory=dict)
    columns: Mapping[str, int | str] = field(default_factory=dict)
    skip: int | str = "auto"
    sheets: Mapping[str, int | str] = field(default_factory=dict)
    channels: Mapping[str, str] = field(default_factory=dict)
    stamps: str = "auto"
    time_unit: str | None = None
    on_bad: str = "error"
    trim: bool = False
    load_scale: float | None = None
    sample: int | None = None
    decimal: str | None = None

    def __post_init__(self) -> None:
        for option, domain, value in (
            ("--fs", RATE, self.fs),
            ("--load-scale", LOAD_SCALE, self.load_scale),
            ("--sample", SAMPLE, self.sample),
            ("--skip", SKIP, None if self.skip == "auto" else self.skip),
            ("--on-bad", ON_BAD, self.on_bad),
            ("--stamps", STAMPS, self.stamps),
            ("--decimal", DECIMAL, self.decimal),
        ):
            if value is not None:
                domain.check(Place(option), value)


def numbered(which: int | str) -> int | None:
    """Number of a column or a sheet that is named by one; None for a name."""
    return int(which) if isinstance(which, int) or re.fullmatch("-?[0-9]{1,9}", which) else None
