"""Which recordings show an effect: its own experiments are simulated with and without it, and the clearest are drawn.

Nothing here is written for one effect, but for two: translation coupling is what the simulator always has, so its
"without" is the linear model of pure rotations; and slip coupling needs a robot whose file does not have it yet.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from ssmr_ident.experiments import EXPERIMENTS, FREE_RESPONSE, PULL, STRAIGHT, SWIVEL, Experiment, Scenario
from ssmr_ident.experiments.experiment import ACCELERATIONS
from ssmr_ident.experiments.free_response import free_response
from ssmr_ident.experiments.pull import pull
from ssmr_ident.experiments.straight import straight
from ssmr_ident.experiments.swivel import swivel
from ssmr_ident.physics.effect import Effect, Site
from ssmr_ident.physics.element import STATES, element_advance, element_force
from ssmr_ident.physics.linear import LinearRobot, accelerometer_rows, linear_robot, responses
from ssmr_ident.physics.motor import wheel_rates
from ssmr_ident.physics.rig import Rig
from ssmr_ident.physics.robot import GRAVITY, Robot, robot_from_parameters
from ssmr_ident.physics.slots import effect_vector
from ssmr_ident.report import style
from ssmr_ident.report.effect_figure import Curve, Panel
from ssmr_ident.session import read_parameters
from ssmr_ident.signals.spectra import amplitude_spectrum, power_density
from ssmr_ident.simulate import Simulation, simulate
from ssmr_ident.simulate.rig import simulate_rig

RATE = 1000.0
MOTIONS = ("roll", "pitch", "yaw")
AMPLITUDES = (0.3e-3, 1e-3, 4e-3)  # m at the wheels: gentle, usual, large enough to slide and to lift wheels
CLEAR = 0.15  # share of the motion that a difference must have to be seen by eye
SPEEDS = (20.0, 50.0)  # deg/s asked for
SWING = 3e-3  # m, of a single tire
FAINT = 0.03  # share of a pull's scatter below which a difference cannot be seen
SETTLE = 3.0  # s after which a swivel is steady

Values = Mapping[str, float]


def panels(effect: Effect, values: Values) -> tuple[Panel, ...]:
    """At most four panels from the first experiments of the effect that the robot's simulator can do.

    Parameters
    ----------
    effect : Effect
    values : mapping of parameter to float
        Complete.
    """
    robot = robot_from_parameters(read_parameters("p3at-extended"))
    if effect.id == "translation_coupling":
        return _coupling_panels(robot)
    if effect.id == "slip_coupling":
        robot = robot.with_changes(slip_coupling=0.0)
    found: list[Panel] = []
    for name in effect.experiments:
        if len(found) < 4:
            found += _PANELS.get(EXPERIMENTS[name], _none)(robot, effect, values)
    if Site.ELEMENT in effect.acts:  # decay, what drifts along it, and the law itself
        return (*found[:3], _loop_panel(robot, effect, values))
    return tuple(found[:4])


def _pair(robot: Robot, scenario: Scenario, effect: Effect, values: Values) -> tuple[Simulation, Simulation]:
    return simulate(robot, scenario, RATE), simulate(robot, scenario, RATE, effects={effect.id: values})


def _decay_panels(robot: Robot, effect: Effect, values: Values) -> list[Panel]:
    """The gentlest release, and there the motion and channel, where the effect is clear to the eye."""
    best: tuple[float, str, float, str, Simulation, Simulation] | None = None
    for amplitude in AMPLITUDES:
        for motion in MOTIONS:
            plain, changed = _pair(robot, free_response(motion, amplitude, 3.0), effect, values)
            size = np.sqrt(sum(np.var(plain[name]) for name in ACCELERATIONS))
            for name in ACCELERATIONS:
                score = float(np.sqrt(np.mean((changed[name] - plain[name]) ** 2)) / size)
                if best is None or score > best[0]:
                    best = (score, motion, amplitude, name, plain, changed)
        if best is not None and best[0] > CLEAR:
            break
    assert best is not None
    _, motion, amplitude, name, plain, changed = best
    label = style.axis_text(name, "m/s^2")
    title = f"{motion} let go from {amplitude * 1e3:g} mm"
    until = plain.time <= 1.5
    course = Panel(
        title,
        "time [s]",
        label,
        (
            Curve(plain.time[until], plain[name][until], "without", "without"),
            Curve(changed.time[until], changed[name][until], "with", look="thin"),
        ),
    )
    if Site.ELEMENT in effect.acts:
        return [course, *_drift_panels(robot, effect, values)]
    curves = []
    for result, role in ((plain, "without"), (changed, "with")):
        spectrum = amplitude_spectrum(result[name] - result[name].mean(), RATE)
        shown = (spectrum.frequency > 0.5) & (spectrum.frequency < 50.0)
        curves.append(Curve(spectrum.frequency[shown], spectrum.amplitude[shown], role, role))
    return [course, Panel("its spectrum", "frequency [Hz]", label, tuple(curves), logarithmic=True)]


def _drift_panels(robot: Robot, effect: Effect, values: Values) -> list[Panel]:
    """Frequency and damping over amplitude of one tire that carries a quarter of the robot and is let go.

    A single mass has a single line, so each cycle can be measured on its own; on the robot two modes overlap.
    """
    frequency, damping = [], []
    rig = Rig(robot.mass / 4.0, float(robot.damping[1]), float(robot.stiffness[1]))
    for effects, role in (({}, "without"), ({effect.id: values}, "with")):
        motion = simulate_rig(rig, np.zeros(round(2.0 * RATE)), RATE, position=SWING, effects=effects)
        amplitude, hertz, ratio = cycles(motion[:, 0], RATE)
        frequency.append(Curve(1e3 * amplitude, hertz, role, role, "points"))
        damping.append(Curve(1e3 * amplitude, 100.0 * ratio, role, role, "points"))
    title = "one tire under a quarter of the robot, by cycle"
    return [
        Panel(title, "amplitude [mm]", "frequency [Hz]", tuple(frequency)),
        Panel(title, "amplitude [mm]", "damping ratio [%]", tuple(damping)),
    ]


def cycles(course: np.ndarray, rate: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Amplitude, frequency and damping ratio of each full cycle of a decay.

    Parameters
    ----------
    course : (n,) float
    rate : float [Hz]

    Returns
    -------
    (k,) float in the unit of the course, (k,) float [Hz], (k,) float [1]
        Half the swing of each cycle; one over the time between its maxima, each placed by a parabola; and
        ln(swing of this / swing of the next) / 2π. It ends where a swing is below 2 % of the first.
    """
    inner = course[1:-1]
    tops = np.flatnonzero((inner > course[:-2]) & (inner >= course[2:])) + 1
    lows = np.flatnonzero((inner < course[:-2]) & (inner <= course[2:])) + 1
    bend = course[tops - 1] - 2 * course[tops] + course[tops + 1]
    exact = tops + 0.5 * (course[tops - 1] - course[tops + 1]) / bend
    swing = []
    for top in tops:
        after = lows[lows > top]
        if not len(after):
            break
        swing.append(0.5 * (course[top] - course[after[0]]))
    size = np.array(swing)
    if len(size) < 3:
        return np.zeros(0), np.zeros(0), np.zeros(0)
    size = size[: int(np.argmax(size < 0.02 * size[0])) or len(size)]
    steps = len(size) - 1
    return size[:-1], rate / np.diff(exact[: steps + 1]), np.log(size[:-1] / size[1:]) / (2 * np.pi)


