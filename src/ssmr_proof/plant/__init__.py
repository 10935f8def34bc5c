"""The plant: a robot and a rig in MuJoCo whose physics shares no law with the bundled simulator."""

from pathlib import Path

from ssmr_ident.core.kernel_sources import forget_other_sources

forget_other_sources(Path(__file__).parent)
