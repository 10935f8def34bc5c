"""Vertical compression: a testing machine presses one wheel down onto a plate."""

from ssmr_ident.experiments.experiment import ROBOT, Drive, Experiment, Likelihood

VERTICAL_COMPRESSION = Experiment(
    name="vertical_compression",
    sentence="One wheel pressed down by a testing machine: force over position.",
    verb="Press",
    drive=Drive.HEAD,
    channels=(("position",), ("force",)),
    likelihood=Likelihood.FORCE,
    baselines=ROBOT,
    nuisances=("gap before it touches", "zero of the load cell"),
    file_words=("compress", "compression", "press", "vertical"),
    sample_rate=100.0,
    wheel_axis="z",
)
