"""Source of a controller's model as an estimate with the terms whose coefficients can be refreshed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from exoid.errors import NotSupportedError
from exoid.estimate import Estimate
from exoid.regression.least_squares import scaled_lstsq
from exoid.signals import FiniteDifference
from exoid.torques import Armature, Coulomb, Offset, Stiffness, Term, TorqueModel, Viscous
from exoid.torques.motion import random_motion

from .model import ControlModel, ModelSource, completed

ROWS = 400
"""Samples at which the torques of model and estimate agree."""


def as_estimate(source: ModelSource, torque_std: float) -> Estimate:
    """Convert the source of a model to an estimate of bodies, springs, friction and rotors."""
    return _reduced(completed(source)) if isinstance(source, Estimate) else _known(ControlModel.of(source), torque_std)


def _reduced(source: Estimate) -> Estimate:
    """Leave other terms out of an estimate."""
    refreshed = (Offset, Stiffness, Coulomb, Viscous, Armature)
    kept = tuple(term for term in source.model.terms if type(term) in refreshed)
    if len(kept) == len(source.model.terms):
        return source
    model = TorqueModel(source.leg, kept, separate=source.model.separate)
    missing = [name for name in model.names if name not in source.names]
    if missing:
        raise NotSupportedError(
            f"without its other terms the model has {', '.join(missing)}, which the estimate lacks",
            remedy="use adaptive, or identify with Coulomb and viscous friction, stiffness, offsets and rotors only",
        )
    places = [source.names.index(name) for name in model.names]
    return Estimate(
        model=model,
        values=source.values[places],
        covariance=source.covariance[np.ix_(places, places)],
        condition_number=source.condition_number,
        dof=source.dof,
        residual_rms=source.residual_rms,
        estimator=source.estimator,
        preparation=source.preparation,
    )


def _known(model: ControlModel, torque_std: float) -> Estimate:
    """Parameters at which the torques of estimate and model are the same."""
    torques = TorqueModel(model.leg, _terms(model))
    q, v, a = random_motion(ROWS, model.n, model.leg.closure)
    plain = replace(model, others=())
    labels = model.leg.joint_labels
    rubbing = {f"{symbol}_{x}": row for symbol, row in (("c0", 0), ("d", 1)) for x in labels}
    friction = np.array([model.coulomb, model.viscous])
    values = np.zeros(len(torques.names))
    rest = [k for k, name in enumerate(torques.names) if name not in rubbing]
    for k, name in enumerate(torques.names):
        if name in rubbing:
            values[k] = friction[rubbing[name], labels.index(name.split("_", 1)[1])]
    W = torques.regressor(q, v, a)[..., rest].reshape(-1, len(rest))
    torque = plain.inverse_dynamics(q.T, v.T, a.T).T.ravel()
    values[rest] = scaled_lstsq(W, torque)
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
    return (*springs, *plain)
