"""``ident batch``: every session below a folder, each in a process that may fail, hang or be killed on its own."""

from ssmr_ident.workflows.batch.results import Results, read_results
from ssmr_ident.workflows.batch.run import Batch, run_batch

__all__ = ["Batch", "Results", "read_results", "run_batch"]
