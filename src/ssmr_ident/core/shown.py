"""Results show themselves in a notebook."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

_PRE = "margin:0;line-height:1.25;white-space:pre-wrap"


class Shown:
    """What prints on a screen shows itself in a notebook the same way; tables override this."""

    def _repr_html_(self) -> str:
        return f'<pre style="{_PRE}">{escape(str(self))}</pre>'


def html_table(
    header: Sequence[str], rows: Iterable[Sequence[str]], caption: str = "", below: Iterable[str] = ()
) -> str:
    """A table for a notebook; text is escaped, the first column set left, the others right.

    >>> html_table(("channel", "min"), [("ay", "-1 < 0")]).count("<td")
    2
    """

    def cell(tag: str, text: str, first: bool) -> str:
        return f'<{tag} style="text-align:{"left" if first else "right"}">{escape(text)}</{tag}>'

    def line(tag: str, texts: Sequence[str]) -> str:
        return "<tr>" + "".join(cell(tag, text, k == 0) for k, text in enumerate(texts)) + "</tr>"

    title = f'<caption style="text-align:left;font-weight:bold">{escape(caption)}</caption>' if caption else ""
    body = "".join(line("td", row) for row in rows)
    notes = "".join(f"<div>{escape(note)}</div>" for note in below)
    return f"<table>{title}<thead>{line('th', header)}</thead><tbody>{body}</tbody></table>{notes}"
