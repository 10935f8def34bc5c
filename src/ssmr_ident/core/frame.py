"""Results as pandas data frames."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas as pd


def frame(rows: Iterable[Mapping[str, Any]], columns: Sequence[str], index: str = "", **facts: object) -> pd.DataFrame:
    """Rows as a frame that has its columns even where there is no row.

    Parameters
    ----------
    rows : iterable of mapping
    columns : sequence of str
    index : str
        The column that becomes the index; empty for numbers from 0.
    **facts
        Kept in ``attrs``.
    """
    import pandas as pd  # half a second, which who asks for no frame need not wait

    made = pd.DataFrame(list(rows), columns=list(columns))
    made.attrs.update(facts)
    return made.set_index(index) if index else made
