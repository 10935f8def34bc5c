"""Test bench: what kinds of experiment there are, one file each, and a session with its logs read.

No other room compares the names of experiments. What depends on the kind asks the `Experiment` itself, in the field's
words:

- **what drives it** (`drive`): `free` systems swing by themselves, from a state that has to be found; `driven` ones
  follow a measured force, which tells the mass and keeps the phase, or the foot that they stand on (`on_a_base`), which
  keeps the phase alone; `on_a_testing_machine` a head moves and a load cell
  reads; `on_wheels` the robot drives itself;
- **by what it is compared** (`likelihood`, `repeats`): waveform, force or spectrum, and under which `baselines`;
- **one wheel or everything** (`of_one_wheel`, `vertical`, `drags_everything`): a tire on a bench has no body that
  swings on it;
- **how the wheels run** (`wheel_signs`, `turns`): against each other, or together;
- **what has to be logged** (`channels`), **what may be seen in it** (`shows`), **how the robot's simulator runs it**
  (`scenario`, `duration`, `sample_rate`; `effect_checks` to see what an effect does in it), **what hints at it in a
  file's name** (`file_words`), and what one tells a person to do (`verb`).

What only one upper room needs, such as the panels of a page, stands there in one table by `Experiment`. A new kind is a
file here, a line in `EXPERIMENTS`, and its name in the format of session.yaml (`session/session_file.py`).
"""

from ssmr_ident.experiments.base_motion import BASE_MOTION
from ssmr_ident.experiments.conditions import Conditions
from ssmr_ident.experiments.experiment import Drive, Experiment, Likelihood
from ssmr_ident.experiments.forced import FORCED
from ssmr_ident.experiments.free_response import FREE_RESPONSE
from ssmr_ident.experiments.pull import PULL
from ssmr_ident.experiments.scenario import Scenario
from ssmr_ident.experiments.straight import STRAIGHT
from ssmr_ident.experiments.swivel import SWIVEL
from ssmr_ident.experiments.vertical_compression import VERTICAL_COMPRESSION
from ssmr_ident.experiments.wheel_drag import WHEEL_DRAG

EXPERIMENTS: dict[str, Experiment] = {
    kind.name: kind
    for kind in (FREE_RESPONSE, SWIVEL, STRAIGHT, PULL, WHEEL_DRAG, VERTICAL_COMPRESSION, FORCED, BASE_MOTION)
}

__all__ = [
    "BASE_MOTION",
    "EXPERIMENTS",
    "FORCED",
    "FREE_RESPONSE",
    "PULL",
    "STRAIGHT",
    "SWIVEL",
    "VERTICAL_COMPRESSION",
    "WHEEL_DRAG",
    "Conditions",
    "Drive",
    "Experiment",
    "Likelihood",
    "Scenario",
]
