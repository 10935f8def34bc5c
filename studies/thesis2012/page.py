"""Write docs/theory/scoreboard.md and its figure: ``python -m thesis2012.page`` in studies/."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ssmr_ident.experiments.swivel import swivel
from ssmr_ident.physics.motor import wheel_rates
from ssmr_ident.physics.robot import GRAVITY, Robot, robot_from_parameters
from ssmr_ident.report import style
from ssmr_ident.report.effect_figure import Curve, Panel, effect_figure
from ssmr_ident.session import read_parameters
from ssmr_ident.signals.spectra import power_density
from ssmr_ident.simulate import simulate
from ssmr_ident.simulate.bench import drag_wheel
from thesis2012.pulls import even_axles
from thesis2012.scoreboard import Scoreboard, thesis_scoreboard
from thesis2012.swivels import SPEEDS, turn
from thesis2012.two_models import section

FOLDER = Path(__file__).resolve().parents[2] / "docs" / "theory"
LIMITS = ((1.0, "without"), (0.1, "with"), (0.01, "more"))  # λ_max and the colour of its curve

PREFACE = """# What the thesis says, and what is found here

Written by `python -m thesis2012.page` in studies/, which runs `thesis2012.scoreboard.thesis_scoreboard()`; the
golden test `tests/golden/test_scoreboard.py` pins the first column. The robot is the bundled `p3at-extended` with the
contact points of Table 5.1; forces over 225 N are those of `p3at-platform`.

"""

TURNING = """

## Why a swivel is not centred

![Turning](turning.png)

Chapter 4 makes a wheel's sideways grip μ_y = min(|tan θ|·μ_x, 1). While it is below 1 the grip grows with the sideways
speed, like a viscous damper: of two axles the one that skids faster brakes more, and the robot turns about its CoM.
That is λ_max = 1 (upper left, grey). For smaller λ_max the grip saturates at 1 and no longer depends on the sideways
speed. Then only the loads decide: Table 5.1 puts more weight on the front wheels (a = 0.15 m, b = 0.13 m), they hold,
and the rear axle skids around them (upper left, orange and blue).

`ssmr_ident.physics.planar_dynamics`, rigid wheels in the plane without any code of the simulator, turns about the same
points and at the same rates (`tests/unit/test_planar.py`): it is the friction law, not the integration.

Two more things were tried. With the kinetic friction term that the thesis drops from (6.4), nothing changes for the
axles of Table 5.1. With equal axles (a = b, as chapter 5 has it) and that term the turn stays where it started,
centred, from 45°/s on (upper right; below, stick-slip moves it). With equal axles and the thesis' own (6.4) it does
not: a contact that is released without friction holds the less the faster it is dragged (lower left), so the axle
that skids a little faster gives way more.

The statements of section 6.2 on lateral velocity and skid hold for λ_max = 1 only. Of the frequencies, the thesis'
order (the larger λ_max, the lower) holds for the stick-slip of the wheels, which lies above 50 Hz from 30°/s on (lower
right), and not for what remains below 50 Hz, where the thesis looks: the slow modes of the body.
"""


def figure(robot: Robot) -> None:
    """Four panels: where the robot turns about, twice; friction over drag speed; spectra of a_y."""
    panels = []
    for title, kind, drag in (
        ("thesis' (6.4), Table 5.1", robot, 0.0),
        ("kinetic term kept, a = b", even_axles(robot), 1.0),
    ):
        curves = []
        for limit, role in LIMITS:
            shifts = [100 * turn(kind, limit, speed, drag).shift for speed in SPEEDS]
            curves.append(Curve(np.array(SPEEDS), np.array(shifts), f"$λ_{{max}}$ = {limit:g}", role, "points"))
        panels.append(Panel(title, "yaw rate wanted [°/s]", "turns about, ahead of the CoM [cm]", tuple(curves)))
    speeds = np.array([0.005, 0.02, 0.05, 0.1, 0.15, 0.2, 0.3])
    held = np.array([_mean_friction(robot, float(speed)) for speed in speeds])
    curve = (Curve(speeds, held, "", "with", "points"),)
    panels.append(Panel("a wheel dragged sideways, (6.4)", "speed [m/s]", "mean force over load [–]", curve))
    densities = []
    for limit, role in LIMITS:
        scenario = swivel(wheel_rates(robot, 0.0, np.deg2rad(30.0)), 60.0)
        course = simulate(robot.with_changes(lambda_max=limit), scenario)["ay"][4000:]
        found = power_density(course, 1000.0, band_hz=(1.0, 200.0))
        densities.append(Curve(found.frequency, found.density, f"$λ_{{max}}$ = {limit:g}", role, "thin"))
    label = "$a_y$ [(m/s²)²/Hz]"
    panels.append(Panel("swivel, 30°/s wanted, (6.4), Table 5.1", "frequency [Hz]", label, tuple(densities), True))
    drawn = effect_figure("Swivelling", "About which point the simulated robot turns, and why.", panels)
    style.save(drawn, FOLDER / "turning", command="python -m thesis2012.page")


def _mean_friction(robot: Robot, speed: float) -> float:
    """Over the second half of a drag of 40 mm or 0.2 s."""
    steps = round(max(0.2, 0.04 / speed) / 1e-4)
    force = drag_wheel(robot, speed * 1e-4 * np.arange(steps), 1e-4)
    return float(force[steps // 2 :].mean() / (robot.mass * GRAVITY / 4))


def page(board: Scoreboard) -> str:
    """The whole page."""
    return f"{PREFACE}**{board.summary}.**\n\n{board.markdown()}\n{TURNING}\n{section()}"


if __name__ == "__main__":
    FOLDER.mkdir(parents=True, exist_ok=True)
    figure(robot_from_parameters(read_parameters("p3at-extended")))
    (FOLDER / "scoreboard.md").write_text(page(thesis_scoreboard()), encoding="utf-8")
    print(f"written to {FOLDER}")
