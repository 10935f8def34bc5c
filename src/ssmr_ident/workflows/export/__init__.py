"""``ident export``: identified parameters and recordings in the forms of other tools."""

from ssmr_ident.workflows.export.parameters import PARAMETER_FORMATS, parameters_as
from ssmr_ident.workflows.export.recordings import RECORDING_FORMATS, write_recording_as

__all__ = ["PARAMETER_FORMATS", "RECORDING_FORMATS", "parameters_as", "write_recording_as"]
