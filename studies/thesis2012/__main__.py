"""``python -m thesis2012`` in studies/: the scoreboard, as in ``ident demo --thesis``, and Table 5.2 by two models."""

from __future__ import annotations

from thesis2012.scoreboard import thesis_scoreboard
from thesis2012.two_models import two_models

if __name__ == "__main__":
    print(thesis_scoreboard(print))
    print(f"\nTable 5.2\n{two_models()}")
