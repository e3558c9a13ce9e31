"""Friction selected joint by joint on simulated robots: the terms that matter, another motion, and no joint driven."""

import numpy as np
import pytest
import study_selection as study

import exoid
from exoid.identification import select_terms
from exoid.signals import ZeroPhase


@pytest.mark.slow
@pytest.mark.parametrize(("name", "every"), [("cuhk", True), pytest.param("bleex", False, marks=pytest.mark.nightly)])
def test_the_terms_that_matter_are_found_at_each_joint_and_predict_another_motion(name, every):
    """As `scripts/study_selection.py` prints for robots with up to seven joints."""
    simulation = study.simulate(name, every=every)
    train, test = simulation.record(1), simulation.record(2)
    found = select_terms(simulation.leg, train)
    print(found)
    for joint, true in zip(found.joints, simulation.columns, strict=True):
        assert study.missing(joint, true) == []
    truth = exoid.identify(
        simulation.leg,
        train,
        simulation.model.terms,
        preparation=ZeroPhase(8.0),
        known=simulation.zero or None,
        check=False,
    )
    assert (exoid.validate(found.estimate, test).nrmse <= 1.15 * exoid.validate(truth, test).nrmse).all()
    _, v, _ = study.motion(simulation.leg, 1)
    load = np.abs(simulation.leg.inverse_dynamics(*study.motion(simulation.leg, 1))).max(axis=0)
    assert study.least_power(found, np.abs(v).max(axis=0), load) >= 0.0
    assert not any("settled" in warning for warning in found.estimate.warnings)


def test_a_model_that_lacks_a_term_is_told_from_one_that_has_it():
    """What the study counts as missing."""
    true = study.Pattern(("c0", "mu", "d"), presliding=True).columns(2e-3, 0.0)
    split = study.Pattern(("c0", "mu_drive", "mu_back", "d"), presliding=True).columns(2e-3, 0.0)
    half = study.Pattern(("c0", "mu_back", "d"), presliding=False).columns(0.0, 0.0)
    assert study.missing(study.JointFriction.of("hip", split), true) == []
    assert study.missing(study.JointFriction.of("hip", half), true) == ["mu", "presliding"]
