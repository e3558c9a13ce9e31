"""Every law is a pure function, and gives many legs at once what each gets alone."""

from functools import partial

import numpy as np
import pytest
from controlled_legs import cuhk_plant, exact_estimate

import exoid
from exoid import control
from exoid.rig import Target

FRICTIONS = {
    "smooth": control.FrictionCompensation(),
    "sharp": control.FrictionCompensation(width=0.0),
    "too much": control.FrictionCompensation(width=0.2, scale=1.5),
    "desired": control.FrictionCompensation(velocity="desired"),
    "desired, sharp": control.FrictionCompensation(velocity="desired", width=0.0, scale=0.5),
    "none": None,
}

SOURCES = {"est": exact_estimate(), "rig": cuhk_plant(), "leg": exoid.load_leg("bleex")}

LAWS = {
    "pd": lambda source: control.pd(20.0, 2.0),
    "feedforward": lambda source: control.feedforward_pd(source, 20.0, 2.0),
    "computed torque": lambda source: control.computed_torque(source, 25.0, 8.0),
    "lqr": lambda source: control.lqr(source, np.zeros(control.ControlModel.of(source).n)),
    "impedance": lambda source: control.impedance(source, 60.0, 5.0),
    "support": lambda source: control.gravity_support(source, 0.5, friction=control.PASSIVE),
    "amplification": lambda source: control.sensitivity_amplification(source, 5.0),
    "self-tuning": lambda source: control.self_tuning(source, 20.0, 2.0),
} | {
    f"gravity, {name}": partial(control.gravity_friction_pd, kp=20.0, kd=2.0, friction=friction)
    for name, friction in FRICTIONS.items()
}
CASES = [(source, name) for source in SOURCES for name in LAWS if source == "est" or name != "self-tuning"]


def random_steps(n, columns=()):
    """Three states with torque and wearer, and targets, at some moments."""
    rng, found = np.random.default_rng(0), []
    for k in range(3):
        q, v, last, pushed, *aim = rng.uniform(-1.0, 1.0, (7, n, *columns))
        v[:1] = aim[1][:1] = 0.0
        found.append((control.State(q, v, 6.0 + 0.01 * k, last, pushed), Target(*aim)))
    return found


def torques(law, steps):
    law, found = control.stateful(law), []
    memory = law.begin(steps[0][0])
    for state, target in steps:
        torque, memory = law.step(memory, state, target)
        found.append(torque)
    return np.array(found)


@pytest.mark.parametrize(("source", "name"), CASES)
@pytest.mark.parametrize("count", [1, 3])
def test_one_leg_and_many_get_the_same_torque(source, name, count):
    """Also as many legs as joints, where (n,) and (n, B) look alike."""
    law, steps = LAWS[name](SOURCES[source]), random_steps(control.ControlModel.of(SOURCES[source]).n, (count,))
    many = torques(law, steps)
    for k in range(count):
        alone = [
            (
                control.State(*(x[:, k] if isinstance(x, np.ndarray) else x for x in state)),
                Target(*(x[:, k] for x in target)),
            )
            for state, target in steps
        ]
        np.testing.assert_allclose(torques(law, alone), many[..., k], rtol=1e-9, atol=1e-10)


@pytest.mark.parametrize("name", LAWS)
def test_a_law_is_a_pure_function(name):
    """The same question gets the same answer, whatever was asked in between; torques and inputs stay as they are."""
    law = control.stateful(LAWS[name](SOURCES["est"]))
    (state, target), (other, aim), _ = random_steps(2)
    memory, before = law.begin(state), [x.copy() for x in (state.q, state.v, target.q, target.v)]
    first, after = law.step(memory, state, target)
    kept = first.copy()
    law.step(after, other, aim)
    np.testing.assert_array_equal(first, kept)
    np.testing.assert_array_equal(law.step(memory, state, target)[0], kept)
    for x, same in zip((state.q, state.v, target.q, target.v), before, strict=True):
        np.testing.assert_array_equal(x, same)
