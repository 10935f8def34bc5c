"""``python -m thesis2012`` in studies/: the scoreboard, as ``ident demo --thesis`` prints it."""

from __future__ import annotations

from thesis2012.scoreboard import thesis_scoreboard

if __name__ == "__main__":
    print(thesis_scoreboard(print))
