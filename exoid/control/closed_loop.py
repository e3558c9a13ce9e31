"""Closed loop of sampled controllers and the virtual rig: continuous plant with stiction, inexact sensors."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from math import lcm
from typing import TYPE_CHECKING, TypedDict

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError
from exoid.experiments.limits import refuse_motion_beyond_limits
from exoid.rig import IdealTorque, Plant, Rates, Reference, Sensors, Target, Wearer
from exoid.rig import simulate as simulate_rig
from exoid.tools.numbers import checked

from .law import RATE, AnyLaw, RunningLaw, name_of
from .tracking import Tracking, tracking_of

if TYPE_CHECKING:
    from typing_extensions import Unpack


class SimulationOptions(TypedDict, total=False):
    """Options of a run, of one rig or of many; see :func:`simulate_many`."""

    sensors: Sensors | None
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
    **options: Unpack[SimulationOptions],
) -> Tracking:
    """Simulate one rig that follows a reference under a controller.

    Args:
        plant: The true leg, one rig.
        law: Controller with or without memory, sampled at its rate; its torque is held in between.
        reference: Reference to follow.
        duration: Duration [s].
        start: Initial angles, at rest [rad], (n,); None to begin on the reference, with its velocity.
        **options: ``sensors``, ``settle``, ``log_rate``, ``seed``, ``wearer`` and ``progress`` of
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
    return simulate_many(plant, law, reference, duration, start=beginning, **options)[0]


def simulate_many(
    plant: Plant,
    law: AnyLaw | Sequence[AnyLaw],
    reference: Reference,
    duration: float,
    *,
    sensors: Sensors | None = None,
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
        law: Controller of all rigs; or one for each, all of the same rate.
        reference: Reference of B rigs, or of one, which all follow.
        duration: Duration [s].
        sensors: Noise, quantisation and delay (in sampling periods) of the controller's readings; None for exact ones.
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
        ExoidError: See :func:`simulate_law`; or the number of names or controllers is not that of the rigs, or their
            rates differ.
    """
    laws: list[AnyLaw] = list(law) if isinstance(law, Sequence) else [law] * plant.count
    rates = sorted({each.rate for each in laws})
    if len(laws) != plant.count or len(rates) != 1:
        what = f"{len(laws)} controllers of {rates} Hz for {plant.count} rigs"
        raise BadArgumentError(what, remedy="give one for each rig, all of one rate")
    rate = rates[0]
    if names is not None and len(names) != plant.count:
        raise BadArgumentError(f"{len(names)} names for {plant.count} rigs", remedy="give one name for each rig")
    if not 0.0 <= settle < duration:
        what = f"{settle:g} s to settle in a run of {duration:g} s"
        raise BadArgumentError(what, remedy="run longer than it settles")
    checked(duration * max(rate, RATE), "the number of samples of the run", most=1e7)  # a day at 100 Hz
    if np.isfinite(plant.lower).any() or np.isfinite(plant.upper).any():
        refuse_motion_beyond_limits(plant.leg, reference, duration)
    log = max(RATE, rate) if log_rate is None else log_rate
    run = simulate_rig(
        plant,
        reference,
        _Sampled(laws if isinstance(law, Sequence) else [law]),
        IdealTorque(),
        duration,
        start=start,
        sensors=sensors,
        rates=Rates(rate, log, plant_step(rate, log)),
        seed=seed,
        wearer=wearer,
        progress=progress,
    )
    return tuple(tracking_of(run, k, label, rate, settle) for k, label in enumerate(names or map(name_of, laws)))


def compare_laws(
    plant: Plant | Mapping[str, Plant],
    laws: Mapping[str, AnyLaw],
    reference: Reference,
    duration: float,
    *,
    start: ArrayLike | None = None,
    **options: Unpack[SimulationOptions],
) -> dict[str, Tracking]:
    """Run several controllers; those of the same rate run in one simulation if the leg is planar.

    Args:
        plant: The true leg, one rig; or that of each controller by its name, all of the same leg.
        laws: Controllers by name, with or without memory.
        reference: Reference of one leg, which all follow.
        duration: Duration [s].
        start: Initial angles of all, at rest [rad], (n,); None to begin on the reference, with its velocity.
        **options: Those of :func:`exoid.control.simulate_law`; noise differs from controller to controller.

    Returns:
        Result of each controller by name, in the order of ``laws``.

    Raises:
        ExoidError: There are no controllers, one has no plant, or a run is refused or diverges.
    """
    plants = dict.fromkeys(laws, plant) if isinstance(plant, Plant) else plant
    missing = [name for name in laws if name not in plants]
    if missing or not laws:
        what = f"no plant for {', '.join(missing)}" if missing else "no controllers"
        raise BadArgumentError(what, remedy="give each controller a plant")
    progress, beginning = options.get("progress"), None if start is None else np.reshape(start, (-1, 1))
    groups: dict[float | str, list[str]] = {}
    for name, law in laws.items():  # legs that are not planar are simulated one by one
        groups.setdefault(name if plants[name].leg.chain is None else law.rate, []).append(name)
    found: dict[str, Tracking] = {}
    for names in groups.values():
        done, share = len(found) / len(laws), len(names) / len(laws)
        part = None if progress is None else lambda x, done=done, share=share: progress(done + share * x)
        options["progress"] = part
        runs = simulate_many(
            Plant.concatenate([plants[name] for name in names]),
            [laws[name] for name in names],
            reference,
            duration,
            start=beginning,
            names=tuple(names),
            **options,
        )
        found |= dict(zip(names, runs, strict=True))
    return {name: found[name] for name in laws}


def plant_step(control: float, log: float) -> float:
    """Find the longest step of the plant, at most 0.5 ms, that divides the periods of controller and log."""
    checked([control, log], "rates [Hz]", above=0.0)
    a, b = (Fraction(rate).limit_denominator(1000) for rate in (control, log))
    common = Fraction(lcm(a.numerator * b.denominator, b.numerator * a.denominator), a.denominator * b.denominator)
    step = float(1 / (common * -(-2000 // common)))
    shortest = 2e-5  # [s]; shorter ones would take minutes
    if step < shortest:
        what = f"rates of {control:g} and {log:g} Hz have no common step above {shortest:g} s"
        raise BadArgumentError(what, remedy="choose a log rate that is a multiple of the controller's")
    return step


class _Sampled:
    """Controllers as the rig calls them: one for all rigs at once, or controller k for rig k."""

    def __init__(self, laws: Sequence[AnyLaw]) -> None:
        self._runs = [RunningLaw(law) for law in laws]

    def command(
        self, target: Target, q: FloatArray, v: FloatArray, interaction: FloatArray | None = None
    ) -> FloatArray:
        """Compute the torques, given those of the wearers if there are any."""
        if len(self._runs) < q.shape[1]:
            return self._runs[0].command(q, v, target, interaction)
        aims = [None if x is None else np.broadcast_to(x, q.shape) for x in target]
        torques = []
        for k, run in enumerate(self._runs):  # vectors are quicker than columns
            aim = Target(*(None if x is None else x[:, k] for x in aims))  # type: ignore[arg-type]
            felt = None if interaction is None else interaction[:, k]
            torques.append(run.command(q[:, k], v[:, k], aim, felt))
        return np.column_stack(torques)
