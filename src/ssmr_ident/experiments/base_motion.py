"""Base motion: a shaker table moves the foot of a rig; its motion is logged, and the mass' absolute acceleration."""

from ssmr_ident.experiments.experiment import BASES, RIGS, Drive, Experiment, Likelihood
from ssmr_ident.session.entry import MOTIONS

BASE_MOTION = Experiment(
    name="base_motion",
    sentence="A rig on a foot that is moved; what the foot does is logged beside what the mass does.",
    verb="Shake",
    drive=Drive.BASE,
    channels=(BASES, MOTIONS),
    likelihood=Likelihood.WAVEFORM,
    baselines=RIGS,
    nuisances=("the state at the start", "zeros of the sensors", "gain of a second accelerometer"),
    file_words=("table", "base", "shaketable", "floor"),
)
