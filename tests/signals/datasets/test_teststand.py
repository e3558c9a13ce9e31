"""A real leg on a force sensor: the files fit together, and the signs of the force are those of a force on the foot."""

import numpy as np
import pinocchio as pin
import pytest

import exoid
from exoid.signals import zero_phase
from exoid.signals.datasets import teststand


@pytest.fixture(scope="module")
def data():
    return exoid.datasets.teststand_leg()


def static_torque(data, force):
    """Torque that holds the leg against gravity and a force on its foot, by Pinocchio: G − Jᵀ f, (K, 2)."""
    model = data.leg.model
    state, foot = model.createData(), model.getFrameId(teststand.FOOT)
    rows = []
    for q, f in zip(data.recording.q[::50], force[::50], strict=True):
        jacobian = pin.computeFrameJacobian(model, state, q, foot, pin.LOCAL_WORLD_ALIGNED)[:3]
        rows.append(pin.computeGeneralizedGravity(model, state, q) - jacobian.T @ f)
    return np.array(rows)


@pytest.mark.real_data("teststand_leg")
def test_the_force_is_one_on_the_foot_in_the_axes_of_the_root_link(data):
    """With any sign of x or z reversed, the static torque explains less of the measured one."""
    tau = zero_phase(data.recording.tau, 1000.0, 5.0)[::50]
    error = {
        signs: np.std(tau - static_torque(data, data.force * (signs[0], 1.0, signs[1])), axis=0)
        for signs in ((1, 1), (-1, 1), (1, -1), (-1, -1))
    }
    for signs in ((-1, 1), (1, -1), (-1, -1)):
        assert error[1, 1].sum() < 0.6 * error[signs].sum(), signs
    assert error[1, 1][1] < 0.2 * tau[:, 1].std()


@pytest.mark.real_data("teststand_leg")
def test_the_wrench_on_the_foot_is_the_force_in_axes_of_the_foot(data):
    """Pinocchio's placement of the foot turns it back."""
    model = data.leg.model
    state, foot = model.createData(), model.getFrameId(teststand.FOOT)
    wrench = data.recording.wrenches[teststand.FOOT]
    assert wrench.axes == "link"
    assert not wrench.moment.any()
    for k in range(0, len(data.force), 997):
        pin.framesForwardKinematics(model, state, data.recording.q[k])
        np.testing.assert_allclose(state.oMf[foot].rotation @ wrench.force[k], data.force[k], atol=1e-12)
    assert len(data.test.wrenches[teststand.FOOT]) == len(data.test)


def test_logs_are_aligned_by_their_counter():
    first = np.column_stack([[1.0, 2.0, 3.0, 5.0, 6.0], [10.0, 20.0, 30.0, 50.0, 60.0]])
    second = np.column_stack([[2.0, 3.0, 4.0, 5.0], [0.2, 0.3, 0.4, 0.5], [-2.0, -3.0, -4.0, -5.0]])
    one, two = teststand.aligned(first, second)
    assert one.tolist() == [[20.0], [30.0], [50.0]]
    assert two.tolist() == [[0.2, -2.0], [0.3, -3.0], [0.5, -5.0]]
