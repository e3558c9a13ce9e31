"""A real leg whose torque is a command: units and signs are those of a pendulum, and an estimate predicts its chirp."""

import numpy as np
import pytest

import exoid

AUTHORS = {"inner": (4.321897e-3, 5.452402e-3, 1.403128e-3), "outer": (4.374847e-3, 4.722823e-3, 2.158321e-3)}
"""J [kg·m²], Kc [N·m] and Kv [N·m·s/rad] that the authors identified, as in their files times 1e-3."""


@pytest.mark.real_data("sydney_swing_leg")
def test_the_recording_is_in_si_and_split_before_the_end_of_the_chirp():
    data = exoid.datasets.sydney_swing_leg("inner")
    assert data.leg.joint_names == ("leg",)
    assert len(data.train) + len(data.test) == 15_570
    assert data.train.sample_rate == pytest.approx(200.0)
    assert data.train.tau.max() == pytest.approx(5.0 * 18.3e-3)
    assert abs(data.train.q).max() == pytest.approx(np.radians(92.0654296875))


@pytest.mark.real_data("sydney_swing_leg")
@pytest.mark.real_data("sydney_swing_leg", "outer")
@pytest.mark.parametrize("which", ["inner", "outer"])
def test_the_estimate_is_that_of_the_authors_and_predicts_the_rest_of_the_chirp(which):
    data = exoid.datasets.sydney_swing_leg(which)
    est = exoid.identify(data.leg, data.train, check=False)
    inertia, coulomb, viscous = AUTHORS[which]
    assert est.value("J1") == pytest.approx(inertia, rel=0.06)
    assert est.value("c0_leg") == pytest.approx(coulomb, rel=0.25)
    assert est.value("d_leg") == pytest.approx(viscous, rel=0.2)
    assert exoid.validate(est, data.test).nrmse[0] < {"inner": 0.30, "outer": 0.21}[which]


@pytest.mark.real_data("sydney_swing_leg")
def test_a_command_that_stands_still_is_reported():
    """Five volts for five seconds look like a sensor at its limit; the torque is a command, and both are said."""
    data = exoid.datasets.sydney_swing_leg("inner")
    kinds = {finding.kind for finding in exoid.identify(data.leg, data.train).findings}
    assert {"saturation", "stuck-channel"} <= kinds
