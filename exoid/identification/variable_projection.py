"""Variable projection: fits of models that are linear in most parameters but not in all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.errors import NotIdentifiableError
from exoid.estimate.nonlinear import NonlinearParameters
from exoid.regression.fit import Fit
from exoid.regression.least_squares import factorize, scaled_lstsq, scaled_pinv, stack
from exoid.torques import TorqueModel
from exoid.torques.linearised import linearise
from exoid.torques.nonlinear import nonlinear_settings, with_settings

from .estimators import Estimator
from .estimators.by_name import fit_by
from .problem import Fitted, Problem

PASSES = 6  # passes over the rows at most to settle the parameters at given settings
SETTLED = 1e-3  # they have settled when predictions change by less than this part of the residual
ROUNDS = 2  # sets of weights at most
XTOL, FTOL = 3e-3, 1e-6  # search ends when settings, relatively, or the sum of squares change by less
INSIDE = 1e-6  # a trust-region search begins this far from the bounds of the settings' logarithms
TINY = 1e-9  # residuals below this part of the torque are rounding
UNDETERMINED = 1.0  # a setting whose standard deviation is larger than this part of it is not determined
POLISH = 8  # steps at most with the estimator asked for, from the optimum of weighted least squares
STRIDE = 3.0  # in one of them a setting changes by this factor at most
STILL = 0.1  # these have converged when nothing moves by more than this part of its standard deviation,
ROUNDING = 1e-6  # and this part of itself, where there is no noise; or when predictions have settled


class VariableProjection:
    """Fit of a model that is not linear in all parameters: these are solved for at each trial of the settings."""

    # With rows [J_β J_θ r] reduced to a R factor R, r the torque less what the settings explain, R's lower right corner
    # holds the residual after the best β and its derivative by θ (Kaufman's), which is all that a trust-region method
    # asks for; the rows themselves are never kept.

    def __init__(self, given: Problem, estimator: Estimator) -> None:
        self.given, self.estimator, self.leg = given, estimator, given.model.leg
        self.nonlinear = nonlinear_settings(given.terms, self.leg.joint_names, self.leg.joint_labels)
        self.knowledge, names = given.prior_knowledge, given.model.names
        self.regrouped, self.free = given.model.regrouped, self.knowledge.free(names)
        self.settings: dict[str, float] = {s.name: s.free.start for s in self.nonlinear}
        self.weights: Sequence[float] | None = None
        self.values = self.knowledge.fixed_values(names)
        self._settle()
        self._weigh()

    def run(self) -> Fitted:
        """Find the settings by weighted least squares, and go on from there with the estimator asked for."""
        if not self.nonlinear:
            self._settle()
            return self._polish()
        bounds = np.log([s.free.lower for s in self.nonlinear]), np.log([s.free.upper for s in self.nonlinear])
        inside = bounds[0] + INSIDE, bounds[1] - INSIDE
        for _ in range(ROUNDS):
            start = np.clip(np.log(list(self.settings.values())), *inside)
            # Settings tried at most, for one set of weights
            found = scipy.optimize.least_squares(
                self._residual, start, self._slope, bounds=bounds, xtol=XTOL, ftol=FTOL, max_nfev=40
            )
            self._residual(found.x)
            self._weigh()
            if np.abs(found.x - start).max() < 10.0 * XTOL:
                break
        return self._polish()

    def _polish(self) -> Fitted:
        """Go on with the estimator asked for, in the parameters and the settings at once."""
        self._refuse_unloaded()
        held = self._at_bounds()
        held.update(self._undetermined(held))
        unsettled: tuple[str, ...] = ()
        change = np.inf
        for _ in range(POLISH):
            problem = self._problem(tuple(held))
            fit = fit_by(self.estimator, problem)
            found = dict(zip(problem.names, fit.solution.values, strict=True))
            before = np.append(self.values, [self.settings[name] for name in problem.names[len(self.values) :]])
            moved = fit.solution.values - before
            self._take(found)
            late = {name: why for name, why in self._at_bounds().items() if name not in held}
            held.update(late)
            if late:
                continue
            if (np.abs(moved) <= STILL * np.sqrt(np.diag(fit.solution.covariance)) + ROUNDING * np.abs(before)).all():
                break
            change = _change(problem, fit, moved)
            if change <= SETTLED:
                break
        else:
            # After the last step, a warning is due if predictions still change by more than this part
            # of the residual
            unsettled = (
                ()
                if change <= 0.02
                else (f"the fit has not settled in {POLISH} steps: start settings nearer, or leave some out",)
            )
        leg, names = self.leg, tuple(s.name for s in self.nonlinear)
        settled = with_settings(self.given.terms, leg.joint_names, leg.joint_labels, self.settings)
        rigid = self.values[: len(leg.parameter_names)]
        model = TorqueModel(leg, settled, rigid, separate=self.given.model.separate)
        values = np.array([self.settings[name] for name in names])
        units = tuple(s.unit for s in self.nonlinear)
        nonlinear = NonlinearParameters(names, units, values, np.zeros((len(names),) * 2), tuple(held))
        return Fitted(problem, fit, (model,), nonlinear, (*fit.warnings, *held.values(), *unsettled))

    def _residual(self, logs: FloatArray) -> FloatArray:
        """Residual after the best parameters, as long as there are settings, and one more."""
        settings = dict(zip(self.settings, np.exp(logs).tolist(), strict=True))
        if settings != self.settings:
            self.settings = settings
            self._settle()
        return self.corner[:, -1]

    def _slope(self, logs: FloatArray) -> FloatArray:
        """Its derivative by the logarithms of the settings."""
        self._residual(logs)
        return -self.corner[:, :-1] * np.exp(logs)

    def _settle(self) -> None:
        """Solve for the parameters at the present settings, which takes more than one pass if rows depend on them."""
        for _ in range(PASSES):
            problem = self._problem()
            problem.refuse_empty_joints()
            self.r_factors = problem.r_factors
            if self._solve() <= SETTLED:
                break

    def _solve(self) -> float:
        """Solve on the present R factors; tells how far predictions moved, as a part of the residual."""
        count, theta = len(self.values), np.array(list(self.settings.values()))
        R = stack(self.r_factors, self.weights).R
        rest = R[:, -1] - R[:, count:-1] @ theta - R[:, :count][:, ~self.free] @ self.values[~self.free]
        table = np.column_stack([R[:, :count][:, self.free], R[:, count:-1], rest])
        R, free = factorize(table, 0, 0.0).R, int(self.free.sum())
        before, self.values = self.values, self.values.copy()
        # shortest where a column says nothing: friction under a load that is not yet known
        self.values[self.free] = scaled_lstsq(R[:free, :free], R[:free, -1])
        self.corner = R[free:, free:]
        left = max(float(np.linalg.norm(self.corner[:, -1])), TINY * float(np.linalg.norm(R[:, -1])))
        moved = R[:free, :free] @ (self.values - before)[self.free]
        return float(np.linalg.norm(moved)) / left if left > 0.0 else 0.0

    def _weigh(self) -> None:
        """Weigh each joint's rows by its residual, and solve again."""
        x = np.append(self.values, list(self.settings.values()))
        sizes = [t.residual(x) / np.sqrt(max(t.rows, 1)) for t in self.r_factors]
        floor = TINY * max(float(np.linalg.norm(t.R[:, -1])) / np.sqrt(max(t.rows, 1)) for t in self.r_factors)
        self.weights = [1.0 / max(size, floor) for size in sizes]
        self._solve()

    def _refuse_unloaded(self) -> None:
        """Refuse friction that depends on a rigid-body torque where there is none."""
        model = self._problem().model
        columns = np.sqrt(sum(t.R**2 for t in self.r_factors)).max(axis=0)
        places = {name: k for k, name in enumerate(model.names)}
        known = self.knowledge.known
        loads = [name for b in model.blocks if b.term.loaded for name in b.names if name not in known]
        # Columns of friction under load below this part of the torque count as zero
        unloaded = [name for name in loads if columns[places[name]] <= 1e-6 * columns[-1]]
        if unloaded:
            raise NotIdentifiableError(
                f"{', '.join(unloaded)} left no trace in the torque: there is no rigid-body torque to depend on",
                remedy="leave out LoadFriction at these joints",
                parameters=tuple(unloaded),
            )

    def _problem(self, held: Sequence[str] = ()) -> Problem:
        terms, regrouped = self.given.terms, self.regrouped
        model = linearise(self.leg, terms, self.values, self.settings, held=held, regrouped=regrouped)
        return self.given.changed(model=model)

    def _take(self, found: dict[str, float]) -> None:
        """Go to a solution, within bounds."""
        self.values = np.array(list(found.values())[: len(self.values)])
        for shape in self.nonlinear:
            if shape.name in found:
                value, free = self.settings[shape.name], shape.free
                lower, upper = max(free.lower, value / STRIDE), min(free.upper, value * STRIDE)
                self.settings[shape.name] = float(np.clip(found[shape.name], lower, upper))

    def _at_bounds(self) -> dict[str, str]:
        """Settings that have run to a bound, where they are put, and what to say."""
        held = {}
        for shape in self.nonlinear:
            value, free = self.settings[shape.name], shape.free
            for side, bound in (("lower", free.lower), ("upper", free.upper)):
                # A setting this close to its bound, relatively, counts as at it
                if abs(np.log(value / bound)) < 0.02:
                    held[shape.name] = f"{shape.name} is at its {side} bound, {bound:g} {shape.unit}, and held there"
                    self.settings[shape.name] = bound
        return held

    def _undetermined(self, at_bounds: Mapping[str, str]) -> dict[str, str]:
        """Settings that the rows do not determine, the worst first, and what to say."""
        held: dict[str, str] = {}
        for _ in self.nonlinear:
            left = [k for k, shape in enumerate(self.nonlinear) if shape.name not in {*at_bounds, *held}]
            if not left:
                break
            spread = self._spread(left)
            worst = int(np.argmax(spread))
            if spread[worst] <= UNDETERMINED:
                break
            name = self.nonlinear[left[worst]].name
            where = f"{self.settings[name]:.3g} {self.nonlinear[left[worst]].unit}"
            held[name] = f"{name} is not determined by the recordings, and held at {where}: fix it or leave it out"
        return held

    def _spread(self, left: Sequence[int]) -> FloatArray:
        """Relative standard deviation of settings, of white noise, infinite where they leave no trace."""
        theta = np.array(list(self.settings.values()))[left]
        slope = self.corner[:, left] * theta
        norms = np.linalg.norm(slope, axis=0)
        if (norms <= 1e-12 * np.linalg.norm(self.corner[:, -1])).any():
            return np.where(norms <= 1e-12 * np.linalg.norm(self.corner[:, -1]), np.inf, 0.0)
        inverse = scaled_pinv(slope)
        samples = max(sum(t.samples for t in self.r_factors) - len(self.values), 1.0)
        rows = np.linalg.norm(self.corner[:, -1]) / np.sqrt(samples)
        return np.asarray(rows * np.linalg.norm(inverse, axis=1))


def _change(problem: Problem, fit: Fit, moved: FloatArray) -> float:
    """How far predictions move with the parameters, as a part of the residual."""
    table = stack(problem.r_factors, fit.weights).R
    values = np.append(fit.solution.values, -1.0)
    left = max(float(np.linalg.norm(table @ values)), TINY * float(np.linalg.norm(table[:, -1])))
    return float(np.linalg.norm(table[:, :-1] @ moved)) / left if left > 0.0 else 0.0
