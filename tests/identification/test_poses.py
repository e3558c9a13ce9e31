"""Poses check what they are made of, and approaches belong together."""

import numpy as np
import pytest

from exoid.errors import ExoidError
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


REFUSED = {
    "fewer torques": lambda: Poses(Q, Q[:2], NAMES),
    "torques of one joint": lambda: Poses(Q, Q[:, :1], NAMES),
    "one pose": lambda: Poses(Q[0], Q, NAMES),
    "ragged": lambda: Poses(Q, [[1.0, 2.0], [3.0], [4.0, 5.0]], NAMES),
    "text": lambda: Poses(Q, [["a", "b"]] * 3, NAMES),
    "degrees": lambda: Poses(np.rad2deg(Q), Q, NAMES),
    "missing torque": lambda: Poses(Q, np.where(Q > 0.5, np.nan, Q), NAMES),
    "approaches of other poses": lambda: Approaches(Poses(Q, Q, NAMES), Poses(Q[:2], Q[:2], NAMES)),
    "approaches of other joints": lambda: Approaches(Poses(Q, Q, NAMES), Poses(Q, Q, NAMES[::-1])),
    "no such joint": lambda: Poses(Q, Q, NAMES).select(("ankle",)),
}


@pytest.mark.parametrize("call", REFUSED.values(), ids=REFUSED)
def test_bad_poses_are_refused(call):
    with pytest.raises(ExoidError) as caught:
        call()
    assert caught.value.remedy
