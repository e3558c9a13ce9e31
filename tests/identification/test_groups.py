"""Several legs or sessions at once: shared parameters gain, own ones stay apart, in one least-squares problem."""

import dataclasses

import numpy as np
import pytest
from sessions import TERMS, Noise, Session, truth_of
from unchecked import identify

import exoid
from exoid import ExoidError, compare
from exoid.regression.every_row import make_rows
from exoid.signals import FiniteDifference, Poses
from exoid.torques import TorqueModel

PLAIN = FiniteDifference()
ZEROS = {"monday": (1.5, -0.8, 0.2), "tuesday": (-0.9, 0.5, -0.3), "friday": (0.1, 1.2, 0.4)}


@pytest.fixture(scope="module")
def legs(leg):
    return {"left": leg, "right": exoid.load_leg("bleex", side="right", inertias="cad")}


@pytest.fixture(scope="module")
def days(leg):
    """One leg on three days, the torque sensors zeroed anew on each."""
    return {day: Session(leg, seed, zero) for seed, (day, zero) in enumerate(ZEROS.items(), 1)}


@pytest.fixture(scope="module")
def sides(legs):
    """Two legs of one design; the right one's joints have more friction."""
    return {
        "left": Session(legs["left"], 1),
        "right": Session(legs["right"], 2, (0.3, 0.0, -0.1), (1.1, 0.6, 0.4), (0.5, 0.5, 0.2)),
    }


def record(sessions, seed=0, **noises):
    """A recording of each session; without noise unless it is given."""
    rng = np.random.default_rng(seed)
    return {name: session.recording(rng, noises.get(name, Noise())) for name, session in sessions.items()}


def test_one_offset_for_all_days_must_be_wrong(leg, days):
    """Without noise, inertia and friction are off where there is but one offset, and exact where each day has one."""
    recordings, truth = record(days), days["monday"].truth
    plain = identify(leg, recordings.values(), TERMS, preparation=PLAIN)
    shared = [k for k, name in enumerate(plain.names) if not name.startswith("offset")]
    off = np.abs(plain.values - list(truth.values()))[shared]
    together = identify(leg, recordings, TERMS, own="offset", preparation=PLAIN)
    right = np.abs(together.values - truth_of(together, days))[: len(shared)]
    assert (off > 1e4 * right).all()
    assert (plain.residual_rms > 0.2).all()


@pytest.mark.slow
@pytest.mark.parametrize(("estimator", "noise"), [("ols", "white"), ("wls", "correlated"), ("huber", "correlated")])
def test_one_group_is_the_same_as_identify(leg, days, estimator, noise):
    """Whatever is shared: the order of the parameters is all that changes."""
    recordings = list(record(days, **dict.fromkeys(days, Noise((0.3, 0.2, 0.1), 0.9))).values())
    expected = identify(leg, recordings, TERMS, estimator, noise=noise)
    for own in (None, (), ("offset", "J2")):
        found = identify(leg, {"all": recordings}, TERMS, estimator, noise=noise, own=own)["all"]
        np.testing.assert_allclose(found.values, expected.values, rtol=1e-8, atol=1e-10)
        np.testing.assert_allclose(found.covariance, expected.covariance, rtol=1e-6, atol=1e-9 * expected.std.max())
        for name in (
            *("condition_number", "dof", "dof_each", "residual_rms"),
            *("parameter_scale", "reference_scale", "collinearity"),
        ):
            np.testing.assert_allclose(getattr(found, name), getattr(expected, name), rtol=1e-6, err_msg=name)
        assert [n.order for n in found.noise] == [n.order for n in expected.noise]
        assert (found.inputs, found.preparation) == (expected.inputs, expected.preparation)


