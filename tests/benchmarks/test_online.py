"""Time of a step of the recursive estimator, as a ratio to a bare ``pin.rnea`` in the same run."""

import numpy as np
import pinocchio as pin
import pytest
from turns import best_of_turns, show

import exoid
from exoid.online import RecursiveEstimator

LEG = exoid.load_leg("bleex", inertias="cad")
RATE, SAMPLES = 500.0, 3000
ROUNDS = 5


@pytest.fixture(scope="module")
def best():
    """Processor time of a step, blocks included, and of one call [s]."""
    time = np.arange(SAMPLES) / RATE
    q = 0.4 * np.sin(2.0 * np.pi * np.array([1.0, 1.5, 2.0]) * time[:, None])  # whole periods
    v = np.zeros_like(q)
    tau = LEG.gravity(q) + 0.3 * np.random.default_rng(0).standard_normal(q.shape)
    online = RecursiveEstimator(LEG, (exoid.Coulomb(), exoid.Viscous()), rate=RATE)
    online.update(q, None, None, tau)
    data = LEG.model.createData()

    def steps():
        for k in range(SAMPLES):
            online.update(q[k], None, None, tau[k])

    def calls():
        for k in range(SAMPLES):
            pin.rnea(LEG.model, data, q[k], v[k], v[k])

    found = {name: x / SAMPLES for name, x in best_of_turns({"rnea": calls, "step": steps}, ROUNDS).items()}
    show("A sample of the recursive estimator from Python", found, "rnea")
    return found


def test_a_step_takes_at_most_80_calls_of_rnea(best):
    """That is 50 to 90 µs: 25 to 54 calls by the machine."""
    assert best["step"] <= 80.0 * best["rnea"]
