"""``ident simulate``: run the bundled simulator and write a recording of the same form as a real one."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer

from ssmr_ident.cli import completion
from ssmr_ident.cli import experiment_options as asked
from ssmr_ident.cli.effect_files import EffectFiles

CHOICES = "free_response, pull, swivel, straight, wheel_drag, vertical_compression, forced, base_motion"


FIRST_RUN = "simulating (the first run on a machine compiles the simulator, some ten seconds)"

EXAMPLES = (
    "ident simulate p3at-extended -e free_response --motion pitch --noise --seed 7 -o pitch-1.xlsx",
    "ident simulate params.yaml -e swivel --yaw-rate-deg-s 45 -o swivel.csv",
    "ident simulate p3at-extended -e swivel --yaw-rate-deg-s 10 --contact printed_6_4 -o swivel.csv",
    "ident simulate p3at-extended -e pull --direction lateral --cable rope -o pull-1.txt",
    "ident simulate p3at-extended -e pull --angle-deg 45 --cable rope -o pull-2.txt",
    "ident simulate p3at-extended -e free_response --effect dry_friction:F_c_N=2 -o roll-1.csv",
    "ident simulate rig.yaml -e forced --force shaker.csv -o answer.csv",
    "ident simulate servo.yaml -e forced --force goal.csv --kp-V-rad 4 --limit-V 7.4 -o answer.csv",
    "ident simulate rig.yaml -e free_response --amplitude-mm 2 --duration-s 10 -o decay.csv",
    "ident simulate network.yaml -e forced --force hammer.csv --at tip -o answer.csv",
    "ident simulate block.yaml -e pull --speed-mm-s 2 --duration-s 20 -o pull.csv",
    "ident simulate rig.yaml -e forced --force shaker.csv --effects my_law.py --effect my_law -o answer.csv",
)


def command(
    params: asked.Params,
    experiment: Annotated[
        str, typer.Option("--experiment", "-e", help=f"One of {CHOICES}.", autocompletion=completion.experiments)
    ],
    output: Annotated[Path, typer.Option("-o", "--output", help="Log to write: .csv, .lvm or .xlsx.")] = Path(
        "rec.csv"
    ),
    motion: asked.Motion = "roll",
    amplitude_mm: asked.AmplitudeMm = 0.3,
    amplitude_deg: asked.AmplitudeDeg = 5.0,
    start: asked.Start = "tilted",
    push_n: asked.PushN = 0.0,
    at: asked.At = "",
    direction: asked.Direction = "lateral",
    angle_deg: asked.AngleDeg = None,
    speed_mm_s: asked.SpeedMmS = 1.0,
    height_m: asked.HeightM = 0.05,
    wheels_gripping: asked.WheelsGripping = "1,2,3,4",
    cable: asked.Cable = "steel",
    wheel_rate_rad_s: asked.WheelRateRadS = 0.0,
    free_normal: Annotated[bool, typer.Option(help="Wheel drag: the wheel can move off the surface.")] = True,
    yaw_rate_deg_s: asked.YawRateDegS = 45.0,
    speed_m_s: asked.SpeedMS = 0.3,
    force: Annotated[str, typer.Option(help="Forced rig: a log with time and force, torque, voltage or goal.")] = "",
    base: Annotated[
        str, typer.Option(help="Base motion: a log with columns time and base_acceleration, or base_position.")
    ] = "",
    baseline: Annotated[
        str, typer.Option(help="rigid6, decoupled, sdof, network or drag; left out, what the file's keys describe.")
    ] = "",
    kp_v_rad: asked.KpVRad = 0.0,
    limit_v: asked.LimitV = math.inf,
    contact: asked.Contact = None,
    effect: asked.EffectIds = None,
    effects: EffectFiles = None,
    duration_s: asked.DurationS = None,
    rate_hz: asked.RateHz = None,
    noise: Annotated[bool, typer.Option(help="Add the noise of the parameter file's noise block.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print what was written as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("-q", "--quiet", help="Print nothing.")] = False,
    seed: Annotated[int, typer.Option(min=0, help="Of the noise.")] = 0,
) -> None:
    """Simulate one experiment and write it as a log."""
    from ssmr_ident.cli.answer import print_json
    from ssmr_ident.cli.progress import doing
    from ssmr_ident.core.atomic import refuse_overwriting, refuse_unwritable
    from ssmr_ident.experiments import Conditions
    from ssmr_ident.workflows.simulate.request import Request, experiment_of, wheels_of
    from ssmr_ident.workflows.simulate.run import simulate_to_file

    conditions = Conditions(
        motion=motion, amplitude_mm=amplitude_mm, amplitude_deg=amplitude_deg, start=start, push_N=push_n, at=at,
        direction=direction, angle_deg=angle_deg,
        speed_mm_s=speed_mm_s, height_m=height_m, wheels_gripping=wheels_of(wheels_gripping), cable=cable,
        wheel_rate_rad_s=wheel_rate_rad_s, free_normal=free_normal, yaw_rate_deg_s=yaw_rate_deg_s,
        speed_m_s=speed_m_s, kp_V_rad=kp_v_rad, limit_V=limit_v,
    )  # fmt: skip
    request = Request(
        experiment_of(experiment), conditions, force=force, base=base, baseline=baseline, duration_s=duration_s,
        rate_hz=rate_hz, noise=noise,
        seed=seed, effects=tuple(effect or ()), contact=contact,
    )  # fmt: skip
    refuse_unwritable(output)
    refuse_overwriting(output, [params, *filter(None, (force, base))])
    with doing(FIRST_RUN, hidden=quiet or as_json):
        recording = simulate_to_file(params, request, output)
    if as_json:
        print_json({"file": str(output), "experiment": experiment, "samples": len(recording.time),
                          "rate_hz": recording.sample_rate, "channels": list(recording.names)})  # fmt: skip
    elif not quiet:
        print(recording)
        print(f"written to {output}")
