"""The stick-slip problem: Coulomb's law, and an independent minimiser."""

import numpy as np
import pytest

from exoid.rig.stick_slip import Friction, descend, solve_stick_slip

B = 2000
SIZES = pytest.mark.parametrize("n", [1, 2, 3, 4, 5])


def problems(n: int, *, seed: int, static: bool = False, stops: bool = False):
    """M, impulse, friction and last velocities of B random rigs, some of them at rest."""
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(B, n, n))
    M = np.moveaxis(root @ root.transpose(0, 2, 1) + 0.1 * np.eye(n), 0, -1).copy()
    last = rng.normal(size=(n, B)) * (rng.random((n, B)) < 0.7)
    impulse = rng.normal(size=(n, B)) * rng.choice([0.1, 1.0, 3.0], (1, B))
    kinetic = rng.uniform(0.0, 2.0, (n, B)) * (rng.random((n, B)) < 0.9)
    most = kinetic * (rng.uniform(1.0, 1.5, (n, B)) if static else 1.0)
    low, high = -most, most.copy()
    if stops:
        low[rng.random((n, B)) < 0.15] = -np.inf
        high[rng.random((n, B)) < 0.15] = np.inf
    return M, impulse, Friction(kinetic, low, high), last


def without_turning(M, impulse, friction, last):
    """Solve as if the velocities before had the sign of those after: the plain problem, no joint turns within it."""
    b = (M * last).sum(axis=1) + impulse
    still = np.zeros_like(last)
    return solve_stick_slip(M, b, friction, still), b


def assert_coulomb(M, b, friction, slip):
    taken = b - (M * slip.v).sum(axis=1)
    scale = 1e-9 * (1.0 + np.abs(b).max(axis=0))
    moving = slip.v != 0.0
    assert 0.1 < moving.mean() < 0.95  # both occur
    rubbed = taken - friction.kinetic * np.sign(slip.v)
    assert (np.abs(rubbed) <= scale)[moving].all()
    assert ((taken <= friction.high + scale) & (taken >= friction.low - scale))[~moving].all()
    into_stop = ((slip.v > 0.0) & (friction.high == np.inf)) | ((slip.v < 0.0) & (friction.low == -np.inf))
    assert not into_stop.any()
    np.testing.assert_allclose(slip.impulse, taken, rtol=0, atol=1e-9 * np.abs(b).max())


@SIZES
@pytest.mark.parametrize("static", [False, True], ids=["", "static"])
@pytest.mark.parametrize("stops", [False, True], ids=["", "stops"])
def test_coulombs_law_holds(n, static, stops):
    """Kinetic friction against the motion, less than the static one at rest, nothing moves into a stop."""
    M, impulse, friction, last = problems(n, seed=n, static=static, stops=stops)
    slip, b = without_turning(M, impulse, friction, last)
    assert_coulomb(M, b, friction, slip)


@SIZES
def test_coulombs_law_holds_for_any_previous_velocity(n):
    """The previous velocities only give a guess of the pattern, unless a joint reverses."""
    M, impulse, friction, last = problems(n, seed=10 + n, stops=True)
    slip = solve_stick_slip(M, impulse, friction, last)
    b = (M * last).sum(axis=1) + impulse
    straight = np.flatnonzero((slip.v * last >= 0.0).all(axis=0))
    assert len(straight) > B // 20
    part = Friction(*(x[:, straight] for x in friction[:3]))
    plain, _ = without_turning(M, impulse, friction, last)
    np.testing.assert_allclose(slip.v[:, straight], plain.v[:, straight], rtol=0, atol=1e-9)
    taken = (b - (M * slip.v).sum(axis=1))[:, straight]
    assert ((taken <= part.high + 1e-9) & (taken >= part.low - 1e-9)).all()


@SIZES
@pytest.mark.parametrize("stops", [False, True], ids=["", "stops"])
def test_patterns_and_coordinate_descent_agree(n, stops):
    M, impulse, friction, last = problems(n, seed=30 + n, stops=stops)
    M = M + 0.5 * np.eye(n)[..., None]  # descent is slow where M is nearly singular
    slip, b = without_turning(M, impulse, friction, last)
    np.testing.assert_allclose(slip.v, descend(M, b, friction), rtol=0, atol=1e-8 * np.abs(slip.v).max())


def test_a_joint_that_reverses_has_friction_in_both_directions():
    """For one joint the share of the step before it turns solves a fixed-point equation; friction takes energy."""
    rng = np.random.default_rng(50)
    last, kinetic = rng.uniform(0.0, 1.0, (1, B)), rng.uniform(0.0, 0.3, (1, B))
    impulse = -last - 2.0 * kinetic - rng.uniform(0.0, 3.0, (1, B))  # strong enough to turn it
    slip = solve_stick_slip(np.ones((1, 1, B)), impulse, Friction(kinetic, -kinetic, kinetic), last)
    assert (slip.v < 0.0).all()
    np.testing.assert_allclose(last + impulse - slip.v, slip.impulse, atol=1e-12)
    share = last / (last - slip.v)
    assert np.abs(slip.impulse + kinetic * (1.0 - 2.0 * share)).max() < 0.1 * kinetic.max()
    plainly = last + impulse + kinetic  # had it rubbed the new way all along
    exact = slip.impulse * 0.5 * (last + slip.v)
    naive = -kinetic * 0.5 * (last + plainly)
    assert naive.min() < -1e-3  # which would have fed energy in
    assert exact.min() > 0.1 * naive.min()
