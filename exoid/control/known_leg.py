"""A leg whose parameters are known, as an estimate without uncertainty."""

from __future__ import annotations

import numpy as np

from exoid.estimate import Estimate
from exoid.signals import FiniteDifference
from exoid.torques import Armature, Coulomb, Stiffness, Term, TorqueModel, Viscous
from exoid.torques.term import random_motion

from .model import ControlModel, ModelSource

ROWS = 400
"""Samples at which the torques of model and estimate agree."""


def as_estimate(source: ModelSource, torque_std: float) -> Estimate:
    """Convert the source of a model to an estimate.

    Args:
        source: An estimate, which is returned as it is; or a leg, a plant of one rig or a control model.
        torque_std: Standard deviation of the torque's error [N·m].

    Returns:
        Estimate with the parameters of the source, and a covariance of zero. Rotors that only add to a body's inertia
        are part of it.

    Raises:
        ExoidError: The source is none of these.
    """
    if isinstance(source, Estimate):
        return source
    model = ControlModel.of(source)
    torques = TorqueModel(model.leg, _terms(model))
    q, v, a = random_motion(ROWS, model.n)
    torque = model.inverse_dynamics(q.T, v.T, a.T) + model.friction(q.T, v.T, 0.0)
    W = torques.regressor(q, v, a).reshape(-1, len(torques.names))
    scale = np.linalg.norm(W, axis=0)
    values = np.linalg.lstsq(W / scale, torque.T.ravel(), rcond=None)[0] / scale
    return Estimate(
        model=torques,
        values=values,
        covariance=np.zeros((len(values), len(values))),
        condition_number=1.0,
        dof=float(ROWS),
        residual_rms=np.full(model.n, torque_std),
        estimator="known",
        preparation=FiniteDifference(),
    )


def _terms(model: ControlModel) -> tuple[Term, ...]:
    """Terms of the model whose coefficients are not zero."""
    labels = np.array(model.leg.joint_labels)
    springs: list[Term] = []
    for joint, label in enumerate(labels):
        powers = np.flatnonzero(model.spring[:, joint])
        if len(powers):
            springs.append(Stiffness(degree=len(model.spring) - 1 - int(powers[0]), joints=(str(label),)))
    plain: list[Term] = []
    for kind, coefficients in ((Coulomb, model.coulomb), (Viscous, model.viscous), (Armature, model.armature)):
        if coefficients.any():
            plain.append(kind(joints=tuple(labels[coefficients != 0.0].tolist())))
    others = list(dict.fromkeys(other.term for other in model.others))
    return (*springs, *plain, *others)
