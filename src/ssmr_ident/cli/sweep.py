"""``ident sweep``: the simulator over a grid of anything, with tables, spectra and plots (thesis appendix C)."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ssmr_ident.cli import completion
from ssmr_ident.cli import experiment_options as asked
from ssmr_ident.cli.effect_files import EffectFiles

EXAMPLES = (
    "ident sweep p3at-extended --over lambda_max=0.2:1:9 --experiment swivel -o sweep",
    "ident sweep p3at-extended --over yaw_rate_deg_s=10:90:9 --over lambda_max=1,0.1,0.01 -e swivel -o sweep",
    "ident sweep p3at-extended --over robot=p3at-extended,p3at-platform --over floor=concrete,carpet -e swivel",
    "ident sweep p3at-extended --over height_m=0:0.3:4 -e pull --direction lateral -o heights",
    "ident sweep p3at-extended --over lambda_max=1e-4:1:5:log -e swivel --contact printed_6_4 --repeats 3",
)


def command(
    params: asked.Params,
    experiment: Annotated[
        str,
        typer.Option(
            "--experiment", "-e", help="swivel, straight, free_response or pull.", autocompletion=completion.experiments
        ),
    ],
    over: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=A:B:N",
            help="What is swept; again for a grid. NAME is a key of the parameter file, EFFECT.PARAMETER, an option "
            "of the experiment, contact, floor, or robot (files); values A:B:N, A:B:N:log, or V,V,….",
        ),
    ] = None,
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder for logs, table and figures.")] = Path("sweep"),
    repeats: Annotated[
        int, typer.Option(help="Runs per point, begun a tenth of a micrometre apart: stick-slip is chaotic.")
    ] = 1,
    motion: asked.Motion = "roll",
    amplitude_mm: asked.AmplitudeMm = 0.3,
    start: asked.Start = "tilted",
    push_n: asked.PushN = 0.0,
    direction: asked.Direction = "lateral",
    angle_deg: asked.AngleDeg = None,
    speed_mm_s: asked.SpeedMmS = 1.0,
    height_m: asked.HeightM = 0.05,
    wheels_gripping: asked.WheelsGripping = "1,2,3,4",
    cable: asked.Cable = "steel",
    wheel_rate_rad_s: asked.WheelRateRadS = 0.0,
    yaw_rate_deg_s: asked.YawRateDegS = 45.0,
    speed_m_s: asked.SpeedMS = 0.3,
    contact: asked.Contact = None,
    effect: asked.EffectIds = None,
    effects: EffectFiles = None,
    duration_s: asked.DurationS = None,
    rate_hz: asked.RateHz = None,
    workers: Annotated[int | None, typer.Option(help="Processes; by default one per processor.")] = None,
    figure_format: Annotated[str, typer.Option("--format", help="Of the figures: png, svg or pdf.")] = "png",
    as_json: Annotated[bool, typer.Option("--json", help="Print the table as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("-q", "--quiet", help="Print nothing.")] = False,
) -> None:
    """Simulate every point of a grid; what is there from an earlier call is not done again."""
    import json

    from ssmr_ident.cli.progress import progress
    from ssmr_ident.core.errors import InputError, did_you_mean
    from ssmr_ident.experiments import Conditions
    from ssmr_ident.workflows.simulate.request import Request, experiment_of, wheels_of
    from ssmr_ident.workflows.sweep.axes import axis_of
    from ssmr_ident.workflows.sweep.files import write
    from ssmr_ident.workflows.sweep.run import points_of, sweep

    if figure_format not in ("png", "svg", "pdf"):
        raise InputError("--format", f"is {figure_format!r}", did_you_mean(figure_format, ("png", "svg", "pdf")))
    conditions = Conditions(
        motion=motion, amplitude_mm=amplitude_mm, start=start, push_N=push_n, direction=direction, angle_deg=angle_deg,
        speed_mm_s=speed_mm_s, height_m=height_m, wheels_gripping=wheels_of(wheels_gripping), cable=cable,
        wheel_rate_rad_s=wheel_rate_rad_s, yaw_rate_deg_s=yaw_rate_deg_s, speed_m_s=speed_m_s,
    )  # fmt: skip
    request = Request(
        experiment_of(experiment), conditions, duration_s=duration_s, rate_hz=rate_hz, effects=tuple(effect or ()),
        contact=contact,
    )  # fmt: skip
    axes = [axis_of(text) for text in over or ()]
    points = points_of(params, axes, request, repeats, effects or ())
    with progress("simulating", hidden=quiet or as_json) as step:
        found = sweep(axes, points, output, workers, step)
    files = write(found, output, figure_format)
    if as_json:
        table = {"runs": list(found.rows), "reused": found.reused, "files": [str(file) for file in files]}
        print(json.dumps(table, ensure_ascii=False))
    elif not quiet:
        print(found)
        there = f", {found.reused} of them from an earlier call" if found.reused else ""
        print(f"\n{len(found.rows)} runs{there}: logs in {output / 'runs'}; {', '.join(file.name for file in files)}")
