"""Unknown constants of drives, such as torque constants, found beside the parameters of the leg."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from itertools import chain
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.actuators import Actuators
from exoid.actuators.constants import DriveConstant, recompute, unknown_constants, with_constants
from exoid.errors import ExoidError, NotIdentifiableError
from exoid.estimate.nonlinear import NonlinearParameters
from exoid.leg.payload import Payload
from exoid.regression.diagnostics import WEAKLY
from exoid.regression.least_squares import TINY, scaled_lstsq
from exoid.regression.parameters import PriorKnowledge
from exoid.signals import Recording, Recordings

from .drives import DriveModel
from .estimators import Estimator
from .estimators.by_name import fit_linear
from .group_rows import Data, Group
from .problem import Fitted, Problem
from .recording_summary import RecordingSummary

ROUNDS = 30  # linearisations at most
STRIDE = 5.0  # in one of them a constant changes by this factor at most
ADVICE, COMMAND = (
    f"record the motion once more with a weighed payload on the last segment, {payload}, record the torque of a joint "
    f"or the force on a link by a sensor ({wrench}), or say what is known in N·m ({known}, torque_constant of a motor)"
    for payload, wrench, known in (
        ("Recording(payloads=...)", "wrenches=", "known="),
        ("--payload LOG=SEGMENT:KG@X,Y,Z", "wrench_<link>_fx", "--known"),
    )
)


def search_constants(given: Problem, estimator: Estimator) -> Fitted:
    """Find unknown constants of drives beside the parameters of a leg; the actuators of the result have them."""
    # Each round solves τ(i, κ₀) − τ_payload = W β − s δ, see `exoid.identification.drives.DriveModel`, and
    # goes on from κ = κ₀ / (1 − δ / κ₀). For one joint this is exact from any κ₀, as the equation is linear in 1 / κ.
    group, model, actuators = given.single, given.single.model, given.single.actuators
    assert actuators is not None
    constants = unknown_constants(actuators)
    names = tuple(each.name for each in constants)
    kappa = {each.name: each.constant.start for each in constants}
    beta, held, backwards = fit_linear(given, estimator).fit.solution.values, dict[str, str](), 0
    for _ in range(ROUNDS):
        free = tuple(each for each in constants if each.name not in held)
        found = with_constants(actuators, kappa)
        given_model = model.leg, model.terms, model.rigid, model.regrouped
        again = partial(recompute, found)
        if isinstance(group.data, Recordings):  # those on disk stay there
            data: Data = group.data.changed(again)
        else:
            data = [again(one) if isinstance(one, Recording) else one for one in group.data]
        linear = DriveModel(*given_model, model.separate, point=beta, constants=free, actuators=found)
        problem = given.changed(data=data, model=linear, actuators=found)
        try:
            fit = fit_linear(problem, estimator).fit
        except ExoidError as error:
            if any(name in error.what for name in names):
                error.remedy, error.command = ADVICE, COMMAND
            raise
        parts = (np.split(x, [len(beta)]) for x in (fit.solution.values, np.diag(fit.solution.covariance)))
        (values, moved), (_, variances) = parts
        step = _Step(beta, kappa, free, values, moved, np.sqrt(variances))
        if step.is_small and not step.at_bounds:
            break
        turned = [each.name for each, ratio in zip(free, step.moved / step.sizes, strict=True) if ratio >= 1.0]
        backwards = backwards + 1 if turned else 0
        if backwards == 3:  # so often in a row the sign of a constant must be wrong to be refused
            turned = _negative(group, [each for each in free if each.constant.is_scale]) or turned
            sensed = any(one.wrenches for one in group.motions)
            known = "sign and axes of force sensors" if sensed else "the payloads"
            what = f"{', '.join(turned)} would be negative: current and torque have opposite signs"
            remedy = f"give the motor a negative ratio, or the column a negative scale, and check {known}"
            command = f"give the column a negative scale, e.g. --column i_hip=HEADER:-1, and check {known}"
            raise NotIdentifiableError(what, remedy=remedy, command=command, parameters=tuple(turned))
        if step.is_small:
            held.update(step.at_bounds)
        beta, kappa = step.take()
    for each, value, std in zip(step.constants, step.sizes, step.std, strict=True):
        if std > WEAKLY * value:
            what = f"{each.name} = {value:.3g} ± {std:.2g} {each.constant.unit} is not determined by the recordings"
            remedy, command = (f"use a heavier payload or longer recordings: {each}" for each in (ADVICE, COMMAND))
            raise NotIdentifiableError(what, remedy=remedy, command=command)
    failure = f"{', '.join(names)} have not settled in {ROUNDS} rounds"
    unsettled = () if step.is_small and not step.at_bounds else (failure,)
    units, sizes = tuple(each.constant.unit for each in constants), np.array([kappa[name] for name in names])
    nonlinear = NonlinearParameters(names, units, sizes, np.zeros((len(names),) * 2), tuple(held))
    problem = problem.changed(actuators=with_constants(actuators, kappa))
    return Fitted(problem, fit, (model,), (*fit.warnings, *held.values(), *unsettled), nonlinear)


def _negative(group: Group, scales: Sequence[DriveConstant]) -> list[str]:
    """Name the scales of torques that are negative in W β − g τ = −τ_payload, a fit that is linear in β and g."""
    tables = []  # noise of the torques shrinks g, but leaves its sign
    for rows in chain.from_iterable(group.rows_of(index) for index in range(len(group.data))):
        known = np.zeros_like(rows.tau) if rows.known is None else rows.known
        for j, usable in enumerate(rows.usable.T):
            driven, torque = np.array([each.joint == j for each in scales]), (rows.tau + known)[usable, j]
            right = (-known if driven.any() else rows.tau)[usable, j]
            table = np.column_stack([rows.W[usable, j], np.multiply.outer(-torque, driven), right])
            tables.append(table / max(float(np.linalg.norm(torque)), TINY))
    whole = np.vstack(tables)
    gains = scaled_lstsq(whole[:, :-1], whole[:, -1])[-len(scales) :]
    return [each.name for each, gain in zip(scales, gains, strict=True) if gain < 0.0]


def refuse_unknown_scale(
    actuators: Actuators, summaries: Sequence[RecordingSummary], knowledge: PriorKnowledge
) -> None:
    """Refuse recordings without a drive's readings, or in which nothing is known in N·m."""
    # In the latter, a larger constant only makes the leg heavier.
    #
    # Known are a payload that has a mass, a measured wrench, a torque that was measured or computed with a known torque
    # constant, and a parameter that is known or has a prior, unless its value is zero.
    constants = unknown_constants(actuators)
    scales = [each for each in constants if each.constant.is_scale]
    free = np.isin(np.arange(len(actuators.joint_names)), [each.joint for each in scales])
    torques = [one.torques for one in summaries if one.torques is not None]
    unused = [each for each in constants if not any(of_one.computed[each.joint] for of_one in torques)]
    if unused:
        joints = ", ".join(dict.fromkeys(actuators.joint_names[each.joint] for each in unused))
        what = f"{', '.join(each.name for each in unused)}: no recording has torque of {joints} from its drive"
        remedy = "give its constants, leave it out, or read some recordings without that torque (unmeasured=)"
        command = "give its constants, leave it out, or read some logs without that torque (--unmeasured)"
        raise NotIdentifiableError(what, remedy=remedy, command=command)
    measured = any((of_one.measured & ~of_one.passive & ~(of_one.computed & free)).any() for of_one in torques)
    weighed = any(Payload.from_text(text).mass > 0.0 for one in summaries for text in one.evidence.payloads)
    values = [*knowledge.known.values(), *(value for value, _ in knowledge.prior.values.values())]
    if not (measured or weighed or any(values) or any(one.pulled for one in summaries)):
        found = f"nothing is known in N·m, so that {', '.join(each.name for each in scales)} cannot be found"
        what = f"{found}: a leg twice as heavy with motors twice as strong has the same currents"
        raise NotIdentifiableError(what, remedy=ADVICE, command=COMMAND)


