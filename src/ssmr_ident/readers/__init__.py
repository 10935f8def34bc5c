"""Loading dock: bytes in, Recordings in SI out. One file per format; ``writers`` puts them back into files."""

from ssmr_ident.readers.door import READERS, read, read_one
from ssmr_ident.readers.options import ReadOptions

__all__ = ["READERS", "ReadOptions", "read", "read_one"]
