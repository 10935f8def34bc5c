"""The compiled scan of a long worksheet for its last row and column."""

from __future__ import annotations

import numpy as np

from ssmr_ident.core.kernel import kernel


@kernel
def scan(text: np.ndarray) -> tuple[bool, int, int]:
    """Bounding corner of the cells, for XML written as nearly all of it is: ``<row r="1"…><c r="A1"…>``.

    Parameters
    ----------
    text : (n,) uint8

    Returns
    -------
    plain : bool
        False for anything unusual (prefixes, missing or oddly written references), which the parser must take.
    rows, columns : int
    """
    end = text.size
    rows = 0
    columns = 0
    p = 0
    while p < end - 8:
        if text[p] != 60:  # <
            p += 1
            continue
        p += 1
        if text[p] == 33:  # <! : a comment or a section may hold anything
            return False, 0, 0
        if text[p] == 99:  # c
            if text[p + 1] != 32:
                # <c> and <c/> have no reference; a line end or a tab behind the name may hide one
                if text[p + 1] == 62 or text[p + 1] == 47 or text[p + 1] < 32:
                    return False, 0, 0
                continue
        else:
            q = p
            while q < end and text[q] != 62 and text[q] != 32:
                if text[q] == 58:  # a prefix
                    return False, 0, 0
                q += 1
            p = q
            continue
        if not (text[p + 2] == 114 and text[p + 3] == 61 and text[p + 4] == 34):  # r="
            return False, 0, 0
        p += 5
        column = 0
        while p < end and 65 <= text[p] <= 90 and column < 100_000:
            column = column * 26 + text[p] - 64
            p += 1
        row = 0
        while p < end and 48 <= text[p] <= 57 and row < 1_000_000_000:
            row = row * 10 + text[p] - 48
            p += 1
        if p >= end or text[p] != 34 or column == 0 or row == 0:
            return False, 0, 0
        rows = max(rows, row)
        columns = max(columns, column)
    return True, rows, columns
