"""The compiled loop over rows of plain numbers; see numeric_run for what it takes and why it is exact."""

from __future__ import annotations

import numpy as np

from ssmr_ident.core.kernel import kernel

POWERS_OF_TEN = 10.0 ** np.arange(23)  # all exact in double precision
_TAB, _NEWLINE, _RETURN, _BLANK, _PLUS, _MINUS, _ZERO, _NINE = 9, 10, 13, 32, 43, 45, 48, 57


@kernel
def parse_rows(buffer, position, delimiter, decimal, out):
    """Parse rows until ``out`` is full or a row is not plain numbers.

    Parameters
    ----------
    buffer : (n,) uint8
    position : int
        Start of a line.
    delimiter, decimal : int
        Character codes; a blank as delimiter stands for any run of blanks and tabs.
    out : (rows, width) float
        Filled from the top. An empty first cell becomes NaN.

    Returns
    -------
    count : int
        Rows filled.
    position : int
        Start of the first line that was not taken.
    """
    end = buffer.size
    rows, width = out.shape
    blank = delimiter == _BLANK
    count = 0
    start = position
    while count < rows and start < end:
        p = start
        good = True
        for column in range(width):
            while p < end and (buffer[p] == _BLANK or (buffer[p] == _TAB and delimiter != _TAB)):
                p += 1
            if p >= end:
                good = False
                break
            if column == 0 and not blank and buffer[p] == delimiter:
                out[count, 0] = np.nan
                p += 1
                continue
            negative = False
            if buffer[p] == _MINUS:
                negative = True
                p += 1
            elif buffer[p] == _PLUS:
                p += 1
            mantissa = np.int64(0)
            digits = 0
            scale = 0
            seen = False
            after = False
            while p < end:
                c = buffer[p]
                if _ZERO <= c <= _NINE:
                    if digits > 0 or c != _ZERO:
                        digits += 1
                    if digits > 18:
                        break
                    mantissa = mantissa * 10 + (c - _ZERO)
                    seen = True
                    if after:
                        scale -= 1
                elif c == decimal and not after:
                    after = True
                else:
                    break
                p += 1
            if not seen or digits > 18 or mantissa > 9007199254740992:
                good = False
                break
            if p < end and (buffer[p] == 69 or buffer[p] == 101):  # E, e
                q = p + 1
                down = False
                if q < end and (buffer[q] == _MINUS or buffer[q] == _PLUS):
                    down = buffer[q] == _MINUS
                    q += 1
                exponent = 0
                places = 0
                while q < end and _ZERO <= buffer[q] <= _NINE and places < 4:
                    exponent = exponent * 10 + (buffer[q] - _ZERO)
                    places += 1
                    q += 1
                if places == 0:
                    good = False
                    break
                scale += -exponent if down else exponent
                p = q
            if mantissa == 0:
                value = 0.0
            elif 0 <= scale <= 22:
                value = mantissa * POWERS_OF_TEN[scale]
            elif -22 <= scale < 0:
                value = mantissa / POWERS_OF_TEN[-scale]
            else:
                good = False
                break
            out[count, column] = -value if negative else value
            while p < end and (buffer[p] == _BLANK or (buffer[p] == _TAB and delimiter != _TAB)):
                p += 1
            if column < width - 1:
                if blank:
                    if p >= end or buffer[p] == _NEWLINE or buffer[p] == _RETURN:
                        good = False
                        break
                elif p < end and buffer[p] == delimiter:
                    p += 1
                else:
                    good = False
                    break
        if not good:
            break
        while p < end and (buffer[p] == delimiter or buffer[p] == _BLANK or buffer[p] == _RETURN):
            p += 1  # empty cells at the end of a row
        if p < end and buffer[p] != _NEWLINE:
            break
        start = p + 1
        count += 1
    return count, min(start, end)
