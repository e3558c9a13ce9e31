"""With an exact model, computed torque gives a linear error equation."""

import numpy as np
import pytest
from controlled_legs import cuhk_plant, exact_estimate
from scipy.integrate import solve_ivp

from exoid.control import SMOOTH, ControlModel, State, computed_torque
from exoid.experiments import healthy_gait
from exoid.rig import Target

GAIT = healthy_gait(period=2.0)


def column(time):
    return Target(*(x[:, 0] for x in GAIT.at(time)))


def follow(law, plant, start, duration=3.0):
    """Angles under a law without sampling: Pinocchio's dynamics, integrated to 1e-11."""
    model = ControlModel.of(plant)

    def rate(t, y):
        q, v = y[:2], y[2:]
        tau = law.torque(State(q, v, t), column(t)) - model.friction(q, v, 0.5)
        return [*v, *np.linalg.solve(model.mass_matrix(q), tau - model.inverse_dynamics(q, v, np.zeros(2)))]

    time = np.linspace(0.0, duration, 61)
    done = solve_ivp(rate, (0.0, duration), start, method="DOP853", t_eval=time, rtol=1e-11, atol=1e-12)
    return time, done.y[:2].T


def same_friction():
    """The smooth friction that `follow` puts into the plant, compensated on the measured velocity."""
    return type(SMOOTH)(width=0.5)


@pytest.mark.parametrize("rotor", [0.0, 0.8])
def test_an_error_under_computed_torque_obeys_its_linear_equation(rotor):
    """ë + kd ė + kp e = 0 from e = 0.2 rad, at each joint with its own gains, to 1e-6."""
    kp, kd = np.array([25.0, 9.0]), np.array([6.0, 8.0])  # under-damped, over-damped
    law = computed_torque(exact_estimate(rotor), kp, kd, friction=same_friction())
    first = column(0.0)
    time, q = follow(law, cuhk_plant(rotor), [*(first.q - 0.2), *first.v])
    error = np.array([column(t).q for t in time]) - q
    roots = [np.roots([1.0, d, p]) for p, d in zip(kp, kd, strict=True)]
    for joint, (one, two) in enumerate(roots):
        expected = 0.2 * (two * np.exp(one * time) - one * np.exp(two * time)) / (two - one)
        np.testing.assert_allclose(error[:, joint], expected.real, atol=1e-6)
