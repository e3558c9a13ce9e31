"""A fault needs a size that matters, not only significance: exact logs have no trifling findings."""

import dataclasses

import numpy as np
import pytest
from logs import clean, late, of_kind, with_column
from swings import Swing

import exoid
from exoid.identification.findings.checkup import FittedLeg, _checked
from exoid.identification.findings.least_sizes import LEAST_SIZES, LEAST_TORQUE, is_large_enough
from exoid.identification.findings.model_checks import _state_beside
from exoid.identification.findings.nuisance_columns import column_layout
from exoid.identification.findings.nuisances import Nuisance, always, nuisances
from exoid.identification.findings.sample import gather


def exact(name="bleex"):
    """Leg and log without any noise."""
    leg = exoid.load_leg(name)
    swing = Swing(leg, seconds=30.0, seed=1, smoothing=0.015)
    return leg, swing.recording(v=None, a=None)


def tilted(log, degrees):
    return with_column(log, "q", 0, lambda x: x - np.deg2rad(degrees))


@pytest.mark.parametrize("kind", LEAST_SIZES)
def test_a_kind_has_a_least_size(kind):
    fault, least = Nuisance(kind, "knee", 1, "", (0,)), LEAST_SIZES[kind]
    assert not is_large_enough(fault, np.array([-0.9 * least]), 1.0)
    assert is_large_enough(fault, np.array([-1.1 * least]), 0.0)


@pytest.mark.parametrize("kind", ["unmodelled-friction", "unmodelled-force"])
def test_friction_and_forces_need_a_part_of_the_torque(kind):
    fault = Nuisance(kind, "knee", 1, "N·m", (0, 1), group=True)
    assert not is_large_enough(fault, np.array([5.0, 5.0]), 0.9 * LEAST_TORQUE)
    assert is_large_enough(fault, np.array([1e-6, 0.0]), 1.1 * LEAST_TORQUE)


@pytest.mark.parametrize("name", ["bleex", "cuhk"])
def test_an_exact_log_has_no_findings(name):
    assert exoid.check(*exact(name)) == ()


def test_a_trifling_fault_of_an_exact_log_is_not_reported_and_a_small_one_is_no_error():
    leg, log = exact()
    assert exoid.check(leg, tilted(log, 0.05)) == ()
    assert exoid.check(leg, late(log, 1e-4, range(3))) == ()
    finding = of_kind(exoid.check(leg, tilted(log, 0.5)), "gravity-direction")
    assert finding.severity == "warning"
    assert abs(finding.value) == pytest.approx(np.deg2rad(0.5), rel=0.05)
    assert of_kind(exoid.check(leg, tilted(log, 10.0)), "gravity-direction").severity == "error"


def test_a_spring_makes_parameters_of_other_joints_doubtful_too():
    """A strap that looks like a spring at one joint pulls at the others as well."""
    leg, log = clean()
    pulled = dataclasses.replace(log, tau=log.tau + np.array([0.0, 5.0, 0.0]) * log.q)
    estimate = exoid.identify(leg, pulled)
    assert {"X1", "Y1", "X2", "Y2", "X3", "Y3"} <= estimate.doubtful
    assert "well" not in estimate.identifiability


def test_the_zero_of_the_last_joint_is_information_from_two_degrees_on():
    leg, log = clean("cuhk")
    finding = of_kind(exoid.check(leg, with_column(log, "q", 1, lambda x: x + np.deg2rad(2.0))), "angle-offset")
    assert (finding.joint, finding.severity) == (leg.joint_names[1], "info")
    assert finding.value == pytest.approx(np.deg2rad(2.0), rel=0.1)
    assert exoid.check(leg, with_column(log, "q", 1, lambda x: x + np.deg2rad(1.0))) == ()


def test_what_is_left_out_at_once_is_not_significant_alone():
    leg, log = clean()
    estimate = exoid.identify(leg, log, check=False)
    fitted = FittedLeg(
        estimate.model, estimate.preparation, np.full(len(estimate.names), np.nan), estimate.values, estimate.covariance
    )
    evidence, layout = gather(_checked(fitted, [log]), estimate.values), column_layout(estimate.model)
    state, every = _state_beside(evidence, (), always(layout)), nuisances(estimate.model, layout)
    left_out = set(every) - set(state.conspicuous(every))
    assert len(left_out) > len(every) // 3
    alone = [state.test(one) for one in left_out]
    assert all(score is None or score.p_value > 0.01 for score in alone)
