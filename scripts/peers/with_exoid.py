"""The leg identified by exoid, with its default settings."""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

import numpy as np
from task import Log, Outcome, Task, friction_of, read_as_parameters

import exoid


def identify(task: Task, log: Log) -> Outcome:
    """Identify a leg.

    Args:
        task: The task.
        log: Log for identification.

    Returns:
        What was found.
    """
    recording = exoid.Recording(time=log.time, q=log.q, tau=log.tau, joint_names=task.leg.joint_names)
    start = time.perf_counter()
    # user: begins
    est = exoid.identify(task.leg, recording)
    # user: ends
    seconds = time.perf_counter() - start
    true = None
    if task.truth is not None:
        known = list(read_as_parameters(task.leg, task.truth).values())
        true = np.array(known + [0.0] * (len(est.names) - len(known)))  # no rotors, no offsets
    half = np.diff(est.interval(), axis=1).ravel() / 2.0
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "leg.urdf"
        est.to_urdf(file)
        friction = friction_of(file.read_text(encoding="utf-8")) != friction_of(task.urdf)
    return Outcome(est.torque, seconds, est.values, half, true, "URDF, MJCF, C" if friction else "no")
