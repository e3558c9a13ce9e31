"""Mass of a load from the change of a leg's parameters."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError, NotIdentifiableError
from exoid.estimate import Estimate
from exoid.leg.leg import Leg
from exoid.leg.payload import Payload
from exoid.regression.least_squares import scaled_lstsq
from exoid.torques.payloads import payload_parameters

from .hypotheses import SPANNED


class LoadChange(NamedTuple):
    """Load that was added to a segment; prints itself.

    Attributes:
        joint: Joint that carries the segment.
        mass: Mass [kg]; negative for a load that was taken off.
        std: Its standard deviation [kg].
    """

    joint: str
    mass: float
    std: float

    def __str__(self) -> str:
        """Write one line."""
        return f"load at {self.joint}: {self.mass:.3g} ± {self.std:.2g} kg"


def load_change(
    before: Estimate, after: Estimate, joint: str, position: tuple[float, float, float] | None = None
) -> LoadChange:
    """Estimate the mass of a load from the parameters before and after.

    A load of mass m at r changes the parameters by Δβ = m b(r), linear in m. Where r is not known, the four parameters
    of the load in the plane are fitted; at the first joint its mass then leaves no trace.

    Args:
        before: Estimate without the load.
        after: Estimate with it.
        joint: Joint that carries the segment, such as "knee" for the shank.
        position: Centre of mass of the load in the frame of that joint [m]; None if it is not known.

    Returns:
        The mass by generalised least squares in the metric of both covariances.

    Raises:
        ExoidError: The estimates have different parameters, there is no such joint, or the mass leaves no trace.
    """
    leg = after.leg
    if before.names != after.names:
        raise BadArgumentError("the two estimates have different parameters", remedy="pass two of the same model")
    count = len(leg.parameter_names)
    change = after.values[:count] - before.values[:count]
    covariance = (before.covariance + after.covariance)[:count, :count]
    if position is not None:
        columns = payload_parameters(leg, [Payload(joint, 1.0, position)])[:, None]
    else:
        columns = _any_position(leg, joint)
    scale = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    lower = scipy.linalg.cholesky(covariance / np.outer(scale, scale) + 1e-12 * np.eye(count), lower=True)
    W, y = (scipy.linalg.solve_triangular(lower, (x.T / scale).T, lower=True) for x in (columns, change))
    found = scaled_lstsq(W, y)
    return LoadChange(joint, float(found[0]), float(np.sqrt(np.linalg.inv(W.T @ W)[0, 0])))


def _any_position(leg: Leg, joint: str) -> FloatArray:
    """Columns of a load of 1 kg at the joint, and of its first and second moments, (p, d)."""
    names = {**dict(zip(leg.joint_labels, leg.joint_names, strict=True)), **{name: name for name in leg.joint_names}}
    if joint not in names:
        raise BadArgumentError(f"no joint {joint!r}", remedy=f"name one of {', '.join(leg.joint_names)}")
    first = 10 * (leg.joint_names.index(names[joint]) + len(leg.bodies) - len(leg.joint_names))
    added = leg.reduction.collect[:, first : first + 10]
    U, sizes, _ = np.linalg.svd(added[:, 1:], full_matrices=False)
    moments = U[:, sizes > SPANNED * sizes[0]]
    alone = added[:, 0] - moments @ (moments.T @ added[:, 0])
    if np.linalg.norm(alone) <= SPANNED * max(float(np.linalg.norm(added[:, 0])), float(sizes[0])):
        raise NotIdentifiableError(
            f"the mass of a load at {joint} leaves no trace", remedy="say where it is (position=)"
        )
    return np.column_stack([added[:, 0], moments])
