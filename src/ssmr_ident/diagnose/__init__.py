"""The doctor: locate a mismatch, say what physics was left out, model it, and prove it on recordings never fitted."""

from ssmr_ident.diagnose.diagnosis import Diagnosis, NamedEffect
from ssmr_ident.diagnose.evidence import Evidence

__all__ = ["Diagnosis", "Evidence", "NamedEffect"]
