"""A leg of one joint, and a log of it."""

import numpy as np
from swings import harmonics, log_of

from exoid import Leg

URDF = """<robot name="one">
  <link name="base"/>
  <link name="thigh">
    <inertial>
      <origin xyz="0 0 -0.2"/><mass value="4"/>
      <inertia ixx="0.06" ixy="0" ixz="0" iyy="0.06" iyz="0" izz="0.01"/>
    </inertial>
  </link>
  <joint name="hip" type="revolute">
    <parent link="base"/><child link="thigh"/><axis xyz="0 1 0"/>
    <limit lower="-1.5" upper="1.5" effort="80" velocity="6"/>
  </joint>
</robot>
"""


def write_urdf(path):
    path.write_text(URDF, encoding="utf-8")
    return Leg.from_urdf(path)


def swing(leg, *, seconds=20.0, rate=100.0, seed=0):
    """A motion of two frequencies, with torques of the leg, friction and noise."""
    time = np.arange(round(seconds * rate)) / rate
    q, v, a = harmonics(time, np.array([[0.5, 0.3]]), np.array([1.7, 4.1]), np.array([0.0, 1.0]))
    return log_of(leg, time, (q, v, a), 2.0 * np.tanh(v / 0.01) + 0.5 * v, 0.05, seed)
