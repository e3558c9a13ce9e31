"""Example data print what they are, not their arrays."""

import numpy as np

from exoid import datasets


def test_a_gait_norm_represents_itself_by_the_range_of_each_joint():
    mean = np.linspace([-10.0, 0.0, -20.0], [30.0, 60.0, 15.0], 51)
    norm = datasets.GaitNorm("Free", np.linspace(0.0, 1.0, 51), mean, np.ones((51, 3)))
    assert repr(norm) == "GaitNorm(Free: hip -10 to 30, knee 0 to 60, ankle -20 to 15 deg)"


def test_a_dataset_represents_itself_by_its_leg_and_recordings():
    data = datasets.bleex_swing()
    assert repr(data.leg) in repr(data)
    assert repr(data.train) in repr(data)
    assert "array" not in repr(data)
