"""Several controllers on the same leg and reference, with the same sensors."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from exoid.errors import BadArgumentError
from exoid.rig import Plant, Reference, Sensors

from .closed_loop import simulate_many
from .side_by_side import SideBySide
from .stateful import AnyLaw
from .tracking import Tracking


def compare_laws(
    plant: Plant | Mapping[str, Plant],
    laws: Mapping[str, AnyLaw],
    reference: Reference,
    duration: float,
    *,
    sensors: Sensors | None = None,
    settle: float = 0.0,
    seed: int = 0,
    progress: Callable[[float], None] | None = None,
) -> dict[str, Tracking]:
    """Run several controllers; those of the same rate run in one simulation.

    Args:
        plant: The true leg, one rig; or that of each controller by its name, all of the same leg.
        laws: Controllers by name, with or without memory.
        reference: Reference of one leg, which all follow.
        duration: Duration [s].
        sensors: See :func:`exoid.control.simulate`; the noise differs from controller to controller.
        settle: Time at the beginning that the metrics leave out [s].
        seed: Seed of the sensor noise.
        progress: Function that receives the completed share, 0 to 1.

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
    groups: dict[float, list[str]] = {}
    for name, law in laws.items():
        groups.setdefault(law.rate, []).append(name)
    found: dict[str, Tracking] = {}
    for names in groups.values():
        done, share = len(found) / len(laws), len(names) / len(laws)
        part = None if progress is None else _part(progress, done, share)
        runs = simulate_many(
            Plant.concatenate([plants[name] for name in names]),
            SideBySide(tuple(laws[name] for name in names)),
            reference,
            duration,
            sensors=sensors,
            settle=settle,
            seed=seed,
            names=tuple(names),
            progress=part,
        )
        found |= dict(zip(names, runs, strict=True))
    return {name: found[name] for name in laws}


def _part(progress: Callable[[float], None], done: float, share: float) -> Callable[[float], None]:
    return lambda part: progress(done + share * part)
