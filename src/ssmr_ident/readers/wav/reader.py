"""Sound files whose samples are an accelerometer's: full scale is 1, and what 1 means stands nowhere."""

from __future__ import annotations

import io
import warnings

import numpy as np

from ssmr_ident.core.recording import Recording
from ssmr_ident.readers.options import ReadOptions
from ssmr_ident.readers.source import Source
from ssmr_ident.readers.table.assemble import recordings_of
from ssmr_ident.readers.table.columns import Column, Table

NAMES = ("wav",)


def recognises(source: Source) -> bool:
    return source.kind == "wav"


def read(source: Source, options: ReadOptions) -> list[Recording]:
    """The recording of a WAV file.

    Raises
    ------
    InputError
        Damaged, or packed in a way that scipy does not read.
    """
    from scipy.io import wavfile

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # chunks that say who made the file
            rate, samples = wavfile.read(io.BytesIO(source.data))
    except Exception as error:  # scipy reports damage by whatever its parsing stumbles over
        reason = f"{type(error).__name__}: {str(error)[:100]}"
        raise source.error(f"is a WAV file that cannot be read ({reason})", "Save it as uncompressed WAV.") from error
    if not len(samples) or rate <= 0:
        raise source.error("is a WAV file without samples", "Record again.")
    values = np.atleast_2d(samples.T).T
    scale = 1.0
    if values.dtype.kind in "iu":
        scale = 2.0 ** (8 * values.dtype.itemsize - 1)  # 24 bits stand in the upper part of 32
    zero = 128.0 if values.dtype == np.uint8 else 0.0
    count = values.shape[1]
    columns = [
        Column(f"channel {k + 1}", None, (values[:, k].astype(float) - zero) / scale, step=1.0 / rate, number=k)
        for k in range(count)
    ]
    table = Table(columns, lambda row: f"sample {row + 1}")
    table.warn(
        "full scale is 1; what that is in m/s^2 or V stands nowhere in a sound file. Say the unit of 1 with "
        "--units 'channel 1=g', or in session.yaml per_volt with unit V"
    )
    return recordings_of(source, "wav", table, options)
