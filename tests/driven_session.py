"""A rig's session as its files' texts: one driven log, for what is changed in it by tests of what may stand there."""

from __future__ import annotations

from pathlib import Path

SESSION = """\
schema: ssmr-ident/session/1
name: s
robot: rig.yaml
baseline: sdof
recordings:
  - file: log.csv
    experiment: forced
    channels: {force: F, acceleration: a}
"""
PLAIN = """\
schema: ssmr-ident/parameters/1
name: r
mass_kg: {value: 8.0, std: 0.1, unit: kg}
stiffness_N_m: {value: 20000, std: 2000, unit: N/m}
damping_N_s_m: {value: 50, unit: N s/m}
"""
RIG = PLAIN + "effects: {nonlinear_stiffness: {k3_N_m3: {value: 6.0e+8, unit: N/m^3}}}\n"
LOG = "time [s],F [N],a [m/s^2]\n" + "".join(f"{i / 1000},{(i % 7) - 3.0},{(i % 5) - 2.0}\n" for i in range(300))


def written(folder: Path, session: str = SESSION, rig: str = RIG, log: str = LOG) -> Path:
    """The folder, with the three files in it."""
    for name, text in (("session.yaml", session), ("rig.yaml", rig), ("log.csv", log)):
        (folder / name).write_text(text, encoding="utf-8")
    return folder
