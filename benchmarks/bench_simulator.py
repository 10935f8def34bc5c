"""How fast is the simulator? Steps per second against MuJoCo, 20 s of swivel, ``ident simulate``, memory of a run, and
what many runs at once save over one after the other.

Run it as ``python benchmarks/bench_simulator.py [ROUNDS]``. Everything is measured in one run, the engines in turn,
and the medians are printed; one thread each. Without MuJoCo (extra ``proof``) its rows are left out. Nothing here
judges: the figures depend on the machine, the ratios less so.

MuJoCo gets four models of the robot. ``springs`` is the same robot, 22 coordinates, with the contact as stiff as the
comparison of docs/theory/mujoco.md needs; ``springs, plain`` the same with the engine's own soft contact and quicker
solver; ``rigid`` and ``rigid, plain`` leave the tires' springs out: 10 coordinates, another and much simpler robot.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.simd import WIDTH
from ssmr_ident.experiments.scenario import Scenario
from ssmr_ident.experiments.swivel import swivel
from ssmr_ident.physics.motor import wheel_rates
from ssmr_ident.physics.robot import Robot, robot_from_parameters
from ssmr_ident.session import read_parameters
from ssmr_ident.simulate import simulate
from ssmr_ident.simulate.many import Release, simulate_alike, simulate_many

STEP = 2e-5  # s
YAW_RATE = np.radians(45.0)
SIX = {
    "six, light": (
        "coriolis", "wheel_lift", "stribeck", "load_sensitive_friction", "rolling_resistance", "motor_belt",
    ),
    "six, typical": ("coriolis", "wheel_lift", "stribeck", "nonlinear_stiffness", "flexible_mast", "ground_joints"),
    "six, the heaviest": (
        "dry_friction", "hysteresis", "viscoelastic_relaxation", "free_play", "stribeck", "ground_roughness",
    ),
}  # fmt: skip
Runner = Callable[[], float]


def ours(robot: Robot, effects: tuple[str, ...], seconds: float) -> Runner:
    """A swivel of ``seconds`` whose call returns its steps per second."""
    scenario = swivel(wheel_rates(robot, 0.0, YAW_RATE), seconds)

    def run() -> float:
        begin = time.perf_counter()
        simulate(robot, scenario, 1000.0, STEP, {name: {} for name in effects})
        return seconds / STEP / (time.perf_counter() - begin)

    return run


def theirs(robot: Robot, tires: str, plain: bool, steps: int) -> Runner:
    """The same swivel in MuJoCo, all steps in one call into the engine, so that no time is Python's."""
    from ssmr_ident.simulate.mjcf.bodies import start
    from ssmr_ident.simulate.mjcf.build import WHEELS, Build
    from ssmr_ident.simulate.mjcf.robot import mjcf
    from ssmr_proof.mujoco_run import engine

    mujoco = engine()
    build = Build(tires=tires, driven=True, plain=plain, step=STEP)
    model = mujoco.MjModel.from_xml_string(mjcf(robot, build))
    rates = wheel_rates(robot, 0.0, YAW_RATE)

    def run() -> float:
        data = mujoco.MjData(model)
        data.qpos[:] = start(robot, build, {})
        for name in WHEELS:
            data.actuator(name).ctrl[0] = rates[0 if name.endswith("left") else 1]
        begin = time.perf_counter()
        mujoco.mj_step(model, data, steps)
        return steps / (time.perf_counter() - begin)

    return run


def alternate(runners: dict[str, Runner], rounds: int) -> dict[str, float]:
    """Median of each, measured in turn so that what else the machine does meets all alike."""
    for run in runners.values():
        run()
    measured: dict[str, list[float]] = {name: [] for name in runners}
    for _ in range(rounds):
        for name, run in runners.items():
            measured[name].append(run())
    return {name: float(np.median(values)) for name, values in measured.items()}


def steps_per_second(robot: Robot, rounds: int) -> None:
    runners = {"all effects off": ours(robot, (), 4.0)}
    runners |= {name: ours(robot, effects, 2.0) for name, effects in SIX.items()}
    mine = list(runners)
    try:
        for tires in ("strut", "rigid"):
            for plain in (False, True):
                label = f"MuJoCo {'springs' if tires == 'strut' else 'rigid'}{', plain' if plain else ''}"
                runners[label] = theirs(robot, tires, plain, 20_000)
    except InputError as error:
        print(f"MuJoCo left out: {error}")
    medians = alternate(runners, rounds)
    foreign = [name for name in runners if name not in mine]
    print(f"steps per second of a swivel at {STEP * 1e6:g} µs, median of {rounds} rounds in turn, one thread")
    for name in foreign:
        print(f"  {name:<24}{medians[name]:>12,.0f}")
    head = "".join(f"{name.removeprefix('MuJoCo '):>16}" for name in foreign)
    print(f"  {'':<24}{'steps/s':>12}{head}" + ("   (times MuJoCo)" if foreign else ""))
    for name in mine:
        ratios = "".join(f"{medians[name] / medians[other]:>15.1f}×" for other in foreign)
        print(f"  {name:<24}{medians[name]:>12,.0f}{ratios}")


