"""Lines that are a table in another form: a stamp and an arrow before each, or a name before every number.

Serial monitors put ``12:31:05.124 -> `` or ``[12:31:05.124] `` before what a microcontroller prints, and sketches print
``ax:1.52`` for a plotter, scripts ``(0.005, 1.52)``. All become plain rows here, line by line, so that line numbers
stay those of the file.
"""

from __future__ import annotations

import re
from collections import Counter

from ssmr_ident.readers.source import Source
from ssmr_ident.readers.text.encoding import Text
from ssmr_ident.readers.text.stamps import is_stamp
from ssmr_ident.readers.text.united_cells import without_units

_LOOK = 200  # lines that say which form a log has
_MOST = 0.6  # share of them that must have it
_BROKEN_OVER = 3  # lines that a cell may be broken over
_ARROW = re.compile(r"\[?([^\[\]>]{5,40}?)\]?[ \t]{0,3}(?:->|=>|→)[ \t]{0,3}|[\[(]([^\[\]()]{5,40})[\])][ \t:]{1,3}")
_UPTIME = re.compile(r"\d{1,10}\.\d{2,9}\Z", re.ASCII)  # seconds since the start, as kernels print them
_NAMED = re.compile(
    r"([^\W\d]\w{0,30})[ \t]?[:=][ \t]{0,3}([-+]?[\d.][\w.+-]{0,30})"
    r"(?:[ \t]([^\W\d][\w/^²·*]{0,9}|[°%]\w?)(?=[\s,;|]|\Z)(?![ \t]?[:=]))?"  # a unit, and not the next name
)
_ESP = re.compile(r"[IWEDV] \((\d{1,10})\) [\w./-]{1,40}:[ \t]")  # level, milliseconds since the start, tag
_LISTED = re.compile(r"[\[({]([^\[\](){}]+)[\])}][,;]?\Z")
_BETWEEN = re.compile(r"[\s,;|]*")


def plain_rows(source: Source, text: Text) -> Text:
    """The text with every line as a row of cells, and a header where the lines themselves say the names."""
    text = _with_whole_names(text)
    sample = _sample(text)
    if _share(sample, lambda line: '="' in line) >= _MOST:  # a spreadsheet keeps it as text, or as it is printed
        text = Text(text.data.replace(b'="', b'"'), text.encoding)
        sample = _sample(text)
    if _share(sample, _stamped) >= _MOST:
        text = _without_arrows(source, text, sample)
        sample = _sample(text)
    text = _without_brackets(source, text, sample)
    text = _without_names(source, text, _sample(text))
    return without_units(source, text, _sample(text))


def _with_whole_names(text: Text) -> Text:
    """Header cells that a spreadsheet broke over lines within quotes, on one line below blank ones in their place."""
    head = text.data[: 400 * _LOOK].split(b"\n", _LOOK)[:_LOOK]
    if not any(line.count(b'"') % 2 for line in head):
        return text
    made: list[bytes] = []
    held: list[bytes] = []
    for line in head:
        held.append(line.rstrip(b"\r"))
        whole = b" ".join(held)
        if whole.count(b'"') % 2 and len(held) <= _BROKEN_OVER:
            continue
        if whole.count(b'"') % 2:
            return text  # a quote that nothing closes
        made += [*[b""] * (len(held) - 1), whole]
        held = []
    return Text(b"\n".join(made + held) + text.data[sum(map(len, head)) + len(head) - 1 :], text.encoding)


def _without_brackets(source: Source, text: Text, sample: list[str]) -> Text:
    """Rows that a script prints as lists or tuples, without the brackets around them."""
    if _share(sample, lambda line: _LISTED.match(line.strip())) < _MOST:
        return text
    lines = [text.decode(line).strip() for line in text.data.split(b"\n")]
    made = [match[1].strip() if (match := _LISTED.match(line)) else line for line in lines]
    source.inform("every line is a list in brackets; they are left out")
    return Text("\n".join(made).encode(), "utf-8")