def test_where_nothing_is_shared_each_group_is_identified_as_alone(legs, sides):
    """Up to where the iterations of noise and covariance stop: for all groups at once."""
    recordings = record(sides, left=Noise(0.1), right=Noise((0.6, 0.4, 0.2), 0.9))
    names = TorqueModel(legs["left"], TERMS).names
    together = identify(legs, recordings, TERMS, "huber", own=names)
    assert together.shared == ()
    estimates = [identify(legs[side], recordings[side], TERMS, "huber") for side in legs]
    for expected, found in zip(estimates, (together[side] for side in legs), strict=True):
        np.testing.assert_allclose(found.values, expected.values, rtol=1e-4, atol=1e-4)
        np.testing.assert_allclose(found.std, expected.std, rtol=2e-3)
        np.testing.assert_allclose(found.dof, expected.dof, rtol=2e-3)
        np.testing.assert_allclose(found.dof_each, expected.dof_each, rtol=0.05)
        np.testing.assert_allclose(found.condition_number, expected.condition_number, rtol=1e-3)
    crossed = together.covariance[: len(names), len(names) :]
    assert np.abs(crossed).max() < 1e-12
    one, other = compare(*estimates), together.compare("left", "right")
    np.testing.assert_allclose(other.p_values, one.p_values, atol=5e-3)
    assert other.p_value == pytest.approx(one.p_value, abs=5e-3)
    assert other.names == one.names


def test_it_is_one_dense_least_squares_problem(legs, sides):
    """All rows of both legs, put together by hand, weighted by the residuals of a first solution, solved by numpy."""
    recordings = record(sides, left=Noise((0.3, 0.2, 0.1)), right=Noise((0.6, 0.1, 0.2)))
    own = ("c0", "d_knee", "offset", "J1")
    together = identify(legs, recordings, TERMS, own=own, preparation=PLAIN, noise="white")
    blocks, torques = [], []
    for side in legs:
        model = TorqueModel(legs[side], TERMS)
        rows = make_rows(model, recordings[side], PLAIN)
        mine = [f"{name}[{side}]" if f"{name}[{side}]" in together.names else name for name in model.names]
        places = [together.names.index(name) for name in mine]
        for joint in range(3):
            wide = np.zeros((len(rows.tau), len(together.names)))
            wide[:, places] = rows.W[:, joint]
            blocks.append(wide)
            torques.append(rows.tau[:, joint])
    first, *_ = np.linalg.lstsq(np.vstack(blocks), np.concatenate(torques))
    weights = [1.0 / np.sqrt(np.mean((W @ first - tau) ** 2)) for W, tau in zip(blocks, torques, strict=True)]
    W = np.vstack([w * x for w, x in zip(weights, blocks, strict=True)])
    tau = np.concatenate([w * x for w, x in zip(weights, torques, strict=True)])
    expected, *_ = np.linalg.lstsq(W, tau)
    np.testing.assert_allclose(together.values, expected, rtol=1e-8, atol=1e-9)
    s2 = np.sum((tau - W @ expected) ** 2) / (len(tau) - len(expected))
    np.testing.assert_allclose(together.covariance, s2 * np.linalg.inv(W.T @ W), rtol=1e-6, atol=1e-12)
    assert together.condition_number == pytest.approx(np.linalg.cond(W / np.linalg.norm(W, axis=0)), rel=1e-8)
    for side, count in zip(legs, (0, 3), strict=True):  # the group's condition: the other's own columns projected out
        others = [k for k, name in enumerate(together.names) if name.endswith("]") and not name.endswith(f"[{side}]")]
        mine = [k for k in range(len(together.names)) if k not in others]
        basis, _ = np.linalg.qr(W[:, others])
        rest = W[:, mine] - basis @ (basis.T @ W[:, mine])
        condition = np.linalg.cond(rest / np.linalg.norm(rest, axis=0))
        assert together[side].condition_number == pytest.approx(condition, rel=1e-6), count


def test_parameters_that_differ_are_named_and_the_others_not(legs, sides):
    together = identify(legs, record(sides, left=Noise(0.1), right=Noise(0.1)), TERMS)
    assert set(together.equal.below(0.05)) == {"c0_hip", "d_knee", "offset_hip", "offset_ankle"}
    comparison = together.compare("left", "right")
    assert comparison.differ
    assert {n for n, p in zip(comparison.names, comparison.adjusted, strict=True) if p < 0.05} >= {"c0_hip", "d_knee"}
    np.testing.assert_allclose(
        comparison.difference, together["right"].values[9:] - together["left"].values[9:], rtol=1e-12
    )
    assert not together.warnings


