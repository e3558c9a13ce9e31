"""What every peer gets and how its model is judged: the same logs, the same filter, the same truth."""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import scipy.signal
from lxml import etree

import exoid
from exoid._typing import FloatArray
from exoid.leg.catalog import urdf_folder

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import make_bleex_swing as virtual_leg  # the script beside this folder

Torque = Callable[[FloatArray, FloatArray, FloatArray], FloatArray]
"""Torque of a model [N·m], (N, n), of angles, velocities and accelerations, (N, n) each."""

POINTS = 400
"""Number of random states at which a model is read as X, Y, J and friction."""


class Rows(NamedTuple):
    """Filtered samples of a log, (N, n) each."""

    q: FloatArray
    v: FloatArray
    a: FloatArray
    tau: FloatArray


class Log(NamedTuple):
    """A log as a user has it: time [s], (N,); angles [rad] and torques [N·m], (N, n)."""

    time: FloatArray
    q: FloatArray
    tau: FloatArray

    @property
    def rate(self) -> float:
        """Sampling rate [Hz]."""
        return 1.0 / float(np.median(np.diff(self.time)))

    def rows(self, cutoff: float) -> Rows:
        """Filter with a zero-phase Butterworth filter, differentiate centrally, and leave out a second at each end.

        Args:
            cutoff: Cut-off frequency [Hz].

        Returns:
            The samples.
        """
        filters = scipy.signal.butter(4, cutoff, fs=self.rate, output="sos")
        q, tau = (scipy.signal.sosfiltfilt(filters, x, axis=0) for x in (self.q, self.tau))
        v = np.gradient(q, 1.0 / self.rate, axis=0)
        inside = slice(int(self.rate), -int(self.rate))
        return Rows(q[inside], v[inside], np.gradient(v, 1.0 / self.rate, axis=0)[inside], tau[inside])


class Task(NamedTuple):
    """A leg with two logs.

    Attributes:
        name: Name of the task.
        leg: The leg as the CAD model has it.
        urdf: URDF of these joints alone, without geometry.
        train: Log for identification.
        test: Log for the test.
        cutoff: Cut-off frequency of the judgement, and of peers that ask for one [Hz].
        truth: True torque; None for a real machine.
    """

    name: str
    leg: exoid.Leg
    urdf: str
    train: Log
    test: Log
    cutoff: float
    truth: Torque | None = None


class Outcome(NamedTuple):
    """What a peer found.

    Attributes:
        torque: Torque of its model.
        seconds: Time of identification [s].
        values: Its parameters, (p,).
        half_widths: Half the length of its 95 % intervals, (p,); None where it gives none.
        true_values: True values of its parameters, (p,); None where they were not asked for.
        export: What an exported file holds of friction.
    """

    torque: Torque
    seconds: float
    values: FloatArray
    half_widths: FloatArray | None
    true_values: FloatArray | None
    export: str


@cache
def swing(seed: int) -> Task:
    """BLEEX's left leg on a fixed torso: 30 s and 15 s with encoders and noise of the torque.

    Args:
        seed: Seed of motion and noise; 1 gives the log ``bleex_swing`` that comes with exoid.

    Returns:
        The task; its URDF has the CAD values, its logs those that the documents identified.
    """
    leg = exoid.load_leg("bleex", side="left")
    true = exoid.load_leg("bleex", side="left", inertias="identified")
    train, test = virtual_leg.record(seed, 30.0), virtual_leg.record(seed + 1000 if seed > 1 else 2, 15.0)

    def torque(q: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
        friction = virtual_leg.COULOMB * np.tanh(v / virtual_leg.STICK_SLIP) + virtual_leg.VISCOUS * v
        return true.inverse_dynamics(q, v, a) + friction

    urdf = one_limb(urdf_folder() / "bleex.urdf", leg.joint_names)
    return Task("bleex_swing", leg, urdf, _log(train), _log(test), 8.0, torque)


@cache
def pendulum() -> Task:
    """Build the task of the DFKI double pendulum, a real two-link arm whose torque is the command.

    Returns:
        The task.
    """
    data = exoid.datasets.dfki_double_pendulum()
    urdf = one_limb(urdf_folder() / "dfki_double_pendulum.urdf", data.leg.joint_names)
    return Task("dfki_double_pendulum", data.leg, urdf, _log(data.train), _log(data.test), 8.0)


def one_limb(file: Path, joints: tuple[str, ...]) -> str:
    """Cut a URDF down to a chain of joints.

    Args:
        file: The URDF.
        joints: Names of the joints that stay.

    Returns:
        URDF with these joints, their links and the inertias; the first link is fixed.
    """
    root = etree.parse(file).getroot()
    kept = [joint for joint in root.findall("joint") if joint.get("name") in joints]
    links = {joint.find(end).get("link") for joint in kept for end in ("parent", "child")}
    for element in list(root):
        if element not in kept and element.get("name") not in links:
            root.remove(element)
    for link in root.findall("link"):
        for part in [*link.findall("visual"), *link.findall("collision")]:
            link.remove(part)
    return etree.tostring(root, encoding="unicode")


def friction_of(urdf: str) -> list[str | None]:
    """Read the dry friction of a URDF.

    Args:
        urdf: The URDF.

    Returns:
        Friction of each joint that has dynamics, as it is written.
    """
    return [joint.get("friction") for joint in etree.fromstring(urdf.encode()).iter("dynamics")]


def nrmse(task: Task, torque: Torque) -> FloatArray:
    """Error of the torque on the test log: RMSE by the standard deviation of the measured torque.

    Args:
        task: The task.
        torque: Torque of the model.

    Returns:
        NRMSE of each joint, (n,).
    """
    rows = task.test.rows(task.cutoff)
    error = torque(rows.q, rows.v, rows.a) - rows.tau
    return np.asarray(np.sqrt(np.mean(error**2, axis=0)) / rows.tau.std(axis=0))


def states(joints: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Draw states in which no joint is slow, so that the smoothing of dry friction does not matter.

    Args:
        joints: Number of joints.

    Returns:
        Angles, velocities and accelerations, (N, n) each.
    """
    rng = np.random.default_rng(0)
    q, v, a = rng.uniform(-1.0, 1.0, (3, POINTS, joints))
    return 1.5 * q, np.sign(v) * (0.5 + 3.0 * np.abs(v)), 20.0 * a


def read_as_parameters(leg: exoid.Leg, torque: Torque) -> dict[str, float]:
    """Read a model as X, Y, J and friction, whatever its own parameters are.

    Args:
        leg: The leg.
        torque: Torque of the model.

    Returns:
        Values by name. The rotor inertia of the first joint is part of J1.
    """
    q, v, a = states(len(leg.joint_names))
    each = np.eye(len(leg.joint_names))
    blocks = [np.einsum("ni,ij->nij", x, each) for x in (np.sign(v), v, a, np.ones_like(v))]
    blocks[2] = blocks[2][..., 1:]
    W = np.concatenate([leg.regressor(q, v, a), *blocks], axis=-1)
    values = np.linalg.lstsq(W.reshape(-1, W.shape[-1]), torque(q, v, a).ravel(), rcond=None)[0]
    joints = range(1, len(leg.joint_names) + 1)
    names = [*leg.parameter_names, *(f"c0_{j}" for j in joints), *(f"d_{j}" for j in joints)]
    return dict(zip(names, values.tolist(), strict=False))


def _log(recording: exoid.Recording) -> Log:
    return Log(recording.time, recording.q, recording.tau)
