"""Several controllers on the same leg and reference, in one run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError
from exoid.rig import Plant, Reference, Target

from .closed_loop import SimulationOptions, simulate_many
from .law import AnyLaw, Memory, State, StatefulLaw, stateful
from .tracking import Tracking

if TYPE_CHECKING:
    from typing_extensions import Unpack


@dataclass(frozen=True)
class SideBySide(StatefulLaw):
    """Controller k for rig k: to compare controllers, or controllers with different estimates.

    Attributes:
        laws: Controllers with or without memory, one for each rig, all of the same rate.

    Raises:
        ExoidError: There are no controllers, or their rates differ.
    """

    laws: tuple[AnyLaw, ...]

    def __post_init__(self) -> None:
        """Check the rates."""
        if len({law.rate for law in self.laws}) != 1:
            raise BadArgumentError(
                f"controllers of rates {sorted({law.rate for law in self.laws})} Hz side by side",
                remedy="give controllers of one rate, and run others separately",
            )

    @property
    def rate(self) -> float:
        """Sampling rate of all controllers [Hz]."""
        return self.laws[0].rate

    def begin(self, state: State) -> tuple[Memory, ...]:
        """Compute the memory of each controller before the first sample."""
        return tuple(law.begin(one) for law, one in zip(self._stateful, self._states(state), strict=True))

    def step(self, memory: tuple[Memory, ...], state: State, target: Target) -> tuple[FloatArray, tuple[Memory, ...]]:
        """Compute the torque of each controller for its rig, and the memories."""
        inputs = self._inputs(state, target)
        steps = [law.step(own, *one) for law, own, one in zip(self._stateful, memory, inputs, strict=True)]
        return np.array([torque for torque, _ in steps]).T.reshape(state.q.shape), tuple(own for _, own in steps)

    @cached_property
    def _stateful(self) -> tuple[StatefulLaw, ...]:
        """All controllers with memory."""
        return tuple(stateful(law) for law in self.laws)

    def _states(self, state: State) -> list[State]:
        """State of each rig."""
        q, v = np.atleast_2d(state.q.T), np.atleast_2d(state.v.T)
        if len(q) != len(self.laws):
            raise BadArgumentError(f"{len(self.laws)} controllers for {len(q)} rigs", remedy="give one for each rig")
        rest = [len(q) * [None] if x is None else np.atleast_2d(x.T) for x in (state.last, state.interaction)]
        return [State(q[k], v[k], state.time, *(x[k] for x in rest)) for k in range(len(q))]

    def _inputs(self, state: State, target: Target) -> list[tuple[State, Target]]:
        """State and target of each rig."""
        states, shape = self._states(state), np.atleast_2d(state.q.T).shape
        aims = [None if x is None else np.broadcast_to(x.reshape(len(x), -1), shape[::-1]).T for x in target]
        return [
            (one, Target(*(None if x is None else x[k] for x in aims)))  # type: ignore[arg-type]
            for k, one in enumerate(states)
        ]


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
        raise BadArgumentError(
            f"no plant for {', '.join(missing)}" if missing else "no controllers", remedy="give each controller a plant"
        )
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
            SideBySide(tuple(laws[name] for name in names)),
            reference,
            duration,
            start=beginning,
            names=tuple(names),
            **options,
        )
        found |= dict(zip(names, runs, strict=True))
    return {name: found[name] for name in laws}
