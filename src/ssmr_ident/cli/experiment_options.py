"""Options that say what the simulator is asked to do, shared by the verbs that run it."""

from __future__ import annotations

from typing import Annotated

import typer

from ssmr_ident.cli import completion

Params = Annotated[
    str,
    typer.Argument(
        help="Parameter file, or a bundled robot: p3at-extended, p3at-platform.", autocompletion=completion.robots
    ),
]
Motion = Annotated[str, typer.Option(help="Free response: roll, pitch or yaw.")]
AmplitudeMm = Annotated[
    float, typer.Option(help="Free response: displacement at the start, of the wheels or a rig's mass.")
]
AmplitudeDeg = Annotated[float, typer.Option(help="Free response of a rotary rig: angle at the start.")]
Start = Annotated[
    str,
    typer.Option(
        help="Free response: tilted about the CoM, which strains all springs, or vertical: as the thesis pushes, "
        "vertical springs only."
    ),
]
PushN = Annotated[
    float,
    typer.Option("--push-N", help="Free response: pushed by this force and let go, instead of --amplitude-mm."),
]
At = Annotated[
    str, typer.Option(help="Network: body that is driven (left out: the first), or pushed and let go (the last).")
]
Direction = Annotated[str, typer.Option(help="Pull: lateral or longitudinal.")]
AngleDeg = Annotated[
    float | None, typer.Option(help="Pull: from straight behind (0) to the left (90), instead of --direction.")
]
SpeedMmS = Annotated[float, typer.Option(help="Pull, drag, compression: speed of the head.")]
HeightM = Annotated[float, typer.Option(help="Pull: height of the cable above the floor.")]
WheelsGripping = Annotated[str, typer.Option(help="Pull: wheels that grip, such as 1,2.")]
Cable = Annotated[str, typer.Option(help="Pull: steel or rope.")]
WheelRateRadS = Annotated[float, typer.Option(help="Pull: spinning wheels, the robot held in place.")]
YawRateDegS = Annotated[float, typer.Option(help="Swivel: wanted yaw rate.")]
SpeedMS = Annotated[float, typer.Option(help="Straight: wanted speed.")]
KpVRad = Annotated[
    float,
    typer.Option(
        "--kp-V-rad", help="Rig with a drive: gain of a controller; the log has its goal, position_reference."
    ),
]
LimitV = Annotated[float, typer.Option("--limit-V", help="The most that this controller gives, either way.")]
Contact = Annotated[
    str | None,
    typer.Option(
        help="Law of the contacts, instead of the file's: printed_6_4 (the thesis' to the letter), relay or cone.",
        autocompletion=completion.contacts,
    ),
]
EffectIds = Annotated[
    list[str] | None,
    typer.Option(
        metavar="ID[:KEY=VALUE,...]",
        help="Physics beside the file's, nominal where no value is given; ident effects lists it.",
        autocompletion=completion.effect_ids,
    ),
]
DurationS = Annotated[float | None, typer.Option(help="Length of the recording.")]
RateHz = Annotated[float | None, typer.Option(help="Samples per second.")]
