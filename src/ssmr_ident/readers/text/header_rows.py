"""The rows above a table of numbers: which one has the names, which the units, and the facts before them."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from ssmr_ident.readers.table.headings import Heading, bare_unit, heading_of, is_units_row
from ssmr_ident.readers.table.runs import run_in
from ssmr_ident.readers.table.vocabulary import Vocabulary, words_of
from ssmr_ident.readers.text.numbers import Dialect
from ssmr_ident.readers.text.numeric_run import TextRow
from ssmr_ident.readers.text.stamps import is_stamp

_RULE = re.compile(r"[-=_+|*#~:. \t]{3,}\Z")
_MARKS = "#%!;*/"
_KEY = re.compile(r"([^=:]{1,60})(?:=|:(?!\d\d)|(?<=[^\d\s]):)(.+)\Z", re.DOTALL)  # 12:00 is no key with a value
_LISTS = re.compile(r"(?:columns?|channels?|fields|header|names|variables|spalten|kanäle)\s?[:=]\s?", re.IGNORECASE)
_LIST_WORD = re.compile(
    r"(?:columns?|channels?|fields|headers?|variables|labels?|spalten|kanäle|"
    r"names|(?:channel|column|trace|signal|variable|field)[\s_]?names?)\s?[:=]?\Z", re.IGNORECASE
)  # fmt: skip
_NO_UNITS = {"ts", "rn", "none", "n/a", "-", "index"}
_PROCESSES = {"smp", "avg", "max", "min", "std", "tot", "med", "sample", "average"}
_UNITED = re.compile(r"[^()\[\]]{1,80}[(\[][^()\[\]]{1,20}[)\]]")
_LONGEST = 20_000  # characters of a header row that are looked at
_FACTS = 200


@dataclass
class Header:
    """Names and units of the columns, and what stands above them.

    Parameters
    ----------
    headings : list of Heading
        One a column; empty labels where the table has no header.
    used : int
        Rows that the names and units took, counted from the table up.
    facts : dict of str to str
    names : list of str
        Of the nearest row that looks like names and does not fit the table; empty when there is none.
    """

    headings: list[Heading]
    used: int = 0
    facts: dict[str, str] = field(default_factory=dict)
    names: list[str] = field(default_factory=list)


def header_of(rows: list[TextRow], width: int, dialect: Dialect, vocabulary: Vocabulary, written: int = 0) -> Header:
    """Read the filled rows above a table of ``width`` columns, of ``written`` with those that are blank at its end."""
    if written > width:
        rows = [_without_blank_columns(row, width, written, dialect) for row in rows]
    rows = [row for row in rows if row.raw.strip()]
    left = list(rows)
    units: list[str] | None = None
    paired: dict[str, str] = {}
    while left:
        last = left[-1]
        cells = _fitting(last.raw, width, dialect)
        words = [c.strip().lower() for c in last.cells if c.strip()]
        if _RULE.match(last.raw[:_LONGEST]) or (words and set(words) <= _PROCESSES):
            left.pop()
            continue
        pairs = [_KEY.match(cell) for cell in last.cells if cell.strip()]
        if len(pairs) > 1 and len(last.cells) <= width and all(p and _is_number(p[2].strip()) for p in pairs):
            paired |= {match[1].strip(): match[2].strip() for match in pairs if match}  # SR=250 Hz in every column
            left.pop()
            continue
        above = _fitting(left[-2].raw, width, dialect) if len(left) > 1 else None
        few = _padded(last.cells, width)
        section = width == 1 and few is not None and vocabulary.unit(bare_unit(few[0], vocabulary) or "") is None
        if (
            units is None
            and few is not None
            and above is not None
            and not section
            and _is_units(few, above, vocabulary)
        ):
            units = few
            left.pop()
            continue
        if width == 1 and len(left) > 1 and section and (re.match(r"\s*\[[^\]]+\]\s*\Z", last.raw[:_LONGEST])):
            left.pop()  # the title of a section
            continue
        if width == 1 and cells and not _marked(last.raw) and re.match(r"[^=\[(]{1,60}=", cells[0]):
            break  # a fact and no name
        numbers = [_is_number(cell) for cell in cells or ()]
        if cells is not None and not (all(numbers) if units else any(numbers)):  # above units, 1 and 2 are names
            if units is None and above and is_units_row(above, vocabulary) and not any(map(_is_number, above)):
                units = above
                left.pop(-2)
            left.pop()
            bare = _bare(units, width, vocabulary)
            if left and units is None:
                cells, bare = _over_two_rows(cells, _fitting(left[-1].raw, width, dialect), vocabulary)
            if left:
                cells = _below_runs(cells, _padded(left[-1].cells, width), vocabulary)
            headings = [heading_of(name, unit or None, vocabulary) for name, unit in zip(cells, bare, strict=True)]
            return Header(headings, len(rows) - len(left), facts_of(left, dialect) | paired)
        if _marked(last.raw) and units is None and len(rows) - len(left) < 8 and len(left) > 1:
            left = _without_last_remark(left, width, dialect)
            if left:
                continue
        break
    said = _names_said(rows, width)
    if said is not None:
        headings = [heading_of(name, None, vocabulary) for name in said]
        return Header(headings, 1, facts_of(rows, dialect) | paired)
    blank = [Heading("", None, None) for _ in range(width)]
    return Header(blank, 0, facts_of(rows, dialect), _names(rows[-1].raw, dialect) if rows else [])


def _without_blank_columns(row: TextRow, width: int, written: int, dialect: Dialect) -> TextRow:
    """A row of names or units without those of columns that hold nothing."""
    named = len(row.cells)
    if named <= width or written not in (named, _cells_written(row.raw, dialect)) or _marked(row.raw):
        return row
    cells = row.cells[:width]
    return TextRow(row.line, cells, dialect.delimiter.join(f'"{c}"' if dialect.delimiter in c else c for c in cells))


def _over_two_rows(
    cells: list[str], above: list[str] | None, vocabulary: Vocabulary
) -> tuple[list[str], list[str | None]]:
    """Names and units where the lower row of a header has a unit, or nothing, below a name in the upper one."""
    units: list[str | None] = [None] * len(cells)
    if above is None or any(map(_is_number, above)):
        return cells, units
    names = list(cells)
    for k, (cell, upper) in enumerate(zip(cells, above, strict=True)):
        unit = bare_unit(cell, vocabulary) if cell else None
        if upper and not cell:
            names[k] = upper
        elif upper and unit is not None and bare_unit(upper, vocabulary) is None:
            names[k], units[k] = upper, unit
    return names, units


def _below_runs(cells: list[str], above: list[str] | None, vocabulary: Vocabulary) -> list[str]:
    """Names with the run or specimen that a row above them says over the first column of each."""
    marks = [mark for mark in above or () if mark]
    if above is None or not above[0] or len(set(marks)) < 2 or not all(run_in(mark, vocabulary)[0] for mark in marks):
        return cells
    named, mark = [], ""
    for cell, upper in zip(cells, above, strict=True):
        mark = upper or mark
        named.append(f"{mark}: {cell}")
    return named


def _names_said(rows: list[TextRow], width: int) -> list[str] | None:
    """Names of the columns in a row that says so: ``Channel names: Force, Accel``; empty for a blank first column."""
    for row in rows[-_FACTS:]:
        first, *names = [_unmarked(cell) if k == 0 else cell for k, cell in enumerate(row.cells)] or [""]
        if not _LIST_WORD.match(first[:40]) or not names or any(map(_is_number, names)):
            continue
        if len(names) in (width, width - 1):
            return [*[""] * (width - len(names)), *names]
    return None


def _without_last_remark(rows: list[TextRow], width: int, dialect: Dialect) -> list[TextRow]:
    """Rows up to the nearest commented one that fits; none when no commented row does."""
    for k in range(len(rows) - 1, max(-1, len(rows) - 8), -1):
        if not _marked(rows[k].raw):
            break
        cells = _fitting(rows[k].raw, width, dialect)
        if cells is not None and not any(_is_number(cell) for cell in cells) and width > 1:
            return rows[: k + 1]
    return []


def _marked(raw: str) -> bool:
    return raw.lstrip()[:1] in tuple(_MARKS)


def _unmarked(raw: str) -> str:
    """A row without what makes it a comment; ``%time`` is a name, its mark goes as well."""
    return raw.strip().lstrip(_MARKS + " \t") if _marked(raw) else raw


def _fitting(raw: str, width: int, dialect: Dialect) -> list[str] | None:
    """Cells of a row of names over ``width`` columns: separated as the table is, or otherwise."""
    if len(raw) > _LONGEST:
        return None
    text = _LISTS.sub("", _unmarked(raw), count=1) if _marked(raw) else raw
    if width == 1 and len(_names(raw, dialect)) > 1:
        return None  # several names over one number
    ways = [dialect.cells(text)]
    ways += [Dialect(sign).cells(text) for sign in "\t;,|" if sign != dialect.delimiter]
    if dialect.delimiter == " ":
        ways += [[c.strip() for c in re.split(r" {2,}|\t", text.strip())], _united(text), _UNITED.findall(text)]
    for cells in ways:
        if len(cells) == width + 1 and _LIST_WORD.match(cells[0].strip()[:40]):
            return [cell.strip() for cell in cells[1:]]
        # one name too many is the Comment column of a table whose comments are empty
        if len(cells) == width or (width > 1 and len(cells) == width + 1 and "\t;,".find(dialect.delimiter) >= 0):
            return [cell.strip() for cell in cells[:width]]
    cells = ways[0]
    if dialect.delimiter != " " and width > 2 and 1 < len(cells) < width and _cells_written(raw, dialect) == width:
        return [*cells, *[""] * (width - len(cells))]
    return None


def _cells_written(raw: str, dialect: Dialect) -> int:
    return raw.count(dialect.delimiter) + 1


def _padded(cells: list[str], width: int) -> list[str] | None:
    return [*cells, *[""] * (width - len(cells))] if len(cells) <= width else None


def _united(text: str) -> list[str]:
    """Words with the bracketed unit behind them put to the word before."""
    cells: list[str] = []
    for word in text.split():
        if cells and word[:1] in "([" and word[-1:] in ")]":
            cells[-1] += " " + word
        else:
            cells.append(word)
    return cells


def _is_units(cells: list[str], above: list[str], vocabulary: Vocabulary) -> bool:
    """True for a row of units below names; one unit that is not known does not make it names."""
    filled = [cell for cell in cells if cell.strip() and cell.strip().lower() not in _NO_UNITS]
    known = [cell for cell in filled if bare_unit(cell, vocabulary) is not None]
    if not filled or all(_is_number(cell) for cell in above if cell):
        return False
    named = sum(bare_unit(cell, vocabulary) is None for cell in above if cell.strip())
    return len(known) == len(filled) or (
        2 * len(known) > len(filled) and 2 * named > sum(bool(c.strip()) for c in above)
    )


def _bare(units: list[str] | None, width: int, vocabulary: Vocabulary) -> list[str | None]:
    if units is None:
        return [None] * width
    return [
        None if cell.strip().lower() in _NO_UNITS - {"-"} else bare_unit(cell, vocabulary) or cell.strip() or None
        for cell in units
    ]


def _is_number(cell: str) -> bool:
    """True for what begins like a number, even a spoilt one: such a row is damaged data, no header.

    A number before words, ``101 <acc> (VDC)``, is a channel's.
    """
    if re.match(r"\d{1,4}[ _]\W?[^\W\d]{3}", cell) and not is_stamp(cell):
        return False
    return bool(re.match(r"[+-]?[.,]?\d", cell))


def _names(raw: str, dialect: Dialect) -> list[str]:
    """Cells of a row that looks like names, however it is separated."""
    if len(raw) > _LONGEST:
        return []
    ways = [[c for c in Dialect(sign).cells(_unmarked(raw)) if c] for sign in (dialect.delimiter, *"\t;,|")]
    cells = max(ways, key=len)
    return cells if not any(_is_number(cell) for cell in cells) else []


def facts_of(rows: list[TextRow], dialect: Dialect) -> dict[str, str]:
    """``key: value``, ``key = value`` and ``key,value,unit`` above a table."""
    found: dict[str, str] = {}
    for row in rows[:_FACTS]:
        cells = [cell for cell in row.cells if cell]
        match = _KEY.match(_unmarked(row.raw[:1000]).strip()) if _marked(row.raw) or len(cells) == 1 else None
        if match is None and dialect.delimiter == " ":
            match = _KEY.match(_unmarked(row.raw[:1000]).strip())
        if match:
            found[match[1].strip()[:80]] = match[2].strip()[:400]
        elif len(cells) >= 2:
            found[_unmarked(cells[0]).rstrip(":")[:80]] = " ".join(cells[1:])[:400]
    return found


def units_from(facts: dict[str, str], count: int, vocabulary: Vocabulary) -> tuple[list[str], str] | None:
    """Units of ``count`` columns that the facts state, and the fact as written; None when none does.

    >>> from ssmr_ident.readers.table.vocabulary import shipped
    >>> units_from({"Vertical Units": "V mV"}, 2, shipped()), units_from({"unit": "m/s^2"}, 2, shipped())
    ((['V', 'mV'], 'Vertical Units: V mV'), (['m/s^2', 'm/s^2'], 'unit: m/s^2'))
    """
    for key, value in facts.items():
        if not vocabulary.has("units_said", words_of(key)):
            continue
        each = [value] * count if vocabulary.unit(value) else value.split()
        if count and len(each) == count and all(vocabulary.unit(unit) for unit in each):
            return each, f"{key}: {value}"
    return None


def rate_from(facts: dict[str, str], vocabulary: Vocabulary) -> tuple[float, str] | None:
    """A sampling rate that the facts state [Hz], and the fact as written; None when none does.

    >>> from ssmr_ident.readers.table.vocabulary import shipped
    >>> rate_from({"fs": "200 Hz"}, shipped()), rate_from({"dt [ms]": "5"}, shipped())
    ((200.0, 'fs = 200 Hz'), (200.0, 'dt [ms] = 5'))
    """
    for key, value in facts.items():
        heading = heading_of(key, None, vocabulary)
        words = words_of(heading.label)
        for section, default in (("rates", "Hz"), ("steps", "s")):
            bare = tuple(w for w in words if w not in ("hz", "khz", "s", "ms", "sec", "us"))
            if not (vocabulary.has(section, words) or vocabulary.has(section, bare)):
                continue
            each = set(value.split())
            value = each.pop() if len(each) == 1 else value  # 200 200 200: one for each channel
            match = re.match(r"\s*([+-]?\d+(?:[.,]\d*)?(?:[eE][+-]?\d{1,3})?)\s*([^\s,;]{0,12})", value)
            if match is None:
                continue
            tail = next((w for w in words[::-1] if w in ("hz", "khz", "s", "ms", "sec", "us")), None)
            unit = vocabulary.unit(match[2] or heading.unit or tail or default)
            number = float(match[1].replace(",", ".")) * (unit.factor if unit else 1.0)
            if unit and unit.unit == default and 0 < number < 1e12:
                return (number if default == "Hz" else 1.0 / number), f"{key} = {value.strip()}"
    return None
