"""Shared fixtures, and what every test takes. Other people's recordings lie beside a checkout, never in it; without
them tests skip.

`make test` leaves out what carries the mark ``slow``. Whoever writes a test that has outgrown it is told so at the end
of a run, by the processor's own seconds, which hardly change where the machine is busy.
"""

from __future__ import annotations

import atexit
import os
import resource
import shutil
import tempfile
import time
from collections.abc import Generator
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
from numba.core.event import install_timer

mpl.use("Agg")
os.environ.setdefault("NO_COLOR", "1")
ROOT = Path(__file__).resolve().parents[1]
OUTGROWN = 1.5
"""Processor seconds from which a test without the mark ``slow`` is named: three times what the mark means, since
processors differ."""


def processor_seconds() -> float:
    """Of this process, and of the children that it has waited for."""
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + children.ru_utime + children.ru_stime


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Generator[None, object, object]:
    """Note what a test takes; loops that are compiled for the first time are not its own."""
    compiling: list[float] = []
    begun = processor_seconds()
    try:
        with install_timer("numba:compile", compiling.append):
            return (yield)
    finally:
        item.user_properties.append(("processor_s", processor_seconds() - begun - sum(compiling)))


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Name the tests that have outgrown `make test`."""
    took = {
        report.nodeid: seconds
        for report in terminalreporter.stats.get("passed", ())
        if report.when == "call" and "slow" not in report.keywords
        for name, seconds in report.user_properties
        if name == "processor_s" and seconds > OUTGROWN
    }
    if took:
        terminalreporter.section(f"more than {OUTGROWN:g} s of processor without the mark slow")
        for test, seconds in sorted(took.items(), key=lambda pair: -pair[1]):
            terminalreporter.write_line(f"{seconds:6.1f} s  {test}")


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
