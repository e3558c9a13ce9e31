"""Log of a leg whose knee has no actuator, and swings freely or on a spring."""

from functools import cache

import numpy as np
from scipy.integrate import solve_ivp

import exoid

DAMPING = np.array([0.5, 0.08])


@cache
def hanging(stiffness=0.0):
    """Document 2's leg with a driven hip and a knee that swings freely, or on a spring: time, q, v, a and torque."""
    leg = exoid.load_leg("cuhk")
    omega = 2.0 * np.pi * np.array([0.31, 0.53, 0.77, 1.1])
    size, phase = np.array([0.3, 0.2, 0.12, 0.06]), np.array([0.0, 1.0, 2.0, 0.5])

    def hip(t):
        angle = np.multiply.outer(t, omega) + phase
        of_each = size * np.sin(angle), size * omega * np.cos(angle), -size * omega**2 * np.sin(angle)
        return [part.sum(-1) for part in of_each]

    def acceleration(t, q2, v2):
        q1, v1, a1 = hip(t)
        state = np.array([[q1, q2]]), np.array([[v1, v2]])
        rest = leg.inverse_dynamics(*state, np.array([[a1, 0.0]]))[0, 1]
        return -(rest + DAMPING[1] * v2 + stiffness * q2) / leg.mass_matrix(state[0])[0, 1, 1]

    t = np.arange(1500) / 100.0
    run = solve_ivp(lambda t, x: [x[1], acceleration(t, *x)], (0.0, t[-1]), [-0.3, 0.0], t_eval=t, rtol=1e-8, atol=1e-8)
    motion = [hip(t), (*run.y, np.array([acceleration(*sample) for sample in zip(t, *run.y, strict=True)]))]
    q, v, a = (np.column_stack(pair) for pair in zip(*motion, strict=True))
    return leg, t, q, v, a, leg.inverse_dynamics(q, v, a) + DAMPING * v


def hanging_log(seed, passive, stiffness=0.0):
    leg, t, q, _, _, torque = hanging(stiffness)
    rng = np.random.default_rng(seed)
    tau = torque + 0.02 * torque.std(axis=0) * rng.standard_normal(torque.shape) * [1.0, 0.0]
    tau[:, 1] = np.nan
    q = q + 5e-5 * rng.standard_normal(q.shape)
    return leg, exoid.Recording(t, q, tau=tau, joint_names=leg.joint_names, passive=("left_knee",) if passive else ())