class _Step(NamedTuple):
    """Solution of a round."""

    beta: FloatArray  # parameters β₀ at which the equations were linearised, (P,)
    kappa: dict[str, float]  # constants κ₀ there
    constants: tuple[DriveConstant, ...]  # those that were free, K of them
    values: FloatArray  # parameters β, (P,)
    moved: FloatArray  # changes δ of the constants, (K,)
    std: FloatArray  # their errors, (K,)

    @property
    def sizes(self) -> FloatArray:
        """Constants at which the equations were linearised, (K,)."""
        return np.array([self.kappa[each.name] for each in self.constants])

    @property
    def is_small(self) -> bool:
        """Whether constants have settled; one at a bound may want to go beyond."""
        # by parts of their standard deviations, and of themselves, where there is no noise
        still = np.abs(self.moved) <= 0.02 * self.std + 1e-7 * self.sizes
        pairs = zip(self.constants, still, strict=True)
        return all(is_still or each.name in self.at_bounds for each, is_still in pairs)

    @property
    def at_bounds(self) -> dict[str, str]:
        """Constants at a bound that would go beyond it, and what to say of them."""
        found = {}
        for each, size, moved in zip(self.constants, self.sizes.tolist(), self.moved.tolist(), strict=True):
            below = size <= each.constant.lower and moved < 0.0
            if below or (size >= each.constant.upper and moved > 0.0):
                side, where = "lower" if below else "upper", f"{size:g} {each.constant.unit}".removesuffix(" 1")
                found[each.name] = f"{each.name} is at its {side} bound, {where}, and held there"
        return found

    def take(self) -> tuple[FloatArray, dict[str, float]]:
        """Go on to constants within their bounds."""
        found = dict(self.kappa)
        ratios = 1.0 / np.clip(1.0 - self.moved / self.sizes, 1.0 / STRIDE, STRIDE)
        for each, ratio in zip(self.constants, ratios.tolist(), strict=True):
            found[each.name] = min(max(found[each.name] * ratio, each.constant.lower), each.constant.upper)
        scales = [ratio for each, ratio in zip(self.constants, ratios, strict=True) if each.constant.is_scale]
        scale = float(np.exp(np.mean(np.log(scales)))) if scales else 1.0
        return self.beta + scale * (self.values - self.beta), found
