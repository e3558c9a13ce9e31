"""A leg that stands on points, by the command line."""

from dataclasses import replace

import numpy as np
import pytest
from swings import harmonics

import exoid
from exoid.estimate import Estimate
from exoid.leg.base_kinematics import BaseKinematics
from exoid.leg.catalog import urdf_folder

URDF = str(urdf_folder() / "bleex.urdf")
JOINTS = tuple(f"{side}_{joint}" for side in ("left", "right") for joint in ("hip", "knee", "ankle"))
FEET = ("left_foot", "right_foot")


def sines(rng, time, sizes):
    """Sums of sines with two derivatives, (N, columns) each."""
    w, phase = 2.0 * np.pi * rng.uniform(0.2, 1.2, (4, len(sizes))), rng.uniform(0.0, 6.3, (4, len(sizes)))
    return harmonics(time, np.asarray(sizes)[:, None], w.T, phase.T)


def standing_on_points(seed, seconds=30.0):
    """A log of BLEEX on the origins of both feet, then of each; a rail holds the torso by a moment that is measured."""
    leg, rng = exoid.load_exo("bleex", base="floating"), np.random.default_rng(seed)
    time = np.arange(0.0, seconds, 0.01)
    q, v, a = sines(rng, time, [0.15] * 6)
    _, turn, change = sines(rng, time, [0.05])
    lateral, (push, _, _) = leg.plane.lateral, sines(rng, time, [0.4, 0.4])
    force = np.outer(push[:, 0], leg.plane.forward) + np.outer(9.81 + push[:, 1], leg.plane.up)
    rows = leg.inverse_dynamics(q, v, a, BaseKinematics(turn * lateral, change * lateral, force))
    third = np.floor(3.0 * time / seconds)
    contacts = {"left_foot": third != 1.0, "right_foot": third != 2.0}
    J = np.concatenate([leg.contact_jacobian(q, foot)[:, :2] * contacts[foot][:, None, None] for foot in FEET], axis=1)
    forces = np.einsum("nij,nj->ni", np.linalg.pinv(np.swapaxes(J[..., :2], 1, 2)), rows[:, :2])
    left = rows - np.einsum("nij,ni->nj", J, forces)
    assert np.abs(left[:, :2]).max() < 1e-9
    rail = exoid.Wrench(np.zeros((len(time), 3)), -left[:, 2:3] * lateral)
    return exoid.Recording(
        time,
        q,
        tau=left[:, 3:] + 0.02 * rng.standard_normal(q.shape),
        joint_names=JOINTS,
        base=exoid.BaseMotion.from_imu(turn * lateral, force),
        contacts=contacts,
        wrenches={"torso": rail},
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("leg", "ending", "place", "kind"),
    [((URDF, "--joints", ",".join(JOINTS)), "", "point", "point"), (("bleex",), "_heel", "0,0,0", "edge")],
)
def test_feet_rest_on_points_or_heels_if_one_says_so(exoid_, tmp_path, monkeypatch, leg, ending, place, kind):
    monkeypatch.chdir(tmp_path)
    log, feet = standing_on_points(1000), [foot + ending for foot in FEET]
    replace(log, contacts=dict(zip(feet, log.contacts.values(), strict=True))).to_csv("log.csv")
    options = ("--floating-base", "--terms", "none", "--no-check", "--alike", "left,right")
    contacts = [text for foot in feet for text in ("--contact", f"{foot}={place}")]
    assert exoid_("identify", leg[0], "log.csv", *leg[1:], *options, *contacts, "-o", "est.json").printed
    truth = exoid.load_exo("bleex", base="floating")
    estimate = Estimate.load("est.json")
    assert [each.kind for each in estimate.findings if "like-limbs" in each.kind] == ["alike-limbs"]
    assert dict(estimate.model.leg.contacts) == dict.fromkeys(feet, kind)
    inside = np.abs(estimate.values - truth.parameters) < 3.0 * estimate.std + 1e-3
    assert inside.all(), dict(zip(estimate.names, estimate.values - truth.parameters, strict=True))
    assert estimate["M"].value == pytest.approx(truth.parameters[0], rel=0.01)
