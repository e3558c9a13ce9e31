"""The true torque of a wearer on the rig is found from the log, and the CAD model does not find it."""

import numpy as np
import pytest
from worn_rig import active, alone, at, cad_torque, log, machine, nrmse, passive

import exoid
from exoid.rig import Wearer

SEEDS = [0]


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["bleex", "cuhk"])
def test_the_torque_of_active_and_passive_wearers_is_found(name):
    one = machine(name)
    leg = one.plant.leg
    trained = alone(one, SEEDS, 40.0)
    estimates = [exoid.identify(leg, log(trained, k), one.terms) for k in SEEDS]
    for run in (active(one, SEEDS, 20.0), passive(one, SEEDS, Wearer.build(leg), 20.0)):
        inside = []
        for k, estimate in zip(SEEDS, estimates, strict=True):
            recording = log(run, k)
            found = exoid.interaction(estimate, recording)
            truth = at(estimate, recording, run.interaction[..., k], found.time)
            error = nrmse(found.torque, truth)
            assert found.worn
            assert (error[:2] < 0.04).all()  # the ankle's torque is hardly larger than the noise
            assert (nrmse(cad_torque(one, estimate, recording, found.time), truth) > 5.0 * error).all()
            inside.append(np.abs(found.torque - truth) <= found.band)
        share = np.mean(np.concatenate(inside))
        assert 0.88 < share < 0.995
    assert not any(exoid.interaction(estimate, log(trained, k)).worn for k, estimate in enumerate(estimates))
    other = alone(one, [7], 20.0, draw=1)
    assert not any(exoid.interaction(estimate, log(other, k)).worn for k, estimate in enumerate(estimates))
