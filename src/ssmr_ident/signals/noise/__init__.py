"""The one noise model: how large noise is, of what colour, what is rounded away, and which mains lines stand in it.

Every other room reads noise here; ``tests/contract/test_one_noise_model.py`` holds that none estimates its own.
"""

from ssmr_ident.signals.noise.autoregressive import AutoregressiveNoise, burg_noise, fit_noise, quiet_noise, white_noise
from ssmr_ident.signals.noise.background import background_noise
from ssmr_ident.signals.noise.colour import (
    independent_samples,
    long_run_variance,
    loudness_where_taken,
    samples_together,
    whiteness,
)
from ssmr_ident.signals.noise.load_cell import Blocks, block_noises
from ssmr_ident.signals.noise.mains import (
    any_mains_lines,
    line_power,
    mains_lines,
    nuisance_columns,
    rest_after,
    without_mains,
)
from ssmr_ident.signals.noise.process import process_noise
from ssmr_ident.signals.noise.white import (
    force_noise,
    median_std,
    quietest_density,
    rounding,
    third_difference_std,
    usable_band,
    white_std,
)

__all__ = [
    "AutoregressiveNoise",
    "Blocks",
    "any_mains_lines",
    "background_noise",
    "block_noises",
    "burg_noise",
    "fit_noise",
    "force_noise",
    "independent_samples",
    "line_power",
    "long_run_variance",
    "loudness_where_taken",
    "mains_lines",
    "median_std",
    "nuisance_columns",
    "process_noise",
    "quiet_noise",
    "quietest_density",
    "rest_after",
    "rounding",
    "samples_together",
    "third_difference_std",
    "usable_band",
    "white_noise",
    "white_std",
    "whiteness",
    "without_mains",
]
