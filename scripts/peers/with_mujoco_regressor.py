"""The leg identified with the regressor of ``mujoco-sysid``: rows by a loop, columns of friction, then ``lstsq``.

The package has no filter, friction, interval or export: filter and columns of friction, rotor and offset are a user's.
"""

from __future__ import annotations

import time

import mujoco
import numpy as np
from mujoco_sysid.regressors import joint_torque_regressor
from task import Log, Outcome, Task

from exoid._typing import FloatArray


# user: begins
def regressor(model: mujoco.MjModel, q: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
    """Stack the rows of the bodies, with friction, rotor inertia and offset of each joint, (N·n, p)."""
    data = mujoco.MjData(model)
    rows = []
    for k in range(len(q)):
        data.qpos, data.qvel, data.qacc = q[k], v[k], a[k]
        mujoco.mj_inverse(model, data)
        mujoco.mj_rnePostConstraint(model, data)
        own = [np.diag(np.sign(v[k])), np.diag(v[k]), np.diag(a[k]), np.eye(q.shape[1])]
        rows.append(np.hstack([joint_torque_regressor(model, data), *own]))
    return np.vstack(rows)


def fit(urdf: str, log: Log, cutoff: float) -> tuple[mujoco.MjModel, FloatArray]:
    """Solve for the parameters of least norm."""
    model = mujoco.MjModel.from_xml_string(urdf)
    rows = log.rows(cutoff)
    W = regressor(model, rows.q, rows.v, rows.a)
    return model, np.linalg.lstsq(W, rows.tau.ravel(), rcond=1e-8)[0]


# user: ends


def identify(task: Task, log: Log) -> Outcome:
    """Identify a leg.

    Args:
        task: The task.
        log: Log for identification.

    Returns:
        What was found; its parameters are not unique, so that they have no intervals.
    """
    start = time.perf_counter()
    model, values = fit(task.urdf, log, task.cutoff)
    seconds = time.perf_counter() - start

    def torque(q: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
        return (regressor(model, q, v, a) @ values).reshape(q.shape)

    return Outcome(torque, seconds, values, None, None, "no export")
