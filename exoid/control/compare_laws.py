"""Several laws on the same leg, on the same reference, with the same sensors."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from exoid.errors import ExoidError
from exoid.rig import Plant, Reference, Sensors

from .closed_loop import simulate_many
from .law import Law
from .side_by_side import SideBySide
from .tracking import Tracking


def compare_laws(
    plant: Plant | Mapping[str, Plant],
    laws: Mapping[str, Law],
    reference: Reference,
    duration: float,
    *,
    sensors: Sensors | None = None,
    settle: float = 0.0,
    seed: int = 0,
    progress: Callable[[float], None] | None = None,
) -> dict[str, Tracking]:
    """Run laws by name; those of the same rate run side by side.

    Args:
        plant: The truth, of one rig; or that of each law by its name, all of the same leg.
        laws: The laws by name.
        reference: What all follow, of one leg.
        duration: [s].
        sensors: See :func:`exoid.control.simulate`; readings of different laws have different noise.
        settle: What the metrics leave out at the beginning [s].
        seed: Of the sensor noise.
        progress: Told the share that is done.

    Returns:
        What each law did, in the order of ``laws``.

    Raises:
        ExoidError: There are no laws, a law has no plant, or a run is refused or diverges.
    """
    plants = dict.fromkeys(laws, plant) if isinstance(plant, Plant) else plant
    missing = [name for name in laws if name not in plants]
    if missing or not laws:
        raise ExoidError(f"no plant for {', '.join(missing)}" if missing else "no laws", remedy="give each law a plant")
    groups: dict[float, list[str]] = {}
    for name, law in laws.items():
        groups.setdefault(law.rate, []).append(name)
    found: dict[str, Tracking] = {}
    for names in groups.values():
        done, share = len(found) / len(laws), len(names) / len(laws)
        tell = None if progress is None else _part(progress, done, share)
        runs = simulate_many(
            Plant.concatenate([plants[name] for name in names]),
            SideBySide(tuple(laws[name] for name in names)),
            reference,
            duration,
            sensors=sensors,
            settle=settle,
            seed=seed,
            names=tuple(names),
            progress=tell,
        )
        found |= dict(zip(names, runs, strict=True))
    return {name: found[name] for name in laws}


def _part(progress: Callable[[float], None], done: float, share: float) -> Callable[[float], None]:
    return lambda part: progress(done + share * part)
