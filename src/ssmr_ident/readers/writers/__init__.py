"""Recordings back into files, in the same forms that the readers take.

What is written reads back to the same values, rounded as printed. Files appear whole or not at all.
"""

from ssmr_ident.readers.writers.csv import write_csv
from ssmr_ident.readers.writers.labview_xlsx import write_labview_xlsx
from ssmr_ident.readers.writers.lvm import write_lvm
from ssmr_ident.readers.writers.mtestquattro import write_mtestquattro

__all__ = ["write_csv", "write_labview_xlsx", "write_lvm", "write_mtestquattro"]
