"""The compiled loop over rows of plain numbers; see numeric_run for what it takes and why it is exact."""

from __future__ import annotations

import numpy as np

from ssmr_ident.core.kernel import kernel

POWERS_OF_TEN = 10.0 ** np.arange(23)  # all exact in double precision
EXACT = 2**53  # integers up to here are exact in double precision
LONGEST = 18  # digits that a 64-bit integer holds for certain
LEAST = 10**18  # of 19 digits; a larger one than an integer holds has come round below it, or is not written by clocks
NUMBER, TEXT, STAMP = 0, 1, 2
_TAB, _NEWLINE, _RETURN, _BLANK, _QUOTE, _PLUS, _MINUS, _ZERO = 9, 10, 13, 32, 34, 43, 45, 48


@kernel
def _long_quotient(mantissa: np.int64, places: np.int64) -> tuple[float, bool]:
    """``mantissa / 10**places`` for a mantissa beyond 2**53, and whether its rounding is certain.

    The quotient of the leading part is corrected by its remainder (Dekker 1971), which is known to 2**-52 of
    itself; where a change of the correction by 2**-48 of itself changes nothing, the sum is the nearest double.
    """
    if places < 0 or places > 22:
        return 0.0, False
    power = POWERS_OF_TEN[places]
    high = float(mantissa)
    low = float(mantissa - np.int64(high))
    quotient = high / power
    product = quotient * power
    a = 134217729.0 * quotient  # 2**27 + 1 splits a double in two halves (Veltkamp 1968)
    a = a - (a - quotient)
    b = 134217729.0 * power
    b = b - (b - power)
    left, right = quotient - a, power - b
    error = ((a * b - product) + a * right + left * b) + left * right
    correction = ((high - product) - error + low) / power
    value = quotient + correction
    certain = value == quotient + correction * (1 + 2**-48) and value == quotient + correction * (1 - 2**-48)
    return value, certain


@kernel
def count_lines(buffer: np.ndarray) -> int:
    """Line ends in (n,) uint8."""
    count = 0
    for i in range(buffer.size):
        count += buffer[i] == _NEWLINE
    return count


@kernel
def _pass_over(buffer: np.ndarray, p: int, delimiter: int, blank: bool) -> tuple[int, int, int]:
    """End of a cell that is no number, and its span without quotes; a begin of -1 for an open quote."""
    end = buffer.size
    if buffer[p] == _QUOTE:
        begin = p + 1
        p += 1
        while p < end and buffer[p] != _QUOTE and buffer[p] != _NEWLINE:
            p += 1
        if p >= end or buffer[p] == _NEWLINE:
            return p, -1, -1
        behind = p
        p += 1
        while p < end and (buffer[p] == _BLANK or (buffer[p] == _TAB and delimiter != _TAB)):
            p += 1
        return p, begin, behind
    begin = p
    while p < end and buffer[p] != delimiter and buffer[p] != _NEWLINE and not (blank and buffer[p] == _TAB):
        p += 1
    behind = p
    while behind > begin and buffer[behind - 1] <= _BLANK:
        behind -= 1
    return p, begin, behind


