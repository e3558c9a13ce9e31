"""Time of one control step, as ratios to a bare ``pin.rnea`` in the same run: ``pytest tests/benchmarks -s``."""

import numpy as np
import pinocchio as pin
import pytest
from turns import best_of_turns, show

import exoid
from exoid import published
from exoid.control import State, computed_torque, feedforward_pd, gravity_friction_pd, lqr, mean_pose, pd
from exoid.experiments import healthy_gait
from exoid.rig import Plant, Target

LEG = exoid.load_leg("cuhk")
PLANT = Plant.build(LEG, {**published.cuhk_resistances(), "Ia_knee": 0.8})
KP, KD = (22.0, 55.0), (2.2, 5.5)
Q, V, A = np.array([0.3, 0.5]), np.array([0.2, -0.4]), np.array([1.0, 0.5])
ROUNDS = 7


def steps():
    """One step of each law from Python, and one bare call of the recursive Newton-Euler algorithm."""
    data = LEG.model.createData()
    state, target = State(Q, V, 1.0), Target(Q + 0.1, V - 0.1, A)
    laws = {
        "pd": pd(KP, KD),
        "gravity_friction_pd": gravity_friction_pd(PLANT, KP, KD),
        "feedforward_pd": feedforward_pd(PLANT, KP, KD),
        "computed_torque": computed_torque(PLANT, KP, KD),
        "lqr": lqr(PLANT, mean_pose(healthy_gait(), 10.0)),
    }
    calls = {name: (lambda law=law: law.torque(state, target)) for name, law in laws.items()}
    return {"rnea": lambda: pin.rnea(LEG.model, data, Q, V, A), **calls}


@pytest.fixture(scope="module")
def best():
    """Processor time of a step of each law [s]."""
    found = best_of_turns(steps(), ROUNDS)
    show("A step of control from Python", found, "rnea")
    return found


def test_a_model_makes_a_step_at_most_five_times_as_long_as_that_of_pd(best):
    """Both are Python: 3.4 to 3.9 on processors that do 18 to 28 calls of rnea meanwhile, and pd itself 5 to 7."""
    assert max(best.values()) <= 5.0 * best["pd"]
    assert best["pd"] <= 10.5 * best["rnea"]