def test_errors_in_common_cancel_in_a_comparison(legs, sides):
    """The hip's offset looks like Y1, which both share: their difference is known far better than each offset."""
    together = identify(legs, record(sides, left=Noise(0.2), right=Noise(0.2)), TERMS)
    comparison = together.compare("left", "right")
    hip = comparison.names.index("offset_hip")
    alone = np.hypot(*(together[side].std[together[side].names.index("offset_hip")] for side in legs))
    assert comparison.std[hip] < 0.5 * alone
    assert abs(comparison.difference[hip] - 0.3) < 4.0 * comparison.std[hip]


def test_groups_that_do_not_agree_on_what_they_share_are_told(legs, sides):
    """The right shank has picked up 5 % of inertia: sharing it would be wrong, and is said to be."""
    changed = dict(sides)
    values = legs["right"].parameters * np.array([1, 1, 1, 1, 1, 1.05, 1, 1, 1])
    changed["right"] = dataclasses.replace(sides["right"], leg=legs["right"].with_parameters(values))
    recordings = record(changed, left=Noise(0.05), right=Noise(0.05))
    together = identify(legs, recordings, TERMS)
    assert "J2" in together.agreement.below(0.01)
    assert any("do not agree on" in warning and "J2" in warning for warning in together.warnings)
    mended = identify(legs, recordings, TERMS, own=("c0", "d", "offset", "J1", "J2"))
    assert not mended.warnings
    assert "J2" in mended.equal.below(0.05)


def test_poses_may_be_a_group_of_their_own(leg, days):
    """Static poses on another day, when only the sensors' zero was another: friction leaves no trace in them."""
    rng = np.random.default_rng(3)
    q = rng.uniform(-0.8, 0.8, (80, 3))
    tau = leg.inverse_dynamics(q, 0 * q, 0 * q) + ZEROS["friday"] + rng.normal(scale=0.1, size=q.shape)
    groups = {"moving": days["monday"].recording(rng, Noise(0.2)), "poses": Poses(q, tau, leg.joint_names)}
    together = identify(leg, groups, TERMS, own="offset")
    error = together.values - truth_of(together, {"moving": days["monday"], "poses": days["friday"]})
    assert (np.abs(error) < 4.0 * together.std).all()
    assert together.agreement is None
    assert any("poses cannot be identified alone" in note for note in together.notes)
    alone = exoid.identify(leg, groups["poses"], TERMS[2:], known={f"J{k}": 1.0 for k in (1, 2, 3)})
    assert alone.model_error is None  # friction of any form left no trace
    with pytest.raises(ExoidError, match=r"c0_hip\[poses\].*left no trace"):
        identify(leg, groups, TERMS, own=("offset", "c0"))


def test_known_values_and_priors_may_be_of_all_groups_or_of_one(leg, days):
    recordings = record(days, **dict.fromkeys(days, Noise(0.2)))
    together = identify(
        leg,
        recordings,
        TERMS,
        own="offset",
        known={"X3": 0.3, "offset_hip[monday]": 1.5},
        prior={"offset_knee": (0.1, 1e-4), "J1": (days["monday"].truth["J1"], 1e-3)},
    )
    values = dict(zip(together.names, together.values, strict=True))
    assert (values["X3"], values["offset_hip[monday]"]) == (0.3, 1.5)
    assert values["offset_hip[tuesday]"] != 1.5
    assert all(abs(values[f"offset_knee[{day}]"] - 0.1) < 1e-3 for day in days)
    assert together["monday"].prior_knowledge.known == {"X3": 0.3, "offset_hip": 1.5}
    assert together["tuesday"].prior_knowledge.known == {"X3": 0.3}
    assert set(together["tuesday"].prior_knowledge.prior.values) == {"offset_knee", "J1"}
    identifiability = dict(zip(together.names, together.identifiability, strict=True))
    assert (identifiability["X3"], identifiability["offset_knee[friday]"]) == ("known", "prior")


def test_what_is_part_of_a_shared_parameter_is_said_to_be(legs, sides):
    terms = (*TERMS, exoid.Armature())
    together = identify(legs, record(sides), terms, own="Ia", preparation=PLAIN)
    assert together.own == ("Ia_knee", "Ia_ankle")
    assert any("Ia_hip" in note and "the same in all groups" in note for note in together.notes)
    apart = identify(legs, record(sides), terms, own=("Ia", "J1"), preparation=PLAIN)
    assert not any("the same in all groups" in note for note in apart.notes)
