"""Wheel drag: a testing machine drags one wheel sideways over a surface, under a quarter of the robot's weight."""

from ssmr_ident.experiments.experiment import ROBOT, Drive, Experiment, Likelihood

WHEEL_DRAG = Experiment(
    name="wheel_drag",
    sentence="One wheel, or a block, dragged sideways over a surface by a testing machine.",
    verb="Drag",
    drive=Drive.HEAD,
    channels=(("force",),),
    likelihood=Likelihood.FORCE,
    baselines=(*ROBOT, "drag"),
    nuisances=("slack before it tightens", "zero of the load cell"),
    file_words=("drag",),
    duration=16.0,
    sample_rate=100.0,
    wheel_axis="y",
)
