"""Recordings as inverse problems and one fit for them: linear parts exactly, the rest by multiple shooting."""
