"""Mass of a load from the change of a leg's parameters."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from exoid.errors import BadArgumentError, NotIdentifiableError
from exoid.estimate import Estimate
from exoid.leg.payload import Payload
from exoid.regression.least_squares import scaled_inverse
from exoid.torques.payloads import payload_parameters


class LoadChange(NamedTuple):
    """Load that was added to a segment; prints itself.

    Attributes:
        joint: Joint that carries the segment.
        mass: Mass [kg]; negative for a load that was taken off.
        std: Its standard deviation [kg], wider by the misfit where that is above 1.
        misfit: Norm of the change that is left, over what the covariances expect: 1 or less for the right place.
    """

    joint: str
    mass: float
    std: float
    misfit: float

    def __str__(self) -> str:
        """Write one line."""
        # the misfit of the right place is about 1, whatever the parameters
        doubt = f"; misfit {self.misfit:.2g}: check the place of the load" if self.misfit > 3.0 else ""
        return f"load at {self.joint}: {self.mass:.3g} ± {self.std:.2g} kg{doubt}"


def load_change(before: Estimate, after: Estimate, joint: str, position: tuple[float, float, float]) -> LoadChange:
    """Estimate the mass of a load from the parameters before and after.

    A load of mass m at r changes the parameters by Δβ = m b(r), linear in m.

    Args:
        before: Estimate without the load.
        after: Estimate with it.
        joint: Joint that carries the segment, such as "knee" for the shank.
        position: Centre of mass of the load in the frame of that joint [m].

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
    precision = scaled_inverse((before.covariance + after.covariance)[:count, :count])
    column = payload_parameters(leg, [Payload(joint, 1.0, position)])
    information = float(column @ precision @ column)
    if information <= 0.0:
        raise NotIdentifiableError(f"a load at {joint} leaves no trace there", remedy="strap it elsewhere")
    mass = float(column @ precision @ change) / information
    left = change - mass * column
    misfit = float(np.sqrt(max(float(left @ precision @ left), 0.0) / max(count - 1.0, 1.0)))  # rounding leaves −1e-20
    return LoadChange(joint, mass, max(1.0, misfit) / float(np.sqrt(information)), misfit)
