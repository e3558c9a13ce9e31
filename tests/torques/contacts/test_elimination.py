"""Rows of a leg on the ground: unknown wrenches do no work on them, and what they keep fulfils the equation."""

import numpy as np
import pytest
from standing import standing

import exoid
from exoid import Armature, Coulomb, Viscous
from exoid.signals import ZeroPhase
from exoid.signals.moving_base import base_during
from exoid.torques import TorqueModel
from exoid.torques.contacts.elimination import eliminate, reference_axes
from exoid.torques.contacts.standing_base import standing_base
from exoid.torques.contacts.support_model import SupportModel

FEET = {"both": ("left_foot", "right_foot"), "left": ("left_foot",)}


@pytest.mark.parametrize("feet", FEET)
def test_rows_without_the_wrenches_fulfil_the_equation(exo, feet):
    log = standing(exo, feet, seconds=4.0)
    links, (q, v, a) = FEET[feet], log.exact
    model = SupportModel.of(TorqueModel(exo, ()), links, q)
    motion = model.motion(q, v, a, log.base)
    torque = model.row_torque(log.recording.tau, motion, {})
    assert torque.shape == (len(q), 6 if feet == "left" else 3) == (len(q), len(model.row_names))
    np.testing.assert_allclose(np.tensordot(exo.parameters, model.columns(motion), 1).T, torque, atol=1e-9)
    assert np.abs(torque).max() > 10.0


@pytest.mark.parametrize("feet", FEET)
def test_measured_wrenches_fulfil_the_equation_on_all_rows(exo, feet):
    log = standing(exo, feet, seconds=4.0)
    model = TorqueModel(exo, ())
    motion = model.motion(*log.exact, log.base)
    torque = model.row_torque(log.recording.tau, motion, log.wrenches)
    assert model.row_names[:3] == ("base_forward", "base_up", "base_pitch")
    np.testing.assert_allclose(np.tensordot(exo.parameters, model.columns(motion), 1).T, torque, atol=1e-9)


@pytest.mark.parametrize("feet", FEET)
def test_no_wrench_on_a_resting_link_changes_a_row(exo, feet):
    log, links, rng = standing(exo, feet, seconds=4.0), FEET[feet], np.random.default_rng(0)
    model = SupportModel.of(TorqueModel(exo, ()), links, log.exact[0])
    motion = model.motion(*log.exact, log.base)
    pushes = {}
    for link in links:
        force, moment = 100.0 * rng.standard_normal((2, len(log.base), 3))
        pushes[link] = exoid.Wrench(force, moment)
    added = model.row_torque(np.zeros_like(log.recording.tau), motion, pushes)
    np.testing.assert_allclose(added, 0.0, atol=1e-9)


def test_rows_of_closed_chains_have_the_noise_of_one_torque(exo):
    """Zᵀ Z = 1, so that white noise of the torques is white noise of the rows."""
    log, links = standing(exo, "both", seconds=4.0), FEET["both"]
    found = eliminate(exo, links, log.exact[0], reference_axes(exo, links, log.exact[0]))
    unit = np.einsum("njr,njs->nrs", found.loop, found.loop)
    np.testing.assert_allclose(unit, np.broadcast_to(np.eye(3), unit.shape), atol=1e-12)
    assert found.fit.all()
    jumps = np.abs(np.diff(found.loop, axis=0)).max()
    assert jumps < 0.05, "the directions have to vary smoothly, as rows are filtered"


def test_friction_of_a_joint_stays_in_its_row_on_one_foot(exo):
    model = SupportModel.of(TorqueModel(exo, (Coulomb(), Viscous(), Armature())), ("left_foot",), np.zeros((1, 6)))
    names = list(model.names)
    for row, joint in enumerate(exo.joint_names):
        own = [names.index(f"{symbol}_{joint}") for symbol in ("c0", "d", "Ia")]
        assert model.acting[row, own].all()
        others = [k for k, name in enumerate(names) if name.startswith(("c0_", "d_", "Ia_")) and k not in own]
        assert not model.acting[row, others].any()


def test_a_resting_foot_says_how_the_base_moves(exo):
    log = standing(exo, "left", seconds=10.0)
    base = standing_base(exo, log.recording, "left_foot")
    found = base_during(
        exoid.Recording(log.recording.time, log.recording.q, joint_names=exo.joint_names, base=base), ZeroPhase(8.0)
    )
    inner = slice(100, -100)
    np.testing.assert_allclose(found.specific_force[inner], log.base.specific_force[inner], atol=1e-6)
    np.testing.assert_allclose(found.angular_velocity[inner], log.base.angular_velocity[inner], atol=1e-6)
    np.testing.assert_allclose(found.angular_acceleration[inner], log.base.angular_acceleration[inner], atol=1e-5)
