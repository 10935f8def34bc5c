"""The order form: session.yaml and robot.yaml in and out, as plain values."""

from ssmr_ident.session.entry import Entry, LogEntry, Reading
from ssmr_ident.session.parameters_file import bundled_robots, read_parameters
from ssmr_ident.session.parameters_text import write_parameters
from ssmr_ident.session.session_file import Session, read_session

__all__ = [
    "Entry",
    "LogEntry",
    "Reading",
    "Session",
    "bundled_robots",
    "parameters_text",
    "read_parameters",
    "read_session",
    "write_parameters",
]
