"""The command that shows each row of the scoreboard to a user, and which rows could not have come out otherwise."""

from __future__ import annotations

_SWIVELS = (
    "ident sweep p3at-extended --over lambda_max=1,0.1,0.01,1e-3,1e-4 --over yaw_rate_deg_s=10,20,30,45,64,90 "
    "-e swivel --contact printed_6_4 --repeats 5"
)
_SPECTRUM = "ident spectrum data/raw/swivel-frame"

COMMANDS = {
    "filter": _SPECTRUM, "mains": _SPECTRUM, "band_pass": _SPECTRUM, "middle": _SPECTRUM, "one_sided": _SPECTRUM,
    "peaks": _SPECTRUM, "log_amplitude": _SPECTRUM, "averages": _SPECTRUM, "recordings": _SPECTRUM,
    "ranges": "ident spectrum data/raw/swivel-frame/v0-w30-t20-frame-tile.xlsx --range 5:10",
    "low_pass_20": "ident spectrum data/raw/free_response",
    "grid": "ident spectrum data/raw/free_response",
    "longitudinal_teeth": "ident simulate p3at-platform -e pull --direction longitudinal --duration-s 60 -o pull.csv",
    "longitudinal_ramp": "ident simulate p3at-platform -e pull --direction longitudinal --duration-s 60 -o pull.csv",
    "belts": "ident simulate p3at-platform -e pull --direction longitudinal --effect motor_belt:K_b_N_m=3000",
    "lateral_concrete": "ident sweep p3at-platform --over floor=concrete,carpet -e pull",
    "lateral_carpet": "ident sweep p3at-platform --over floor=concrete,carpet -e pull",
    "mu_concrete": "ident fit data/raw/pulls/concrete.yaml",
    "mu_carpet": "ident fit data/raw/pulls/carpet.yaml",
    "knee": "ident sweep p3at-platform --over wheel_rate_rad_s=0.09,0.18,0.36,0.72 -e pull --duration-s 24",
    "rope": "ident simulate p3at-extended -e pull --cable rope --wheels-gripping 1 --height-m 0 -o pull.csv",
    "steel": "ident simulate p3at-extended -e pull --cable steel --wheels-gripping 1 --height-m 0 -o pull.csv",
    "wheel_release": "ident simulate p3at-extended -e wheel_drag --no-free-normal -o drag.csv",
    "ramp_linear": "ident simulate p3at-extended -e wheel_drag --no-free-normal -o drag.csv",
    "ramp_hardening": "ident simulate p3at-extended -e wheel_drag --no-free-normal --effect nonlinear_stiffness",
    "compression": "ident simulate p3at-extended -e vertical_compression --speed-mm-s 0.1 -o press.csv",
    "pull_teeth": "ident simulate p3at-extended -e pull -o pull.csv",
    "ramp_slopes": "ident sweep p3at-extended --over height_m=0:0.3:4 -e pull",
    "shape_over_height": "ident sweep p3at-extended --over height_m=0:0.3:4 -e pull",
    "two_first": "ident simulate p3at-extended -e pull --height-m 0.2 --rate-hz 1000 -o pull.csv",
    "spinning_fall": "ident sweep p3at-extended --over wheel_rate_rad_s=0,0.009,0.027,0.09 -e pull --duration-s 24",
    "spinning_lambda": "ident sweep p3at-extended --over lambda_max=1,0.1,0.01 -e pull --wheel-rate-rad-s 0.09",
    "straight": "ident sweep p3at-extended --over lambda_max=1,0.1,0.01 -e straight --duration-s 6",
    **dict.fromkeys(
        (
            "lateral_velocity", "slower_turn", "larger_skid", "lower_frequency", "one_line", "common_line",
            "twenty_hertz", "small_az", "small_az_one", "small_amplitudes", "lifting",
        ),
        _SWIVELS,
    ),
}  # fmt: skip

BY_CONSTRUCTION = {
    "middle": "the samples are chosen by this very rule",
    "ranges": "the samples are chosen by these very rules",
    "averages": "a made-up configuration is averaged; what it shows is that repeats are found and gathered",
    "grid": "1000/2048 is arithmetic; that Table 5.2 lies on it is a finding about the table",
    "mu_concrete": "0.86 went in; what it shows is that it comes out of teeth",
    "mu_carpet": "0.98 went in; what it shows is that it comes out of teeth",
    "rope": "the rope's stiffness was taken from (3.9) with such a slope",
    "ramp_hardening": "two numbers are fitted to two slopes",
    "compression": "80 kN/m went in; what it shows is that the reading returns it",
}
