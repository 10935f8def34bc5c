"""The tables of docs/howto/formats.md, made from the readers and the vocabulary.

``python -m ssmr_ident.readers.formats_page docs/howto/formats.md`` writes them anew between their marks.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

from ssmr_ident.core.atomic import write_text
from ssmr_ident.readers import door
from ssmr_ident.readers.table.headings import SI_UNIT
from ssmr_ident.readers.table.vocabulary import shipped

_EXTRAS = {"tdms": "tdms", "hdf5": "hdf5", "parquet": "parquet", "uff": "uff", "rosbag": "ros"}


def formats_table() -> str:
    """Readers in the order in which they are asked."""
    rows = ["| reader | takes | needs |", "| --- | --- | --- |"]
    for reader in door.FORMATS:
        module = sys.modules.get(getattr(reader, "__name__", type(reader).__module__))
        about = (reader.__doc__ or getattr(module, "__doc__", "") or "").strip().split("\n\n")[0]
        sentence = " ".join(about.split()).rstrip(".").replace("``", "`").replace("|", "or")
        names = ", ".join(f"`{name}`" for name in reader.NAMES)
        extra = next((f'`pip install "ssmr_ident[{_EXTRAS[name]}]"`' for name in reader.NAMES if name in _EXTRAS), "")
        rows.append(f"| {names} | {sentence} | {extra} |")
    return "\n".join(rows)


def vocabulary_table() -> str:
    """Quantities with the words by which they are known."""
    known = shipped()
    languages = sorted({language for words in known.languages.values() for language in words if len(language) == 2})
    first = [language for language in ("en", "de", "fr", "es") if language in languages]
    rows = [f"| quantity | SI | {' | '.join(first)} | others |", "| --- | --- |" + " --- |" * (len(first) + 1)]
    for quantity, words in known.languages.items():
        unit = SI_UNIT.get(quantity) or known.optional.get(quantity, "")
        cells = [", ".join(words.get(language, ())) for language in first]
        others = ", ".join(
            dict.fromkeys(n for language, names in words.items() if language not in first for n in names)
        )
        rows.append(f"| {quantity} | {unit} | {' | '.join(cells)} | {others} |")
    return "\n".join(rows)


def with_tables(text: str) -> str:
    """The page with both tables between their marks."""
    for name, table in (("formats", formats_table()), ("vocabulary", vocabulary_table())):
        pattern = re.compile(rf"(<!-- {name}: [^>]*-->\n).*?(<!-- end of {name} -->)", re.DOTALL)
        made = pattern.search(text)
        if made is None:
            raise ValueError(f"the page has no mark <!-- {name}: … --> with its end")
        text = text[: made.start()] + made[1] + table + "\n" + made[2] + text[made.end() :]
    return text


if __name__ == "__main__":
    for page in map(Path, sys.argv[1:]):
        write_text(page, with_tables(page.read_text(encoding="utf-8")))