@kernel
def parse_rows(
    buffer: np.ndarray,
    position: int,
    delimiter: int,
    decimal: int,
    kinds: np.ndarray,
    out: np.ndarray,
    spans: np.ndarray,
) -> tuple[int, int]:
    """Parse rows until ``out`` is full or a row is not of plain numbers, text and stamps where they belong.

    Parameters
    ----------
    buffer : (n,) uint8
    position : int
        Start of a line.
    delimiter, decimal : int
        Character codes; a blank as delimiter stands for any run of blanks and tabs.
    kinds : (width,) int64
        ``NUMBER``, ``TEXT`` (passed over) or ``STAMP`` (passed over, its place kept).
    out : (width, rows) float
        Filled from the left, one row of the log per column. Empty cells and cells that are passed over become NaN.
    spans : (stamps, rows, 2) int64
        First byte of each stamp and the byte behind its last.

    Returns
    -------
    count : int
        Rows filled.
    position : int
        Start of the first line that was not taken.
    """
    end = buffer.size
    width, rows = out.shape
    blank = delimiter == _BLANK
    count = 0
    start = position
    while count < rows and start < end:
        p = start
        good = True
        stamp = 0
        for column in range(width):
            while p < end and (buffer[p] == _BLANK or (buffer[p] == _TAB and delimiter != _TAB)):
                p += 1
            if p >= end:
                good = False
                break
            if kinds[column] != NUMBER:
                p, begin, behind = _pass_over(buffer, p, delimiter, blank)
                if begin < 0:
                    good = False
                    break
                out[column, count] = np.nan
                if kinds[column] == STAMP:
                    spans[stamp, count, 0] = begin
                    spans[stamp, count, 1] = behind
                    stamp += 1
                if column < width - 1:
                    if blank:
                        if p >= end or (buffer[p] <= _RETURN and buffer[p] != _TAB):
                            good = False
                            break
                        continue
                    if p >= end or buffer[p] != delimiter:
                        good = False
                        break
                    p += 1
                continue
            if not blank and buffer[p] == delimiter and column < width - 1:
                out[column, count] = np.nan
                p += 1
                continue
            if not blank and column == width - 1 and column and buffer[p] <= _RETURN and buffer[p] != _TAB:
                out[column, count] = np.nan
                continue
            negative = buffer[p] == _MINUS
            if negative or buffer[p] == _PLUS:
                p += 1
            mantissa = np.int64(0)
            begin = p
            while p < end:
                digit = np.int64(buffer[p]) - _ZERO
                if digit < 0 or digit > 9:
                    break
                mantissa = mantissa * 10 + digit
                p += 1
            digits = p - begin
            scale = np.int64(0)
            if p < end and buffer[p] == decimal:
                p += 1
                begin = p
                while p < end:
                    digit = np.int64(buffer[p]) - _ZERO
                    if digit < 0 or digit > 9:
                        break
                    mantissa = mantissa * 10 + digit
                    p += 1
                scale = np.int64(begin - p)
                digits -= int(scale)
            if digits > LONGEST:  # zeros in front do not count: 0.00012 has two digits
                begin = p - digits - (1 if scale < 0 else 0)
                while buffer[begin] == _ZERO or buffer[begin] == decimal:
                    digits -= buffer[begin] == _ZERO
                    begin += 1
            # a whole number of 19 digits, as nanoseconds since 1970 have, is rounded once when it becomes a float
            longest = LONGEST + 1 if scale == 0 and mantissa >= LEAST else LONGEST
            if digits == 0 or digits > longest:
                good = False
                break
            if p < end and (buffer[p] == 69 or buffer[p] == 101):  # E, e
                q = p + 1
                down = False
                if q < end and (buffer[q] == _MINUS or buffer[q] == _PLUS):
                    down = buffer[q] == _MINUS
                    q += 1
                exponent = np.int64(0)
                begin = q
                while q < end and 0 <= np.int64(buffer[q]) - _ZERO <= 9 and q - begin < 4:
                    exponent = exponent * 10 + (np.int64(buffer[q]) - _ZERO)
                    q += 1
                if q == begin:
                    good = False
                    break
                scale += -exponent if down else exponent
                p = q
            if mantissa == 0:
                value = 0.0
            elif mantissa > EXACT and scale == 0:
                value = float(mantissa)
            elif mantissa > EXACT:
                value, certain = _long_quotient(mantissa, -scale)
                if not certain:
                    good = False
                    break
            elif -22 <= scale <= 0:
                value = mantissa / POWERS_OF_TEN[-scale]
            elif 0 < scale <= 22:
                value = mantissa * POWERS_OF_TEN[scale]
            else:
                good = False
                break
            out[column, count] = -value if negative else value
            if column < width - 1:
                if not blank and p < end and buffer[p] == delimiter:
                    p += 1
                    continue
                begin = p
                while p < end and (buffer[p] == _BLANK or (buffer[p] == _TAB and delimiter != _TAB)):
                    p += 1
                if p >= end or (blank and p == begin) or (blank and buffer[p] <= _RETURN):
                    good = False
                    break
                if not blank:
                    if buffer[p] != delimiter:
                        good = False
                        break
                    p += 1
        if not good:
            break
        while p < end and buffer[p] != _NEWLINE:  # empty cells at the end of a row
            if buffer[p] != delimiter and buffer[p] != _BLANK and buffer[p] != _RETURN and buffer[p] != _TAB:
                good = False
                break
            p += 1
        if not good:
            break
        start = p + 1
        count += 1
    return count, min(start, end)
