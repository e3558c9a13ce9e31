"""A leg that stands is identified like any other: with delays of torques, and in groups."""

import dataclasses

import numpy as np
import pytest
from swings import late

import exoid
from exoid.experiments.ground import bleex_machine, single_support, squats_and_shifts, swing

pytestmark = pytest.mark.slow  # ten seconds of simulation

TERMS = (exoid.Coulomb(smoothing=0.02), exoid.Viscous(), exoid.Armature())
LATE = 0.012


@pytest.fixture(scope="module")
def runs():
    machine = bleex_machine()
    standing = [single_support(machine, 4.5, standing=foot, seed=1 + foot) for foot in (0, 1)]
    return [swing(machine, 4.5, seed=3), squats_and_shifts(machine, 4.5, seed=0), *standing]


def logs(runs, seed):
    """Logs of a harness that carries the torso, and of feet on the ground whose wrenches nobody measured."""
    return [run.recording(seed=seed + k, wrenches=("torso",) if k > 1 else ()) for k, run in enumerate(runs)]


def test_a_torque_that_is_late_beside_contacts_is_found_and_shifted(exo, runs):
    on_time = logs(runs, 0)
    right = exoid.identify(exo, on_time, TERMS, delay="auto", check=False)
    assert not right.torque_delays.any()
    found = exoid.identify(exo, [late(log, LATE, [1]) for log in on_time], TERMS, delay="auto", check=False)
    np.testing.assert_allclose(found.torque_delays, [0.0, LATE, 0.0, 0.0, 0.0, 0.0], atol=3e-4)
    (finding,) = [one for one in found.findings if one.kind == "torque-delay"]
    assert (finding.joint, finding.severity) == ("left_knee", "info")
    assert (np.abs(found.values - right.values) < right.std).all()


@pytest.mark.nightly
def test_standing_groups_share_parameters_and_have_some_of_their_own(exo, runs):
    """With other noise in each group, values agree; one whose offset differs has its own."""
    first, second = logs(runs, 0), logs(runs, 10)
    shifted = [dataclasses.replace(log, tau=log.tau + np.array([0.0, 3.0, 0.0, 0.0, 0.0, 0.0])) for log in second]
    terms = (*TERMS, exoid.Offset(joints=("left_knee",)))
    found = exoid.identify(exo, {"monday": first, "tuesday": shifted}, terms, own="offset")
    assert found.own == ("offset_left_knee",)
    offsets = [found[group].value("offset_left_knee") for group in found]
    assert offsets[1] - offsets[0] == pytest.approx(3.0, abs=0.1)
    assert {one.name for one in found["monday"].supports} >= {"left_foot", "right_foot", "left_foot and right_foot"}
    alone = exoid.identify(exo, first, terms)
    shared = [alone.names.index(name) for name in found.shared]
    assert (np.abs(found.values[: len(shared)] - alone.values[shared]) < 4.0 * alone.std[shared]).all()
    assert (found.std[: len(shared)] < alone.std[shared]).mean() > 0.8


@pytest.mark.parametrize(
    ("arguments", "kind"),
    [
        ({"estimator": "ml"}, exoid.errors.NotSupportedError),
        ({"terms": (exoid.torques.LoadFriction(),)}, exoid.errors.NotSupportedError),
        ({"preparation": "finite-difference"}, exoid.errors.NotSupportedError),
    ],
)
def test_what_rows_with_contacts_cannot_do_is_refused(exo, runs, arguments, kind):
    with pytest.raises(kind):
        exoid.identify(exo, logs(runs, 0)[:1], **{"terms": TERMS, **arguments})
