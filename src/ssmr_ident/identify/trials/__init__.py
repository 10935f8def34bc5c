"""Recordings as inverse problems, one kind of experiment a file."""

from ssmr_ident.identify.trials.make import trial_of
from ssmr_ident.identify.trials.trial import Trial

__all__ = ["Trial", "trial_of"]
