"""A recording as the file of another tool: Parquet, MATLAB, universal file 58."""

from __future__ import annotations

import io
import re
import tempfile
from collections.abc import Callable, Container
from itertools import chain, count
from pathlib import Path

import numpy as np

from ssmr_ident.core.atomic import write_bytes
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.recording import Recording

RATE_TOLERANCE = 1e-3
"""Of a step: a universal file has one rate, and stamps may be as far from it."""
_ORDINATES = {"m": 8, "m/s": 11, "m/s^2": 12, "N": 13}
"""What a universal file calls a quantity of that unit; 0 for unknown."""


def parquet_of(recording: Recording) -> bytes:
    """Columns ``time`` and one a channel, float64; units stand in each field's metadata."""
    from ssmr_ident.workflows.parquet import parquet

    arrow = parquet()
    columns = [("time", "s", recording.time), *((c.name, c.unit, c.samples) for c in recording.channels)]
    fields = [arrow.field(name, arrow.float64(), metadata={"unit": unit}) for name, unit, _ in columns]
    table = arrow.table([arrow.array(samples) for _, _, samples in columns], schema=arrow.schema(fields))
    stream = io.BytesIO()
    arrow.parquet.write_table(table, stream)
    return stream.getvalue()


def mat_of(recording: Recording) -> bytes:
    """MATLAB 5 file: a column vector ``time`` and one a channel, and ``units``, a struct.

    Where MATLAB does not take the log's names there is another struct, ``names``.
    """
    from scipy.io import savemat

    columns, units, names = {"time": recording.time}, {"time": "s"}, {}
    for channel in recording.channels:
        name = _matlab_name(channel.name, {*columns, "units", "names"})
        columns[name], units[name] = channel.samples, channel.unit
        if name != channel.name:
            names[name] = channel.name
    stream = io.BytesIO()
    more = {"names": names} if names else {}
    savemat(stream, {**columns, "units": units, **more}, oned_as="column", long_field_names=True)
    return stream.getvalue()


def _matlab_name(name: str, taken: Container[str]) -> str:
    """A letter, then letters, digits and underscores, 63 at the most."""
    plain = re.sub(r"[^A-Za-z0-9_]", "_", name)[:50]
    plain = plain if plain[:1].isalpha() else f"c{plain}"
    return next(word for word in chain([plain], (f"{plain}_{k}" for k in count(2))) if word not in taken)


def uff_of(recording: Recording) -> bytes:
    """Universal file 58, one data set a channel.

    Raises
    ------
    InputError
        Steps are not even, or pyuff is not installed.
    """
    try:
        import pyuff
    except ModuleNotFoundError as error:
        raise InputError("pyuff", "is not installed", "pip install 'ssmr_ident[uff]'") from error
    step = 1.0 / recording.sample_rate
    if np.abs(np.diff(recording.time) - step).max() > RATE_TOLERANCE * step:
        raise InputError(recording.provenance.file, "is not sampled evenly, and a universal file has one step")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "log.uff"
        file = pyuff.UFF(str(path))
        for number, channel in enumerate(recording.channels, 1):
            data_set = pyuff.prepare_58(
                binary=0, func_type=1, rsp_node=number, rsp_dir=0, ref_node=0, ref_dir=0,
                data=channel.samples, x=recording.time, id1=channel.name, rsp_ent_name="NONE",
                abscissa_spacing=1, abscissa_min=float(recording.time[0]), abscissa_inc=step,
                abscissa_axis_units_lab="s", ordinate_axis_units_lab=channel.unit, abscissa_spec_data_type=17,
                ordinate_spec_data_type=_ORDINATES.get(channel.unit, 0), orddenom_spec_data_type=0,
                z_axis_spec_data_type=0,
            )  # fmt: skip
            file.write_sets({**data_set, "ordinate_axis_lab": channel.name}, mode="add")
        return path.read_bytes()


RECORDING_FORMATS: dict[str, Callable[[Recording], bytes]] = {"parquet": parquet_of, "mat": mat_of, "uff": uff_of}


def write_recording_as(path: Path, recording: Recording, form: str) -> Path:
    """Write a recording.

    Parameters
    ----------
    path : Path
    recording : Recording
    form : str
        Of ``RECORDING_FORMATS``.
    """
    return write_bytes(path, RECORDING_FORMATS[form](recording))
