"""Observers in C read the torque that they read in Python."""

import numpy as np
import pytest
from compiled import needs_compiler
from compiled_laws import compile_laws, records
from laws_of_bleex import model

from exoid.codegen import Safety, c_source
from exoid.control.observers import MomentumObserver, SensorNoise

JUMPED, SETTLING = 3, 4
NOISE = SensorNoise(1e-4, 1e-2, 0.1)
OBSERVERS = {
    "observer": MomentumObserver(model(), 8.0, 200.0, noise=NOISE, torque_delay=0.0),
    "unfiltered": MomentumObserver(model(), 8.0, 100.0, noise=NOISE, torque_delay=0.0, cutoff=np.inf),
}


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    folder = tmp_path_factory.mktemp("observers")
    sources = [
        c_source(observer, name=f"{name}_{precision}", precision=precision, safety=Safety("zero"))
        for name, observer in OBSERVERS.items()
        for precision in ("double", "float")
    ]
    return compile_laws(sources, folder, ("-O1",))


def motion(count, rate):
    """Smooth motion of three joints with the torque of the model and of somebody who pushes."""
    time = np.arange(count)[:, None] / rate
    phase = np.array([0.0, 1.0, 2.0])
    q = 0.4 * np.sin(5.0 * time + phase)
    v, a = 2.0 * np.cos(5.0 * time + phase), -10.0 * np.sin(5.0 * time + phase)
    pushed = 10.0 * np.sin(3.0 * time + phase)
    tau = np.array(
        [model().inverse_dynamics(*row) + model().friction(row[0], row[1], 0.05) for row in zip(q, v, a, strict=True)]
    )
    return {"q": q, "v": v, "tau_m": tau - pushed}, pushed


def in_python(observer, values):
    rows = list(zip(values["q"], values["v"], values["tau_m"], strict=True))
    memory, found = observer.begin(*rows[0]), []
    for row in rows:
        reading, memory = observer.step(memory, *row)
        found.append(reading.torque)
    return np.array(found)


@pytest.mark.slow
@needs_compiler
@pytest.mark.parametrize("name", OBSERVERS)
@pytest.mark.parametrize(("precision", "tolerance"), [("double", 1e-12), ("float", 2e-3)])
def test_a_moving_leg(library, name, precision, tolerance):
    law, observer = library[f"{name}_{precision}"], OBSERVERS[name]
    values, pushed = motion(120, observer.rate)
    tau, status, _ = law.run(records(law.source, 120, values))
    assert np.flatnonzero(status == SETTLING).tolist() == list(range(observer.settling))
    assert not status[observer.settling :].any()
    expected = in_python(observer, values)
    largest = np.abs(np.concatenate([values["tau_m"], expected])).max()
    np.testing.assert_allclose(tau, expected, atol=tolerance * largest)
    assert np.abs(tau[80:] - pushed[80:]).max() < 4.0  # it is the torque of the one who pushes, a little late


@needs_compiler
@pytest.mark.parametrize(
    ("field", "wrong", "said"), [("tau_m", np.nan, 1), ("v", -np.inf, 1), ("q", 1e300, 1), ("q", 0.5, JUMPED)]
)
def test_after_a_reading_that_python_refuses_the_observer_says_that_it_settles(library, field, wrong, said):
    law, observer = library["observer_double"], OBSERVERS["observer"]
    values, _ = motion(150, observer.rate)
    spoilt = {name: x.copy() for name, x in values.items()}
    spoilt[field][60, 2] += wrong
    tau, status, _ = law.run(records(law.source, 150, spoilt))
    settling = [SETTLING] * observer.settling
    assert status.tolist() == [*settling, *[0] * (60 - len(settling)), said, *settling, *[0] * (89 - len(settling))]
    assert not tau[60].any()
    after = in_python(observer, {name: x[61:] for name, x in values.items()})
    np.testing.assert_allclose(tau[61:], after, atol=1e-10)
    undisturbed, *_ = law.run(records(law.source, 150, values))
    np.testing.assert_allclose(tau[status == 0], undisturbed[status == 0], atol=0.1)
    repeated = records(law.source, 150, values)
    repeated["reading"][60:] -= 1
    assert np.flatnonzero(law.run(repeated)[1] == SETTLING).tolist() == [
        *range(len(settling)),
        *range(60, 60 + len(settling)),
    ]