def _sample(text: Text) -> list[str]:
    """The first filled lines; of the first bytes only, for a split copies all that is behind them."""
    return [text.decode(line) for line in text.data[: 400 * _LOOK].split(b"\n")[:_LOOK] if line.strip()]


def _share(sample: list[str], has: object) -> float:
    return sum(bool(has(line)) for line in sample) / max(len(sample), 1) if callable(has) else 0.0


def _stamped(line: str) -> re.Match[str] | None:
    match = _ARROW.match(line)
    return match if match and (is_stamp(_stamp(match)) or _UPTIME.match(_stamp(match))) else None


def _stamp(match: re.Match[str]) -> str:
    return (match[1] or match[2]).strip()


def _without_arrows(source: Source, text: Text, sample: list[str]) -> Text:
    """The stamp as a cell of its own; before words it is called ``time``, for they are names or a remark."""
    rest = [line[match.end() :] for line in sample if (match := _stamped(line))]
    signs = Counter(sign for line in rest for sign in "\t;,|" if sign in line)
    sign = max("\t;,|", key=lambda s: signs[s]) if signs else "\t"
    made = []
    for raw in text.data.split(b"\n"):
        line = text.decode(raw)
        match = _stamped(line)
        if match is None:
            made.append(line)
            continue
        behind = line[match.end() :]
        numbers = sum(c.isdigit() for c in behind) > sum(c.isalpha() for c in behind) or _NAMED.match(behind.strip())
        made.append(f"{_stamp(match) if numbers else 'time'}{sign}{behind}")
    source.inform(
        "every line has a stamp with an arrow or in brackets before it, as serial monitors write: it is the time"
    )
    return Text("\n".join(made).encode(), "utf-8")


def _cells(line: str) -> tuple[str, list[tuple[str, str]]] | None:
    """What stands before ``name:value`` cells, and the cells; None for a line that holds anything else."""
    logged = _ESP.match(line)
    if logged:
        line = f"{logged[1]} {line[logged.end() :]}"
    first = _NAMED.search(line[:4000])
    if first is None:
        return None
    head = line[: first.start()].strip(" \t,;|")
    if head and not is_stamp(head):
        try:
            float(head)
        except ValueError:
            return None
    cells = []
    position = first.start()
    while position < len(line):
        match = _NAMED.match(line, position)
        if match is None:
            return None
        cells.append((f"{match[1]} [{match[3]}]" if match[3] else match[1], match[2]))
        following = _BETWEEN.match(line, match.end())
        assert following is not None
        if following.end() == match.end() < len(line):
            return None
        position = following.end()
    return head, cells


def _without_names(source: Source, text: Text, sample: list[str]) -> Text:
    """``ax:1.52\\tay:0.48`` as numbers below one header."""
    found = [cells for line in sample if (cells := _cells(line.strip()))]
    if len(found) < max(3, _MOST * len(sample)):
        return text
    names, count = Counter(tuple(name for name, _ in cells) for _, cells in found).most_common(1)[0]
    if count < _MOST * len(sample):
        return text
    stamped = any(head for head, _ in found)
    clock = "time [ms]" if _share(sample, _ESP.match) >= _MOST else "time"
    header = "\t".join([*([clock] if stamped else []), *names])
    made: list[str] = []
    begun = False
    for raw in text.data.split(b"\n"):
        line = text.decode(raw).strip()
        cells = _cells(line)
        if cells is None or tuple(name for name, _ in cells[1]) != names:
            made.append(line.replace("\t", " "))
            continue
        if not begun and made:
            made[-1] = header  # the line before the first row, a remark at best; a header needs a line of its own
        values = "\t".join([*([cells[0]] if stamped else []), *(value for _, value in cells[1])])
        made.append(values if begun or made else f"{header}\n{values}")
        begun = True
    source.inform(f"every line names its cells: {', '.join(names)}")
    return Text("\n".join(made).encode(), "utf-8")
