"""The leg identified by ``mujoco.sysid``: simulated angles and velocities are fitted to the log, as in its notebook.

Unknown are centre of mass and inertia of each link in its plane, friction, damping and armature. The masses stay those
of CAD: with a fixed base no motion shows them. The log is cut in pieces, each with a measured initial state, since a
simulated leg drifts away from the log in seconds. Its Jacobian gives the intervals (``calculate_intervals``).
"""

from __future__ import annotations

import contextlib
import io
import time
from collections.abc import Callable
from functools import partial

import mujoco
import numpy as np
import scipy.optimize
from absl import logging
from mujoco import sysid
from task import Log, Outcome, Task, states

from exoid._typing import FloatArray

SECONDS = 1.0
"""Length of a piece [s]; of 0.5, 1, 2 and 4 s it has the smallest errors of the torque."""
TIMESTEP = 0.005
"""Step of the simulation [s]."""
ITERATIONS = 8
"""Most iterations; more change the torques by less than a thousandth."""


# user: begins
def read(urdf: str) -> mujoco.MjSpec:
    """Read a URDF, and add motors and sensors to its joints."""
    spec = mujoco.MjSpec.from_string(urdf)
    spec.option.timestep, spec.option.integrator = TIMESTEP, mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_LIMIT
    for joint in spec.joints:
        motor = spec.add_actuator(name=f"{joint.name}_motor", target=joint.name)
        motor.trntype = mujoco.mjtTrn.mjTRN_JOINT
        for kind, sensor in (("pos", mujoco.mjtSensor.mjSENS_JOINTPOS), ("vel", mujoco.mjtSensor.mjSENS_JOINTVEL)):
            spec.add_sensor(
                name=f"{joint.name}_{kind}", type=sensor, objtype=mujoco.mjtObj.mjOBJ_JOINT, objname=joint.name
            )
    return spec


def set_body(spec: mujoco.MjSpec, parameter: sysid.Parameter, body: str, nominal: FloatArray) -> None:
    """Set centre of mass and inertia in the plane; the other inertias do not matter, and equal ones are possible."""
    x, z, inertia = parameter.value
    spec.body(body).ipos = [x, nominal[1], z]
    spec.body(body).fullinertia = [inertia, inertia, inertia, 0.0, 0.0, 0.0]
    spec.body(body).explicitinertial = True


def set_joint(spec: mujoco.MjSpec, parameter: sysid.Parameter, joint: str, first: bool) -> None:
    """Set friction, damping and armature; that of the first joint cannot be told from its link's inertia."""
    spec.joint(joint).frictionloss, damping = parameter.value[:2]
    spec.joint(joint).damping = np.array([damping, 0.0, 0.0])
    if not first:
        spec.joint(joint).armature = parameter.value[2]


def unknowns(spec: mujoco.MjSpec) -> sysid.ParameterDict:
    """Say what is unknown, from where to where."""
    model, found = spec.compile(), sysid.ParameterDict()
    for index, joint in enumerate(spec.joints):
        body = model.body(model.joint(joint.name).bodyid[0])
        rotation = np.zeros(9)
        mujoco.mju_quat2Mat(rotation, body.iquat)
        whole = rotation.reshape(3, 3) @ np.diag(body.inertia) @ rotation.reshape(3, 3).T
        nominal = np.concatenate([body.ipos, np.diag(whole)])
        start = nominal[[0, 2, 4]]
        span = np.array([0.3, 0.3, 0.9 * start[2]])
        change = partial(set_body, body=body.name, nominal=nominal)
        found.add(
            sysid.Parameter(
                f"{body.name}", start, start - span, start + np.array([0.3, 0.3, 5.0 * start[2]]), modifier=change
            )
        )
        friction = np.array([0.1, 0.1, 0.001])[: 2 if index == 0 else 3]
        change = partial(set_joint, joint=joint.name, first=index == 0)
        low, high = np.zeros(len(friction)), np.array([5.0, 5.0, 0.5])[: len(friction)]
        found.add(sysid.Parameter(f"{joint.name}", friction, low, high, modifier=change))
    return found


