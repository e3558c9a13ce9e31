r"""Parameters that links on the ground let a machine show, before any motion is planned.

Random motions are drawn that the contacts and the motors allow: with the rows Z of a support, on which its forces do no
work, and the projector N on combinations of them that no motor drives,

    J ν = 0,    J ν̇ = −J̇ ν,    N Zᵀ (M ν̇ + h) = 0    (Featherstone 2008, ch. 8).

A parameter is determined where no other change of the parameters leaves all rows Zᵀ Y π as they are.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import BoolArray, FloatArray
from exoid.errors import BadArgumentError
from exoid.leg.base_kinematics import BaseKinematics
from exoid.leg.leg import Leg
from exoid.leg.reduction.planar import GRAVITY
from exoid.leg.rewriting import RAILS
from exoid.regression.least_squares import INVOLVED, RANK
from exoid.signals.link_wrenches import link_placements
from exoid.tools.json_values import named
from exoid.tools.numbers import ROUNDED
from exoid.tools.tables import make_table, to_text
from exoid.torques import Term, TorqueModel
from exoid.torques.contacts.support_model import SupportModel

SAMPLES, STEP = 150, 1e-4
"""Number of random motions, and time over which the change of a Jacobian is computed [s]."""


class Supports(NamedTuple):
    """Parameters that supports determine, alone and all together; prints itself."""

    labels: tuple[str, ...]  # supports; the last is all of them
    names: tuple[str, ...]  # parameters, (P,)
    determined: BoolArray  # (number of labels, P)

    def __str__(self) -> str:
        """Print a row for each support, with the parameters that it determines or leaves open, whichever are fewer."""
        rows, most = [], 6  # names in a row of the table
        for label, seen in zip(self.labels, self.determined, strict=True):
            open_, told = (list(np.array(self.names)[seen == which]) for which in (False, True))
            few, what = (told, "only") if len(told) < len(open_) else (open_, "all but")
            more = f" and {len(few) - most} more" if len(few) > most else ""
            text = f"{what} {', '.join(few[:most])}{more}" if few else "all" if told else "none"
            rows.append((label, f"{len(told)} of {len(seen)}", text))
        return to_text(make_table(["unknown forces on", "determined", "parameters"], rows))

    def to_json(self) -> dict[str, dict[str, bool]]:
        """Tell for each support which parameters it determines."""
        return {
            label: named(self.names, seen) for label, seen in zip(self.labels, self.determined.tolist(), strict=True)
        }


def determined_on(leg: Leg, supports: Sequence[Sequence[str]], terms: Sequence[Term] = ()) -> Supports:
    """Tell which parameters can be determined while links rest by unknown forces.

    Whether a motion determines them well is another question, see :func:`assess`. Feet stand level
    and anywhere: side by side they show less.

    Args:
        leg: Machine with a floating base, or on a rail.
        supports: Links that rest at the same time, for each support; none in flight. A hook is a link whose contact is
            a point.
        terms: Terms as for :func:`exoid.identify`.

    Returns:
        Parameters that each support determines, and all of them together; a table when printed.

    Raises:
        ExoidError: A link is not in the URDF, or a support leaves no row.

    Example:
        >>> exo = exoid.load_exo("bleex", base="floating")
        >>> determined_on(exo, [["left_foot"], ["right_foot"]]).determined.sum(axis=1)
        array([13, 13, 22])
    """
    model = TorqueModel(leg, tuple(terms))
    rows = [_rows(model, tuple(links)) for links in supports]
    labels = [" + ".join(links) or "air" for links in supports]
    for label, each in zip(labels, rows, strict=True):
        if not len(each):
            raise BadArgumentError(
                f"unknown forces on {label} hold all joints of a leg whose base is fixed",
                where=leg.description.name,
                remedy='let the base move: base="floating", or --floating-base',
            )
    found = []
    for each in (*rows, np.vstack(rows)):  # what no direction involves that the rows do not see
        R = np.linalg.qr(np.vstack([each, 0.0 * each[: each.shape[1]]]), mode="r")
        scale = np.linalg.norm(R, axis=0)
        _, sigma, V = np.linalg.svd(R / np.where(scale > ROUNDED * scale.max(), scale, np.inf))
        found.append(np.linalg.norm(V[sigma <= RANK * sigma[0]], axis=0) < INVOLVED)
    return Supports((*labels, "all of these"), model.names, np.array(found))


def _rows(model: TorqueModel, links: tuple[str, ...]) -> FloatArray:
    """Rows of random motions on one support, (M, P)."""
    leg, rng = model.leg, np.random.default_rng(0)
    n, base = len(leg.joint_names), leg.base_rows
    low, high = np.maximum(leg.limits.lower, -1.5), np.minimum(leg.limits.upper, 1.5)
    tilts = 0.3 * rng.standard_normal((SAMPLES, 3))
    tilts = np.outer(tilts @ leg.plane.lateral, leg.plane.lateral) if leg.limbs else tilts
    up = GRAVITY * scipy.spatial.transform.Rotation.from_rotvec(tilts).apply(leg.plane.up)
    q = _level(leg, links, rng.uniform(low, high, (SAMPLES, n)), up)
    support = SupportModel.of(model, links, q)
    nu, change = rng.standard_normal((2, SAMPLES, base + n)) * [[[2.0]], [[9.0]]]

    def jacobian(q: FloatArray) -> FloatArray:
        each = [leg.contact_jacobian(q, link) for link in links]
        return np.concatenate(each, axis=1) if each else np.zeros((len(q), 0, base + n))

    J = jacobian(q)
    nu -= _solve(J, np.einsum("scv,sv->sc", J, nu))
    ahead, behind = (jacobian(q + sign * STEP * nu[:, base:]) for sign in (1.0, -1.0))
    drift = np.einsum("scv,sv->sc", (ahead - behind) / (2.0 * STEP), nu)
    motors = np.array([name not in {f"base_{axis}" for axis in RAILS} for name in leg.joint_names])
    shares = support.row_shares(q) if links else np.tile(np.eye(base + n)[base:], (SAMPLES, 1, 1))
    shares = (np.tile(np.eye(n), (SAMPLES, 1, 1)) if shares is None else shares)[:, motors]
    undriven = np.eye(shares.shape[2]) - np.linalg.pinv(shares, rcond=1e-6) @ shares
    still = leg.inverse_dynamics(q, nu[:, base:], 0.0 * q, _base(leg, nu, 0.0 * nu, up))
    by_rate = [support.row_payload(column, q) for column in np.moveaxis(leg.mass_matrix(q), 2, 0)]
    A = np.concatenate([J, undriven @ np.stack(by_rate, axis=2)], axis=1)
    b = np.concatenate([drift, np.einsum("srk,sk->sr", undriven, support.row_payload(still, q))], axis=1)
    change -= _solve(A, np.einsum("srv,sv->sr", A, change) + b)
    W = support.regressor(q, nu[:, base:], change[:, base:], _base(leg, nu, change, up))
    return np.asarray(W.reshape(-1, W.shape[2]))


def _level(leg: Leg, links: tuple[str, ...], q: FloatArray, up: FloatArray) -> FloatArray:
    """Turn the joints until flat feet stand on level ground, by Newton's method."""
    feet = [link for link in links if link != leg.description.root_link and leg.contact_kind(link) == "flat"]
    vertical = {link: link_placements(leg, 0.0 * q[:1], link).rotation[0, 2] for link in feet}

    def leans(q: FloatArray) -> FloatArray:
        each = [link_placements(leg, q, link).rotation @ axis - up / GRAVITY for link, axis in vertical.items()]
        return np.hstack(each)

    for _ in range(20 if feet else 0):
        changes = [(leans(q + STEP * one) - leans(q - STEP * one)) / (2.0 * STEP) for one in np.eye(q.shape[1])]
        q = q - np.clip(_solve(np.stack(changes, axis=2), leans(q)), -0.3, 0.3)
    return q


def _solve(A: FloatArray, b: FloatArray) -> FloatArray:
    """Smallest x of A x = b for each sample."""
    return np.asarray(np.einsum("svr,sr->sv", np.linalg.pinv(A, rcond=1e-6), b))


def _base(leg: Leg, nu: FloatArray, change: FloatArray, up: FloatArray) -> BaseKinematics | None:
    """Motion of the base from its coordinates among those of the rows, and the weight per mass `up`."""
    if leg.base_rows == 6:
        velocity, turn, push, turning = nu[:, :3], nu[:, 3:6], change[:, :3], change[:, 3:6]
        return BaseKinematics(turn, turning, push + np.cross(turn, velocity) + up)
    if not leg.base_rows:
        return None
    forward, lateral, upward = leg.plane
    turn, turning = -np.outer(nu[:, 2], lateral), -np.outer(change[:, 2], lateral)
    velocity, push = (x[:, :2] @ np.array([forward, upward]) for x in (nu, change))
    return BaseKinematics(turn, turning, push + np.cross(turn, velocity) + up).moved(-leg.hip)
