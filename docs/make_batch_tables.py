"""Write the columns of a batch's tables into docs/howto/batch.md, from the code.

python docs/make_batch_tables.py
"""

from __future__ import annotations

from pathlib import Path

from ssmr_ident.workflows.batch.schema import COLUMNS

PAGE = Path(__file__).parent / "howto" / "batch.md"
MARK = "<!-- made by docs/make_batch_tables.py -->\n"


def page() -> str:
    """The page with the tables as the code has them."""
    lines = []
    for name, columns in COLUMNS.items():
        lines += [f"### {name}", "| column | type | what |", "| --- | --- | --- |"]
        lines += [f"| `{column}` | {kind} | {meaning} |" for column, (kind, meaning) in columns.items()]
        lines.append("")
    return PAGE.read_text(encoding="utf-8").partition(MARK)[0] + MARK + "\n".join(lines)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
