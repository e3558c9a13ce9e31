"""Loads that are strapped on: found in slow gaits, never named wrongly with narrow intervals, and taken off again."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
import pytest

import exoid
from exoid.experiments import gait_for_leg, norm_gait
from exoid.online import RecursiveEstimator, load_change

pytestmark = pytest.mark.real_data("gait_norm", "Slow")

TERMS = (exoid.Coulomb(), exoid.Viscous(), exoid.Offset())
RATE = 100.0
PLACE = np.array([0.0, 0.0, -0.2])
JOINTS = ("hip", "knee", "ankle")


@dataclass(frozen=True)
class Walker:
    """Leg that is not in the package, with torques by Pinocchio, friction and noise."""

    text: str
    leg: exoid.Leg
    rng: np.random.Generator
    friction: np.ndarray

    @classmethod
    def of(cls, seed, folder):
        rng, parts, parent, above = np.random.default_rng(seed), [], "torso", 0.0
        for k, (joint, mass, length) in enumerate(zip(JOINTS, (9.0, 4.0, 1.5), (0.42, 0.4, 0.12), strict=True)):
            m, size = mass * rng.uniform(0.7, 1.3), length * rng.uniform(0.9, 1.1)
            inertia = m * size**2 / 12.0
            centre = f"{rng.uniform(-0.03, 0.03)} 0 {-size * rng.uniform(0.3, 0.6)}"
            moments = f'ixx="{inertia}" iyy="{inertia}" izz="{inertia / 5.0}" ixy="0" ixz="0" iyz="0"'
            parts += [
                f'<link name="l{k}"><inertial><origin xyz="{centre}"/><mass value="{m}"/><inertia {moments}/>'
                f'</inertial></link><joint name="{joint}" type="continuous"><parent link="{parent}"/>'
                f'<child link="l{k}"/><origin xyz="0 0 {-above}"/><axis xyz="0 1 0"/></joint>'
            ]
            parent, above = f"l{k}", size
        text = f'<robot name="walker"><link name="torso"/>{"".join(parts)}</robot>'
        path = folder / f"walker{seed}.urdf"
        path.write_text(text)
        return cls(text, exoid.Leg.from_urdf(path, JOINTS), rng, np.array([2.0, 1.5, 0.8]) * rng.uniform(0.5, 1.2, 3))

    def walk(self, period, seconds, load, begin=0.0):
        """Angles and torques with a load of so many kg on the shank, (N, 3) each."""
        gait, t = gait_for_leg(self.leg, norm_gait("Slow", period=period)), begin + np.arange(0.0, seconds, 1.0 / RATE)
        before, q, after = (np.array([gait.at(x).q.ravel() for x in t + h]) for h in (-1e-4, 0.0, 1e-4))
        v, a = (after - before) / 2e-4, (after - 2.0 * q + before) / 1e-8
        model = pin.buildModelFromXML(self.text)
        if load:
            body = pin.Inertia(load, PLACE, 1e-3 * load * np.eye(3))
            model.appendBodyToJoint(model.getJointId("knee"), body, pin.SE3.Identity())
        data, wrap = model.createData(), lambda x: np.ravel(np.column_stack([np.cos(x), np.sin(x)]))
        tau = np.array([pin.rnea(model, data, wrap(x), y, z) for x, y, z in zip(q, v, a, strict=True)])
        tau += self.friction * np.tanh(v / 0.02) + np.array([0.5, 0.3, 0.2]) * v
        return q, tau + np.array([0.4, 0.3, 0.2]) * self.rng.standard_normal(q.shape)


def changes_of(online):
    return [(one.kind, one.joint) for one in online.changes]


@pytest.mark.parametrize(
    ("seed", "period", "mass"),
    [
        (1003, 10.0, 1.4),
        (1000, 10.0, 2.0),
        *(pytest.param(1000 + k, 10.0, 1.0 + 0.5 * (k % 5), marks=pytest.mark.nightly) for k in range(4, 16)),
    ],
)
def test_a_load_is_found_within_a_slow_stride(tmp_path, seed, period, mass):
    walker = Walker.of(seed, tmp_path)
    online = RecursiveEstimator(walker.leg, TERMS, rate=RATE)
    begin = 40.0 + walker.rng.uniform(0.0, period)
    online.update(*_measured(walker.walk(period, begin, 0.0)))
    known = online.estimate
    assert not online.changes
    online.update(*_measured(walker.walk(period, period, mass, begin)))
    found = load_change(known, online.estimate, "knee", tuple(PLACE))
    assert found.mass == pytest.approx(mass, abs=0.1)
    assert abs(found.mass - mass) < 4.0 * found.std
    assert changes_of(online) == [("load", "knee")]


def test_while_the_motion_tells_no_load_from_another_intervals_say_so(tmp_path):
    """The hip alone moves: a load on the thigh, on the shank or on the foot does the same."""
    walker = Walker.of(1000, tmp_path)
    online = RecursiveEstimator(walker.leg, TERMS, rate=RATE)
    online.update(*_measured(walker.walk(4.0, 42.0, 0.0)))
    t = np.arange(0.0, 6.0, 1.0 / RATE)
    q, _ = walker.walk(4.0, 1.0 / RATE, 0.0, 42.0)
    hip = q[0, 0] + 0.4 * np.sin(2.0 * t) - 0.8 * t * np.exp(-t / 0.2)
    path = np.column_stack([hip, np.full_like(t, q[0, 1]), np.full_like(t, q[0, 2])])
    v, a = np.gradient(path, 1.0 / RATE, axis=0), np.gradient(np.gradient(path, 1.0 / RATE, axis=0), 1.0 / RATE, axis=0)
    model = pin.buildModelFromXML(walker.text)
    model.appendBodyToJoint(model.getJointId("knee"), pin.Inertia(2.0, PLACE, 2e-3 * np.eye(3)), pin.SE3.Identity())
    data = model.createData()
    at = [np.ravel(np.column_stack([np.cos(x), np.sin(x)])) for x in path]
    tau = np.array([pin.rnea(model, data, x, y, z) for x, y, z in zip(at, v, a, strict=True)])
    tau += walker.friction * np.tanh(v / 0.02) + np.array([0.5, 0.3, 0.2]) * v
    online.update(path, None, None, tau + 0.3 * walker.rng.standard_normal(tau.shape))
    finding = {one.kind: one for one in online.findings}["change-ambiguous"]
    assert {"X1", "X2"} <= set(finding.parameters)
    truth = exoid.Leg.from_description(exoid.leg.description.describe(walker.text), JOINTS)
    loaded = truth.reduction.collect[:, 10:20] @ pin.Inertia(2.0, PLACE, 2e-3 * np.eye(3)).toDynamicParameters()
    estimate = online.estimate
    error = estimate.values[:9] - truth.parameters - loaded
    assert (np.abs(error) < 5.0 * estimate.std[:9]).all()
    assert not online.changes


def test_a_load_that_is_taken_off_again_leaves_the_leg_that_was(tmp_path):
    """Ten seconds after it was strapped on, while its name is still on probation."""
    walker = Walker.of(1002, tmp_path)
    online = RecursiveEstimator(walker.leg, TERMS, rate=RATE)
    for seconds, load in ((42.0, 0.0), (10.0, 2.0), (12.0, 0.0)):
        online.update(*_measured(walker.walk(2.0, seconds, load)))
    estimate = online.estimate
    assert (np.abs(estimate.values[:9] - walker.leg.parameters) < 5.0 * estimate.std[:9]).all()


def _measured(samples):
    q, tau = samples
    count = 2.0 * np.pi / 65536
    return np.round(q / count) * count, None, None, tau