def pieces(spec: mujoco.MjSpec, log: Log, cutoff: float) -> sysid.ModelSequences:
    """Cut the log, with velocities from filtered angles."""
    model, rows = spec.compile(), log.rows(cutoff)
    inside = slice(int(log.rate), -int(log.rate))
    measured, torque = np.hstack([log.q[inside], rows.v]), log.tau[inside]
    names = [f"{joint.name}_{kind}" for kind in ("pos", "vel") for joint in spec.joints]
    order = [model.sensor(name).adr[0] for name in names]
    data = np.empty_like(measured)
    data[:, order] = measured
    step, starts, controls, sensors = int(SECONDS * log.rate), [], [], []
    for begin in range(0, len(data) - step, step):
        part = slice(begin, begin + step + 1)
        stamps = np.arange(step + 1) / log.rate
        starts.append(sysid.create_initial_state(model, rows.q[begin], rows.v[begin]))
        controls.append(sysid.TimeSeries(stamps, torque[part]))
        sensors.append(sysid.TimeSeries.from_names(stamps, data[part], model))
    return sysid.ModelSequences("leg", spec, [f"{k}" for k in range(len(starts))], starts, controls, sensors)


def fit(urdf: str, log: Log, cutoff: float) -> tuple[mujoco.MjSpec, sysid.ParameterDict, FloatArray]:
    """Fit the model to the log, and find the intervals."""
    spec = read(urdf)
    residual = sysid.build_residual_fn(models_sequences=[pieces(spec, log, cutoff)], n_threads=1)
    found, result = sysid.optimize(unknowns(spec), residual, optimizer="mujoco", verbose=False, max_iters=ITERATIONS)
    _, half_widths = sysid.calculate_intervals(residual(result.x, found)[0], result.jac)
    return spec, found, half_widths


# user: ends


def identify(task: Task, log: Log) -> Outcome:
    """Identify a leg.

    Args:
        task: The task.
        log: Log for identification.

    Returns:
        What was found.
    """
    logging.set_verbosity(logging.ERROR)
    start = time.perf_counter()
    with contextlib.redirect_stdout(io.StringIO()):  # the optimiser prints its steps
        spec, found, half_widths = fit(task.urdf, log, task.cutoff)
    seconds = time.perf_counter() - start
    torque = _torque(sysid.apply_param_modifiers(found, spec))
    true = None
    if task.truth is not None:
        true = _truth(task, spec, found)
    exported = spec.to_xml()
    return Outcome(
        torque, seconds, found.as_vector(), half_widths, true, "MJCF" if "frictionloss" in exported else "no"
    )


def _torque(model: mujoco.MjModel) -> Callable[[FloatArray, FloatArray, FloatArray], FloatArray]:
    """Torque of a model; dry friction is added, as MuJoCo's inverse dynamics smooth it."""
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_FRICTIONLOSS
    data = mujoco.MjData(model)

    def torque(q: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
        out = np.empty_like(q)
        for k in range(len(q)):
            data.qpos, data.qvel, data.qacc = q[k], v[k], a[k]
            mujoco.mj_inverse(model, data)
            out[k] = data.qfrc_inverse
        return out + model.dof_frictionloss * np.sign(v)

    return torque


def _truth(task: Task, spec: mujoco.MjSpec, found: sysid.ParameterDict) -> FloatArray:
    """Values of MuJoCo's parameters with which its model is the true one: the masses of CAD are part of it."""
    assert task.truth is not None
    q, v, a = (x[:60] for x in states(len(task.leg.joint_names)))
    wanted, copy = task.truth(q, v, a), found.copy()

    def error(x: FloatArray) -> FloatArray:
        copy.update_from_vector(x)
        return (_torque(sysid.apply_param_modifiers(copy, spec))(q, v, a) - wanted).ravel()

    solved = scipy.optimize.least_squares(error, found.as_vector(), x_scale="jac", xtol=1e-12, ftol=1e-12)
    if solved.cost > 1e-6:
        raise RuntimeError(f"MuJoCo's model does not contain the true one: {solved.cost}")
    return np.asarray(solved.x)