def _pull_panels(robot: Robot, effect: Effect, values: Values) -> list[Panel]:
    """The pull, sideways, lengthwise or sideways with spinning wheels, that the effect changes most."""
    spinning = np.full((1, 2), 0.003 / robot.radius)
    candidates = {
        "pulled sideways at 1 mm/s": pull("lateral", 1.0, 12.0),
        "pulled backwards at 1 mm/s": pull("longitudinal", 1.0, 20.0),
        "pulled sideways, wheels slipping at 3 mm/s": pull("lateral", 1.0, 12.0, wheel_rates=spinning, held=True),
    }
    scored = []
    for title, scenario in candidates.items():
        plain, changed = _pair(robot, scenario, effect, values)
        difference = np.sqrt(np.mean((changed["force"] - plain["force"]) ** 2)) / plain["force"].std()
        scored.append((float(difference), title, plain, changed))
        if len(scored) == 2 and max(scored, key=lambda row: row[0])[0] > FAINT:
            break  # spinning wheels only where nothing else shows it
    score, title, plain, changed = max(scored, key=lambda row: row[0])
    if score == 0.0:
        return []
    curves = (
        Curve(1e3 * plain["head"], plain["force"], "without", "without"),
        Curve(1e3 * changed["head"], changed["force"], "with", look="thin"),
    )
    return [Panel(title, "travel of the head [mm]", "force [N]", curves)]


def _swivel_panels(robot: Robot, effect: Effect, values: Values) -> list[Panel]:
    """Power densities at two speeds, of the channel that changes most: how a line moves with speed is its mark."""
    runs = [_pair(robot, swivel(wheel_rates(robot, 0.0, np.deg2rad(speed)), 20.0), effect, values) for speed in SPEEDS]
    return _density_panels(runs, [f"swivel, {speed:g}°/s wanted" for speed in SPEEDS])


def _straight_panels(robot: Robot, effect: Effect, values: Values) -> list[Panel]:
    speeds = (0.3, 0.6)  # m/s
    runs = [_pair(robot, straight(wheel_rates(robot, speed, 0.0), 20.0), effect, values) for speed in speeds]
    return _density_panels(runs, [f"straight on at {speed:g} m/s" for speed in speeds])


