"""Controllers with memory, and those around other controllers: limits, side by side."""

from typing import NamedTuple

import numpy as np
import pytest
from controlled_legs import cuhk_plant

from exoid._typing import FloatArray
from exoid.control import Limited, State, pd, simulate_law
from exoid.experiments import healthy_gait
from exoid.rig import Target

AIM = Target(np.array([0.3, -0.2]), np.zeros(2))
REST = State(np.zeros(2), np.zeros(2))


class Sum(NamedTuple):
    total: FloatArray


class PI:
    """τ = 20 e + 5 ∫ e dt, with the sum as its memory."""

    rate = 100.0

    def begin(self, state: State) -> Sum:
        return Sum(np.zeros_like(state.q))

    def step(self, memory: Sum, state: State, target: Target) -> tuple[FloatArray, Sum]:
        error = target.q - state.q
        total = memory.total + error / self.rate
        return 20.0 * error + 5.0 * total, Sum(total)


def test_the_closed_loop_hands_the_memory_on():
    """The torque of each sample is that of the sum of all errors until then."""
    run = simulate_law(cuhk_plant(), PI(), healthy_gait(), 2.0)
    error = run.target - run.q
    expected = 20.0 * error + 5.0 * np.cumsum(error, axis=0) / 100.0
    np.testing.assert_allclose(run.tau[1:], expected[:-1], rtol=1e-3, atol=1e-3)  # readings have encoder counts


@pytest.mark.parametrize(
    ("limits", "last", "torque"),
    [
        ({"limit": (80.0, 60.0)}, None, [80.0, -60.0]),
        ({"slew": 500.0}, [2.0, 3.0], [7.0, -2.0]),  # 500 N·m/s for 10 ms from the torque that was commanded last
        ({"slew": 500.0}, None, [5.0, -5.0]),  # nothing was commanded before the first
        ({"limit": 50.0, "slew": 100.0}, [90.0, -90.0], [50.0, -50.0]),  # even where the last was beyond the limit
    ],
)
def test_torque_and_its_change_stay_within_their_limits(limits, last, torque):
    law, far = Limited(pd(1000.0, 0.0), **limits), Target(np.array([1.0, -1.0]), np.zeros(2))
    state = REST if last is None else REST._replace(last=np.array(last))
    np.testing.assert_allclose(law.step(law.begin(state), state, far)[0], torque)


def test_limits_act_on_a_law_with_memory_throughout_a_run():
    law = Limited(PI(), limit=2.0, slew=50.0)
    memory = law.begin(REST)
    torque, memory = law.step(memory, REST._replace(last=np.array([1.9, -0.1])), AIM)
    np.testing.assert_allclose(torque, [2.0, -0.6])  # 6 and −4 N·m wanted
    np.testing.assert_allclose(memory[0].total, AIM.q / 100.0)
    for k in range(2):  # without state.last the limits, and the law inside, know the last command all the same
        torque, memory = law.step(memory, REST, AIM)
        np.testing.assert_allclose(torque, [2.0, -1.1 - 0.5 * k])
    run = simulate_law(cuhk_plant(), law, healthy_gait(period=2.0), 2.0)
    assert np.abs(run.tau).max() == pytest.approx(2.0)
    assert np.abs(np.diff(run.tau[1:], axis=0)).max() <= 0.5 + 1e-9