def twenty_seconds(robot: Robot, rounds: int) -> None:
    run = ours(robot, (), 20.0)
    times = sorted(20.0 / STEP / run() for _ in range(rounds))
    print(f"20 s of swivel at 20 µs: median {np.median(times):.3f} s, best {times[0]:.3f} s, worst {times[-1]:.3f} s")


def eight_at_once(robot: Robot, rounds: int) -> None:
    """Decays and pulls in lanes over the same one by one, which gives the same bits."""
    random = np.random.default_rng(1)
    count, head = 4 * WIDTH, np.linspace(0.0, 0.03, 1500)
    print(f"{count} runs in one call over one after the other, median of {rounds} rounds in turn, one thread")
    for effects in ({}, {"nonlinear_stiffness": {"k3_N_m3": 1e8}}, {"dry_friction": {}}, {"hysteresis": {}}):
        releases = [
            Release(robot, effects, 1e-3 * random.standard_normal(12), 0.05 * random.standard_normal(8))
            for _ in range(count)
        ]
        name = f"decays, {next(iter(effects), 'all effects off')}"
        _compared(name, lambda some: simulate_many(some, 2.0, 500.0, 2.5e-4, ("ax", "ay")), releases, rounds)
    for law, speed in (("relay", 0.0), ("cone", 0.01)):
        pulls = [
            (
                replace(robot, sliding_speed=speed),
                {},
                Scenario("pull", 15.0, head=np.maximum(head - slack, 0.0), head_step=0.01, height=0.2),
            )
            for slack in 1e-3 * random.random(count)
        ]
        _compared(f"pulls, {law}", lambda some: simulate_alike(some, 100.0, 2e-3, ("force",)), pulls, rounds)


def _compared(name: str, together: Callable[[list], np.ndarray], asked: list, rounds: int) -> None:
    def timed(parts: list[list]) -> Runner:
        def run() -> float:
            begin = time.perf_counter()
            for part in parts:
                together(part)
            return time.perf_counter() - begin

        return run

    medians = alternate({"alone": timed([[one] for one in asked]), "at once": timed([asked])}, rounds)
    print(f"  {name:<28}{medians['alone'] / medians['at once']:>6.1f}×")


def whole_process(rounds: int) -> None:
    """``ident simulate`` from the shell, interpreter, imports, 20 s of swivel and the written log included."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "ssmr_ident", "simulate", "p3at-extended", "-e", "swivel", "-q"]
        command += ["-o", str(Path(folder) / "swivel.csv")]
        times = []
        for _ in range(rounds + 1):
            begin = time.perf_counter()
            subprocess.run(command, check=True)
            times.append(time.perf_counter() - begin)
        first, warm = times[0], sorted(times[1:])
    print(f"ident simulate, 20 s of swivel: first {first:.2f} s, warm median {np.median(warm):.2f} s")


MEMORY = """
import resource, sys
from ssmr_ident.physics.motor import wheel_rates
from ssmr_ident.physics.robot import robot_from_parameters
from ssmr_ident.session import read_parameters
from ssmr_ident.simulate import simulate
from ssmr_ident.experiments.swivel import swivel
robot = robot_from_parameters(read_parameters("p3at-extended"))
scenario = swivel(wheel_rates(robot, 0.0, 0.8), 2.0)
simulate(robot, scenario, 1000.0)
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
simulate(robot, scenario, 1000.0, float(sys.argv[1]))
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
"""


def memory() -> None:
    """Growth of a process' peak over a run that stores 2000 samples, for 10 and for 1000 steps a sample."""
    unit = 1 if sys.platform == "darwin" else 1024
    for step in (1e-4, 1e-6):
        answer = subprocess.run([sys.executable, "-c", MEMORY, str(step)], check=True, capture_output=True, text=True)
        grown = int(answer.stdout) * unit / 1e6
        print(f"memory: {2.0 / step:>9,.0f} steps, 2000 samples (0.37 MB): the peak grows by {grown:.2f} MB")


def main() -> None:
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 7
    robot = robot_from_parameters(read_parameters("p3at-extended"))
    steps_per_second(robot, rounds)
    twenty_seconds(robot, rounds)
    eight_at_once(robot, rounds)
    whole_process(rounds)
    memory()


if __name__ == "__main__":
    main()
