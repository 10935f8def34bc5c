"""mujoco.sysid on the rig: a body on a sliding joint, fitted by MuJoCo's own toolbox."""

from __future__ import annotations

import contextlib
import io
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.experiments.campaign import Campaign
from ssmr_ident.physics.rig import rig_from_parameters
from ssmr_proof.mujoco_run import engine
from ssmr_proof.peers.answer import PeerAnswer, drive_and_motion

RANGE = 4.0
"""Bounds of each parameter: a quarter to four times what the user says."""

SENSORS = {"position": "jointpos", "velocity": "jointvel", "acceleration": "accelerometer"}
_RIG = """
<mujoco model="rig">
  <option timestep="{step}" integrator="RK4" gravity="0 0 0"><flag contact="disable"/></option>
  <worldbody>
    <body name="mass">
      <inertial pos="0 0 0" mass="{mass}" diaginertia="1 1 1"/>
      <joint name="slide" type="slide" axis="1 0 0" stiffness="{stiffness}" damping="{damping}"/>
      <site name="sensor"/>
    </body>
  </worldbody>
  <actuator><motor name="push" joint="slide"/></actuator>
  <sensor>{sensor}</sensor>
</mujoco>
"""


def mujoco_sysid(campaign: Campaign) -> PeerAnswer:
    """Mass, damper and spring by ``mujoco.sysid.optimize``; its claims are those of its own report's insights.

    Recordings start at rest, as the toolbox takes them, and their means are taken off; the force acts at twice the
    sampling rate. MuJoCo's sensors are read before a step and stamped after it: the recordings' times are moved by
    that one step.
    """
    try:
        from mujoco import sysid
        from mujoco.sysid.report.sections.insights import AutomatedInsights
    except ImportError:
        raise InputError("mujoco.sysid", "is not installed", "pip install 'ssmr_ident[peers]'") from None
    mujoco = engine()
    begin = time.perf_counter()
    quantity, targets = drive_and_motion(campaign)
    told = rig_from_parameters(campaign.parameters)
    step = 0.5 / targets[0].recording.sample_rate
    about = 'site="sensor"' if quantity == "acceleration" else 'joint="slide"'
    sensor = f'<{SENSORS[quantity]} name="out" {about}/>'
    xml = _RIG.format(step=step, mass=told.mass, stiffness=told.stiffness, damping=told.damping, sensor=sensor)
    spec = mujoco.MjSpec.from_string(xml)
    model = spec.compile()
    data = mujoco.MjData(model)
    start = sysid.create_initial_state(model, data.qpos, data.qvel, data.act)
    controls, sensed = [], []
    for measurement in targets:
        record = measurement.recording
        times = record.time - record.time[0]
        controls.append(sysid.TimeSeries(times, (record["force"] - record["force"].mean())[:, None]))
        output = record[quantity] - record[quantity].mean()
        columns = np.column_stack([output] + [np.zeros_like(output)] * (2 if quantity == "acceleration" else 0))
        sensed.append(sysid.TimeSeries.from_names(times + step, columns, model))
    known = {"mass": told.mass, "damping": told.damping, "stiffness": told.stiffness}
    parameters = sysid.ParameterDict()
    for name, value in known.items():
        parameters.add(
            sysid.Parameter(name, nominal=value, min_value=value / RANGE, max_value=value * RANGE, modifier=_set(name))
        )
    names = [measurement.name for measurement in targets]
    sequences = sysid.ModelSequences("rig", spec, names, [start] * len(targets), controls, sensed)
    # an accelerometer has three axes, of which two stay at zero: those would be divided by their own size
    own = {"modify_residual": partial(_along, sysid)} if quantity == "acceleration" else {}
    residual = sysid.build_residual_fn(models_sequences=[sequences], n_threads=1, **own)
    with contextlib.redirect_stdout(io.StringIO()):  # its optimiser reports every iteration
        found, result = sysid.optimize(initial_params=parameters, residual_fn=residual, verbose=False, max_iters=30)
    residuals, _, _ = residual(result.x, found)
    _, half = sysid.calculate_intervals(residuals, result.jac)
    insights = AutomatedInsights("insights", found).get_context()["insights"]
    claims = tuple(i["title"] for i in insights if i["type"] == "warning")
    values = found.as_vector()
    table = {
        key: (float(value), float(width))
        for key, value, width in zip(("mass_kg", "damping_N_s_m", "stiffness_N_m"), values, half, strict=True)
    }
    return PeerAnswer("mujoco.sysid", claims, (), bool(claims), time.perf_counter() - begin, table)


def _along(
    sysid: Any, parameters: Any, predicted: Any, measured: Any, model: Any, return_all: Any, state: Any = None, **_: Any
) -> tuple[Any, Any, Any]:
    """The toolbox's own residual, on the first axis alone."""
    seen = sysid.apply_delayed_ts_window(measured, predicted, 0.0, 0.0)
    simulated = sysid.TimeSeries(seen.times, predicted.resample(seen.times).data, seen.signal_mapping)
    rest = sysid.weighted_diff(
        predicted_data=simulated.data[:, :1], measured_data=seen.data[:, :1], model=model, sensor_weights=None
    )
    return sysid.normalize_residual(rest, seen.data[:, :1]), simulated, seen


def _set(name: str) -> Callable[[Any, Any], None]:
    """How a parameter gets into MuJoCo's model."""

    def modify(spec: Any, parameter: Any) -> None:
        value = float(parameter.value[0])
        if name == "mass":
            spec.body("mass").mass = value
        else:  # the polynomial of MuJoCo's joints: linear part first
            setattr(spec.joint("slide"), name, np.array([[value], [0.0], [0.0]]))

    return modify
