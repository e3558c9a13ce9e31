"""Poses that are approached from both sides; test_refused_logs.py has what they refuse."""

import numpy as np

from exoid.signals import Approaches, Poses

NAMES = ("hip", "knee")
Q = np.array([[0.1, 0.2], [0.3, 0.4], [0.5, 0.6]])


def test_both_directions_are_averaged_and_their_difference_is_the_friction_band():
    friction = np.array([0.5, 0.25])
    below, above = Poses(Q, 3.0 * Q + friction, NAMES), Poses(Q + 0.002, 3.0 * Q - friction, NAMES)
    both = Approaches(below, above)
    np.testing.assert_allclose(both.averaged.tau, 3.0 * Q)
    np.testing.assert_allclose(both.averaged.q, Q + 0.001)
    np.testing.assert_allclose(both.band, np.tile(friction, (3, 1)))
