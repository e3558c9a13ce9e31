"""Test stand leg: 23 s of a real two-joint leg that is pressed and pulled on a force sensor under its foot."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field

import numpy as np

from exoid._typing import FloatArray
from exoid.leg.leg import Leg
from exoid.signals.recording import Recording
from exoid.signals.source import Source
from exoid.signals.wrench import Wrench

from .dataset import Dataset, PublishedFile

LOG_COMMIT = "7f1b68f2bc79520c99435c5008fc80f56cd06237"
LOG_URL = f"https://raw.githubusercontent.com/machines-in-motion/mim_estimation/{LOG_COMMIT}/demos/2019-07-04_16-25-06"
LOG_NAME = "dg_hopper_teststand"
URDF_COMMIT = "4d7885daeda181422ad93ea00e896312c8e70a7e"
URDF_URL = (
    f"https://raw.githubusercontent.com/open-dynamic-robot-initiative/robot_properties_teststand/{URDF_COMMIT}"
    "/src/robot_properties_teststand/robot_properties_teststand/pre_generated_urdf"
)
FOLDER = "teststand_leg"

RATE = 1000.0
"""Rate of the sample counter [Hz]."""

JOINTS = ("HFE", "KFE")
"""Flexion of hip and knee, about y. The rail, joint ``joint_z`` of the URDF, is locked."""

FOOT = "contact"
"""Link that stands on the sensor."""

CITATION = (
    "Machines in Motion (New York University and Max Planck Gesellschaft), mim_estimation, 2019-07-04, and Open "
    "Dynamic Robot Initiative, robot_properties_teststand; BSD-3-Clause"
)


URDF = PublishedFile(
    f"{URDF_URL}/teststand.urdf",
    "c8582d9527868914984f8b33f833fc1443ed62c010c8556bc0c1064eeabc5779",
    f"{FOLDER}/teststand.urdf",
)
LOGS = tuple(
    PublishedFile(f"{LOG_URL}/{LOG_NAME}-{what}.dat", sha256, f"{FOLDER}/{LOG_NAME}-{what}.dat")
    for what, sha256 in (
        ("joint_positions", "3f0bb177ada0aeaa0e95fa958e47b5966c8274d5a916c8426bcc91489df9e8a2"),
        ("joint_torques", "9a9cb2395b1bb4d7cbafb20f3527b2d9d13b68ea07e1596697adfb12982fdbd1"),
        ("ati_force", "03a980b0e017c4d0bf1954081676b0c736fff80c9fb98de46abbc7386e4fefae"),
    )
)
"""Angles [rad], torques [N·m] and force [N]; the first column of each counts samples."""


@dataclass(frozen=True, eq=False)
class ForceDataset(Dataset):
    """Dataset of a leg whose foot stands on a force sensor.

    Attributes:
        recording: The whole recording; ``train`` is its first half, ``test`` the second.
        force: Readings of the sensor in its own axes [N], (N, 3).
    """

    recording: Recording
    force: FloatArray = field(repr=False)


def teststand_leg() -> ForceDataset:
    """Load the recording from ``$EXOID_DATA_DIR`` or, after one download, from the cache.

    The base moves up and down its rail three times, slowly, while the foot stays on the sensor. Torque is current times
    the nominal constant; the knee's stays at its limit of 2.7 N·m for 35 % of the time. The wrench on the link
    ``contact`` is the force on the foot as read: zero and tilt (0.04 rad) are not corrected (docs/teststand.md).

    Returns:
        Leg with joints HFE and KFE, the recording at 1 kHz, its halves and the force.

    Raises:
        ExoidError: A file is missing and cannot be downloaded, or differs from the published one.
    """
    leg = Leg.from_urdf(URDF.path(), JOINTS)
    q, tau, force = aligned(*(np.loadtxt(log.path()) for log in LOGS))
    listed = "".join(f"{log.sha256}  {log.path().name}\n" for log in sorted(LOGS, key=lambda log: log.file))
    source = Source(LOG_NAME, hashlib.sha256(listed.encode()).hexdigest())
    time = np.arange(len(q)) / RATE
    cos, sin = np.cos(q.sum(axis=1)), np.sin(q.sum(axis=1))  # both joints turn about y
    x, y, z = force.T
    on_foot = np.stack([cos * x - sin * z, y, sin * x + cos * z], axis=1)
    wrenches = {FOOT: Wrench(on_foot, np.zeros_like(on_foot))}  # no moment was logged
    recording = Recording(time, q, tau=tau, joint_names=JOINTS, source=source, wrenches=wrenches)
    half = len(recording) // 2
    force.flags.writeable = False
    return ForceDataset(leg, recording.slice(None, half), recording.slice(half, None), CITATION, recording, force)


def aligned(*logs: FloatArray) -> tuple[FloatArray, ...]:
    """Select the samples that all logs have."""
    common = logs[0][:, 0]
    for log in logs[1:]:
        common = np.intersect1d(common, log[:, 0], assume_unique=True)
    return tuple(log[np.searchsorted(log[:, 0], common), 1:] for log in logs)
