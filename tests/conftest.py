"""Shared fixtures. Other people's recordings lie beside a checkout, never in it; without them tests skip."""

from __future__ import annotations

import atexit
import os
import shutil
import tempfile
from pathlib import Path

# before numpy loads: small matrices on several threads of a busy machine cost many times the work
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# before matplotlib loads: its list of fonts is kept between programs, and one written while an environment was being
# removed lacks matplotlib's own fonts, of which every later program then complains. Workers take over this folder
if "MPLCONFIGDIR" not in os.environ:
    os.environ["MPLCONFIGDIR"] = tempfile.mkdtemp(prefix="matplotlib-")
    atexit.register(shutil.rmtree, os.environ["MPLCONFIGDIR"], ignore_errors=True)

import matplotlib as mpl
import pytest

mpl.use("Agg")
os.environ.setdefault("NO_COLOR", "1")
ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture(scope="session")
def root() -> Path:
    """The checkout."""
    return ROOT


@pytest.fixture(scope="session")
def shared() -> Path:
    """The folder of real recordings and format samples beside the checkout; skips the test when it is absent."""
    folder = ROOT.parent / "shared"
    if not folder.is_dir():
        pytest.skip("no shared folder beside the checkout")
    return folder
