"""Closed loop of a sampled controller and the virtual rig: continuous plant with stiction, inexact sensors."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from math import gcd
from typing import TYPE_CHECKING, TypedDict

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError
from exoid.experiments.limits import refuse_motion_beyond_limits
from exoid.rig import (
    Actuator,
    IdealTorque,
    Plant,
    Rates,
    Reference,
    Sensors,
    Target,
    Wearer,
)
from exoid.rig import simulate as simulate_rig
from exoid.tools.numbers import checked

from .law import RATE, AnyLaw, Memory, State, name_of, stateful
from .tracking import Tracking, tracking_of

if TYPE_CHECKING:
    from typing_extensions import Unpack


class SimulationOptions(TypedDict, total=False):
    """Options of a run, of one rig or of many; see :func:`simulate_many`."""

    sensors: Sensors | None
    actuator: Actuator | None
    settle: float
    log_rate: float | None
    seed: int | np.random.Generator
    wearer: Wearer | None
    progress: Callable[[float], None] | None


def simulate_law(
    plant: Plant,
    law: AnyLaw,
    reference: Reference,
    duration: float,
    *,
    start: ArrayLike | None = None,
    name: str | None = None,
    **options: Unpack[SimulationOptions],
) -> Tracking:
    """Simulate one rig that follows a reference under a controller.

    Args:
        plant: The true leg, one rig.
        law: Controller with or without memory, sampled at its rate; its torque is held in between.
        reference: Reference to follow.
        duration: Duration [s].
        start: Initial angles, at rest [rad], (n,); None to begin on the reference, with its velocity.
        name: Name of the controller in tables; None for its class.
        **options: ``sensors``, ``actuator``, ``settle``, ``log_rate``, ``seed``, ``wearer`` and ``progress`` of
            :func:`simulate_many`.

    Returns:
        Motion, torque and log, with their metrics.

    Raises:
        ExoidError: The plant has several rigs, the reference leaves the limits of a plant with end stops, rates do
            not fit, the wearer does not fit, or the run diverges.
    """
    if plant.count != 1:
        raise BadArgumentError(f"a plant of {plant.count} rigs", remedy="use simulate_many, or plant.take([k])")
    beginning = None if start is None else np.asarray(start, dtype=np.float64).reshape(-1, 1)
    names = None if name is None else (name,)
    return simulate_many(plant, law, reference, duration, start=beginning, names=names, **options)[0]


def simulate_many(
    plant: Plant,
    law: AnyLaw,
    reference: Reference,
    duration: float,
    *,
    sensors: Sensors | None = None,
    actuator: Actuator | None = None,
    start: ArrayLike | None = None,
    settle: float = 0.0,
    log_rate: float | None = None,
    seed: int | np.random.Generator = 0,
    names: tuple[str, ...] | None = None,
    wearer: Wearer | None = None,
    progress: Callable[[float], None] | None = None,
) -> tuple[Tracking, ...]:
    """Simulate B rigs at once; arguments as for :func:`simulate_law`.

    Args:
        plant: The true legs, B rigs.
        law: Controller of all rigs; :class:`SideBySide` for one controller for each.
        reference: Reference of B rigs, or of one, which all follow.
        duration: Duration [s].
        sensors: Noise, quantisation and delay (in sampling periods) of the controller's readings; None for exact ones.
        actuator: Actuator between commanded and joint torque; None for an ideal one.
        start: Initial angles, at rest [rad], (n, B) or (n, 1).
        settle: Time at the beginning that the metrics leave out [s].
        log_rate: Rate of the log [Hz]; None for 100, or the controller's rate if that is higher.
        seed: Seed of the sensor noise.
        names: Names of the controllers, one for each rig.
        wearer: Wearer of each leg; None for nobody. The controller receives the torque of the wearer as
            ``state.interaction``.
        progress: Function that receives the completed share, 0 to 1.

    Returns:
        One result for each rig.

    Raises:
        ExoidError: See :func:`simulate_law`; or the number of names is not that of the rigs.
    """
    if names is not None and len(names) != plant.count:
        raise BadArgumentError(f"{len(names)} names for {plant.count} rigs", remedy="give one name for each rig")
    if not 0.0 <= settle < duration:
        raise BadArgumentError(
            f"{settle:g} s to settle in a run of {duration:g} s", remedy="run longer than it settles"
        )
    most = 10**7  # samples: a day at 100 Hz
    if duration * max(law.rate, RATE) > most:
        raise BadArgumentError(
            f"a run of {duration:g} s is longer than {most:.0e} samples", remedy="simulate a shorter one"
        )
    if np.isfinite(plant.lower).any() or np.isfinite(plant.upper).any():
        refuse_motion_beyond_limits(plant.leg, reference, duration)
    log = max(RATE, law.rate) if log_rate is None else log_rate
    run = simulate_rig(
        plant,
        reference,
        _Sampled(law),
        actuator or IdealTorque(),
        duration,
        start=start,
        sensors=sensors,
        rates=Rates(law.rate, log, plant_step(law.rate, log)),
        seed=seed,
        wearer=wearer,
        progress=progress,
    )
    labels = names or (name_of(law),) * plant.count
    return tuple(tracking_of(run, k, label, law.rate, settle) for k, label in enumerate(labels))


def plant_step(control: float, log: float) -> float:
    """Find the longest step of the plant, at most 0.5 ms, that divides the periods of controller and log."""
    checked([control, log], "rates [Hz]", above=0.0)
    periods = [1 / Fraction(rate).limit_denominator(1000) for rate in (control, log)]
    scale = periods[0].denominator * periods[1].denominator // gcd(periods[0].denominator, periods[1].denominator)
    common = Fraction(gcd(*(int(period * scale) for period in periods)), scale)
    step = float(common / -(-common // Fraction(1, 2000)))
    shortest = 2e-5  # [s]; shorter ones would take minutes
    if step < shortest:
        raise BadArgumentError(
            f"rates of {control:g} and {log:g} Hz have no common step above {shortest:g} s",
            remedy="choose a log rate that is a multiple of the controller's",
        )
    return step


class _Sampled:
    """A controller as the rig calls it: keeps its memory, the time and the last torque, for this run only."""

    def __init__(self, law: AnyLaw) -> None:
        self._law, self._count = stateful(law), 0
        self._last: FloatArray | None = None
        self._memory: Memory = None

    def command(self, target: Target, q: FloatArray, v: FloatArray) -> FloatArray:
        """Compute the torque without a wearer."""
        return self.command_worn(target, q, v, None)

    def command_worn(self, target: Target, q: FloatArray, v: FloatArray, interaction: FloatArray | None) -> FloatArray:
        """Compute the torque, given that of the wearer."""
        single = q.shape[1] == 1
        if single:  # vectors are quicker than columns
            q, v = q[:, 0], v[:, 0]
            interaction = None if interaction is None else interaction[:, 0]
            target = Target(*(None if x is None else x[:, 0] for x in target))  # type: ignore[arg-type]
        state = State(q, v, self._count / self._law.rate, self._last, interaction)
        if self._count == 0:
            self._memory = self._law.begin(state)
        torque, self._memory = self._law.step(self._memory, state, target)
        self._count += 1
        self._last = torque
        return torque[:, None] if single else torque
