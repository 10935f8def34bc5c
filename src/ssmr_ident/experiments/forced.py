"""Forced: a shaker, a motor or a hand drives a rig; its force, torque or voltage is logged beside the motion."""

from ssmr_ident.experiments.experiment import RIGS, Drive, Experiment, Likelihood
from ssmr_ident.session.entry import MOTIONS

FORCED = Experiment(
    name="forced",
    sentence="A rig driven by a measured force or torque, or by a motor of known voltage.",
    verb="Shake",
    drive=Drive.FORCE,
    channels=(("force", "torque", "voltage"), MOTIONS),
    likelihood=Likelihood.WAVEFORM,
    baselines=RIGS,
    nuisances=("the state at the start", "zeros of force and sensors", "gain of a second accelerometer"),
    file_words=("forced", "shaker", "sweep", "chirp", "noise", "sine", "prbs"),
)
