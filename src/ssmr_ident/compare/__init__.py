"""Simulation against recordings: what the parameters say a log should hold, and how far the log is from it."""

from ssmr_ident.compare.comparison import Comparison, RecordingComparison, compare
from ssmr_ident.compare.prediction import Prediction, predict

__all__ = ["Comparison", "Prediction", "RecordingComparison", "compare", "predict"]
