"""Limits of torque and of its rate, around any controller."""

import numpy as np
from controlled_legs import cuhk_plant

from exoid.control import Limited, SideBySide, State, pd, simulate_law
from exoid.experiments import Hold
from exoid.rig import Target

HARD = pd(1000.0, 0.0)
FAR = Target(np.array([1.0, -1.0]), np.zeros(2))
REST = State(np.zeros(2), np.zeros(2))


def test_torque_stays_within_its_limit():
    np.testing.assert_allclose(Limited(HARD, limit=(80.0, 60.0)).torque(REST, FAR), [80.0, -60.0])


def test_torque_does_not_change_faster_than_allowed():
    """From the torque that was commanded last, 500 N·m/s for 10 ms."""
    law = Limited(HARD, slew=500.0)
    np.testing.assert_allclose(law.torque(REST._replace(last=np.array([2.0, 3.0])), FAR), [7.0, -2.0])


def test_the_first_command_does_not_jump_from_zero():
    """Nothing was commanded before it, so that 500 N·m/s for 10 ms are the first torque too."""
    np.testing.assert_allclose(Limited(HARD, slew=500.0).torque(REST, FAR), [5.0, -5.0])


def test_the_limit_holds_even_where_the_last_torque_was_beyond_it():
    law = Limited(HARD, limit=50.0, slew=100.0)
    np.testing.assert_allclose(law.torque(REST._replace(last=np.array([90.0, -90.0])), FAR), [50.0, -50.0])


def test_limits_hold_throughout_a_run():
    law = Limited(pd(300.0, 30.0), limit=(15.0, 8.0), slew=200.0)
    pose = Hold(np.array([[0.6], [0.8]]))
    free, bound = (simulate_law(cuhk_plant(), one, pose, 1.0, start=np.zeros(2)) for one in (law.law, law))
    assert (np.abs(free.tau).max(axis=0) > [100.0, 100.0]).all()
    assert (np.abs(bound.tau).max(axis=0) <= [15.0 + 1e-12, 8.0 + 1e-12]).all()
    assert np.abs(np.diff(bound.tau, axis=0, prepend=0.0)).max() <= 2.0 + 1e-9


def test_side_by_side_each_controller_receives_its_last_torque():
    laws = (Limited(HARD, slew=100.0), Limited(HARD, slew=1000.0))
    state = State(np.zeros((2, 2)), np.zeros((2, 2)), last=np.array([[1.0, 2.0], [3.0, 4.0]]))
    aim = Target(np.array([[1.0], [-1.0]]), np.zeros((2, 1)))
    np.testing.assert_allclose(SideBySide(laws).step(((), ()), state, aim)[0], [[2.0, 12.0], [2.0, -6.0]])
