"""Plants and runs that the tests of the rig share."""

import numpy as np

import exoid
from exoid.rig import Plant, Target

BLEEX = exoid.load_leg("bleex")
POSE = np.array([[0.3], [-0.5], [0.1]])
"""Within the limits of BLEEX [rad]."""

FRICTION = {"c0_hip": 2.0, "c0_knee": 1.5, "c0_ankle": 0.5}
EVERYTHING = {
    **FRICTION,
    "cs_knee": 2.0,
    **{"d_hip": 0.1, "d_knee": 0.2, "b2_hip": 0.5, "b1_knee": 2.0, "b0_ankle": -0.3, "Ia_hip": 0.1, "Ia_ankle": 0.02},
}


def zeros(plant: Plant) -> np.ndarray:
    return np.zeros((plant.n, plant.count))


def torque(time: float, scale: float = 1.0) -> np.ndarray:
    """Open-loop torque that keeps BLEEX swinging, stopping and turning [N·m]."""
    return scale * np.array([[14.0], [7.0], [1.5]]) * np.sin(2 * np.pi * np.array([[0.5], [0.7], [0.9]]) * time)


class Swing:
    """θ = centre + amplitude sin(2π f t), all joints of BLEEX, each at its own frequency."""

    def __init__(self, amplitude: float = 0.2) -> None:
        self.amplitude, self.rate = amplitude, 2 * np.pi * np.array([[0.3], [0.5], [0.7]])

    def at(self, time: float) -> Target:
        s, c = np.sin(self.rate * time), np.cos(self.rate * time)
        return Target(POSE + self.amplitude * s, self.amplitude * self.rate * c)