def _density_panels(runs: list[tuple[Simulation, Simulation]], titles: list[str]) -> list[Panel]:
    first = round(SETTLE * RATE)

    def density(result: Simulation, name: str) -> tuple[np.ndarray, np.ndarray]:
        found = power_density(result[name][first:], RATE, band_hz=(0.25, 50.0), width_hz=0.25)
        return found.frequency, found.density

    def change(name: str) -> float:
        """Mean square of the log ratio, over what is not far below the strongest line of any channel."""
        both = np.array([[density(result, name)[1] for result in pair] for pair in runs])
        return float(np.mean(np.diff(np.log(np.maximum(both, floor)), axis=1) ** 2))

    floor = 1e-6 * max(density(result, name)[1].max() for pair in runs for result in pair for name in ACCELERATIONS)

    name = max(ACCELERATIONS, key=change)
    if change(name) == 0.0:
        return []
    label = f"{style.quantity_text(name)} [(m/s²)²/Hz]"
    return [
        Panel(
            title,
            "frequency [Hz]",
            label,
            (
                Curve(*density(plain, name), "without", "without"),
                Curve(*density(changed, name), "with"),
            ),
            logarithmic=True,
        )
        for title, (plain, changed) in zip(titles, runs, strict=True)
    ]


def _loop_panel(robot: Robot, effect: Effect, values: Values) -> Panel:
    """Force of one tire's lateral spring without its damper, over its deflection, at two frequencies."""
    amplitude = SWING
    e = effect_vector({effect.id: values})
    stiffness = float(robot.stiffness[1])
    deflection = np.linspace(-amplitude, amplitude, 50)
    curves = [Curve(1e3 * deflection, stiffness * deflection, "without", "without")]
    for hertz, role in ((1.0, "with"), (10.0, "more")):
        step = 1.0 / (hertz * 2000)
        z = np.zeros(STATES)
        rows = np.empty((4000, 2))
        for n in range(len(rows)):
            s = amplitude * np.sin(np.pi * n / 1000)
            v = 2 * np.pi * hertz * amplitude * np.cos(np.pi * n / 1000)
            rows[n] = s, stiffness * s + element_force(s, v, z, stiffness, 1.0, 1.0, True, e)
            element_advance(z, 2 * np.pi * hertz * amplitude * np.cos(np.pi * (n + 0.5) / 1000), step, True, e)
        rows = rows[2000:]
        curves.append(Curve(1e3 * rows[:, 0], rows[:, 1], f"with, {hertz:g} Hz", role, "line" if hertz < 5 else "thin"))
    return Panel("its spring alone, driven", "deflection [mm]", "force [N]", tuple(curves))


def _coupling_panels(robot: Robot) -> tuple[Panel, ...]:
    """Pure rotations (5.3) beside the coupled motion, both from the linear model."""
    coupled = linear_robot(robot)
    stiffness, damping, mass = coupled.stiffness.copy(), coupled.damping.copy(), coupled.mass.copy()
    for matrix in (stiffness, damping):
        matrix[:3, 3:] = matrix[3:, :3] = 0.0
        matrix[3:, 3:] = np.diag(np.diag(matrix[3:, 3:]))
    height = robot.height
    stiffness[3, 3] += robot.mass * GRAVITY * height  # (5.3) leaves the weight out
    stiffness[4, 4] += robot.mass * GRAVITY * height
    mass[3:, 3:] = np.diag(np.diag(mass[3:, 3:]))
    pure = LinearRobot(mass, damping, stiffness)
    time = np.arange(2000) / RATE
    found = []
    for axis, name, motion in ((3, "ay", "roll"), (4, "ax", "pitch")):
        curves, lines = [], []
        for model, role, label in ((pure, "without", "pure rotation (5.3)"), (coupled, "with", "with translation")):
            rows = accelerometer_rows(model, robot.accelerometer.position, GRAVITY)
            course = 0.3e-3 / 0.18 * responses(model.state_matrix, rows, time)[:, ACCELERATIONS.index(name), axis]
            curves.append(Curve(time, course, label, role, "line" if role == "without" else "thin"))
            spectrum = amplitude_spectrum(course, RATE)
            shown = (spectrum.frequency > 0.5) & (spectrum.frequency < 40.0)
            lines.append(Curve(spectrum.frequency[shown], spectrum.amplitude[shown], label, role))
        label = style.axis_text(name, "m/s^2")
        found.append(Panel(f"{motion} let go", "time [s]", label, tuple(curves)))
        found.append(Panel("its spectrum", "frequency [Hz]", label, tuple(lines), logarithmic=True))
    return tuple(found)


def _none(robot: Robot, effect: Effect, values: Values) -> list[Panel]:
    """Of a bench or a rig nothing is drawn: what is shown is the robot."""
    return []


_PANELS: dict[Experiment, Callable[[Robot, Effect, Values], list[Panel]]] = {
    FREE_RESPONSE: _decay_panels,
    PULL: _pull_panels,
    SWIVEL: _swivel_panels,
    STRAIGHT: _straight_panels,
}
