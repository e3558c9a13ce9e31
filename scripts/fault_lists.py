"""Lists of faults: three sizes of those that are to be found, and disturbances of intervals."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from faulty_logs import (
    Log,
    angle,
    clipped,
    clipped_above,
    direction,
    dropped,
    frozen,
    gapped,
    geared,
    held,
    in_degrees,
    late,
    late_velocity,
    longer,
    low_passed,
    mixed,
    negative,
    noisier,
    only_noise,
    other_friction,
    overlapping,
    rubbing,
    scaled,
    shifted,
    slow_clock,
    spiked,
    spring,
    stale,
    strapped,
    swapped,
    talking,
    tilted,
    torque,
    twice,
    wrapped,
)


class Corruption(NamedTuple):
    """A fault in some sizes.

    Attributes:
        name: Name in the table.
        kinds: Kinds of findings that name it; none where the estimate is to be right.
        joint: Index of the joint that is to be named; None where any joint is right.
        sizes: Sizes, small to large.
        apply: Function of a clean log, the size and a generator.
    """

    name: str
    kinds: tuple[str, ...]
    joint: int | None
    sizes: tuple[float, ...]
    apply: Callable[[Log, float, np.random.Generator], Log]


CORRUPTIONS = (
    Corruption("torque late, all joints [s]", ("torque-delay",), None, (0.005, 0.02, 0.05), torque(late, None)),
    Corruption("torque late, joint 2 [s]", ("torque-delay",), 1, (0.005, 0.02, 0.05), torque(late, 1)),
    Corruption("velocity late, joint 2 [s]", ("velocity-delay",), 1, (0.01, 0.05, 0.15), late_velocity),
    Corruption("torque sign, joint 1", ("torque-sign",), 0, (1.0,), torque(negative, 0)),
    Corruption("torque sign, joint 2", ("torque-sign",), 1, (1.0,), torque(negative, 1)),
    Corruption("torque sign, all", ("torque-sign",), None, (1.0,), torque(negative, None)),
    Corruption("angle sign, joint 1", ("angle-sign", "torque-sign"), 0, (1.0,), angle(negative, 0)),
    Corruption("angle sign, joint 2", ("angle-sign",), 1, (1.0,), angle(negative, 1)),
    Corruption("joints 1 and 2 swapped (torque, angle, both)", ("joint-order",), None, (0.0, 1.0, 2.0), swapped),
    Corruption("torque scale, all", ("torque-scale",), None, (1000.0, 0.12, 0.02), torque(scaled, None)),
    Corruption("torque scale, joint 2", ("torque-scale",), None, (1.1, 1.3, 50.0), torque(scaled, 1)),
    Corruption("degrees (all, joint 1, joint 2)", ("angle-scale",), None, (-1.0, 0.0, 1.0), in_degrees),
    Corruption("angle scale, joint 2", ("angle-scale",), 1, (1.02, 1.05, 1.2), angle(scaled, 1)),
    Corruption("angle zero, joint 2 [deg]", ("angle-offset",), 1, (2.0, 5.0, 15.0), angle(shifted, 1)),
    Corruption("base tilted [deg]", ("gravity-direction",), None, (1.0, 5.0, 15.0), tilted),
    Corruption("segment 1 longer", ("segment-length",), 0, (0.03, 0.05, 0.1), longer),
    Corruption("torque clipped, joint 2", ("saturation",), 1, (0.9, 0.75, 0.6), torque(clipped, 1)),
    Corruption("torque clipped on one side, joint 2", ("saturation",), 1, (0.9, 0.75, 0.6), torque(clipped_above, 1)),
    Corruption("torque frozen, joint 2 [s]", ("stuck-channel",), 1, (0.5, 2.0, 10.0), torque(frozen, 1)),
    Corruption("angle frozen, joint 2 [s]", ("stuck-channel",), 1, (1.0, 5.0, 17.0), angle(frozen, 1)),
    Corruption("samples missing [s]", ("missing-samples",), None, (0.02, 0.05, 0.1), gapped),
    Corruption("torque drops to zero, joint 2", ("dropout",), 1, (0.01, 0.02, 0.05), torque(dropped, 1)),
    Corruption("torque repeats values, joint 2", ("stale-samples",), 1, (2.0, 5.0, 10.0), torque(held, 1)),
    Corruption("one-sided spikes, joint 2", ("spikes",), 1, (0.005, 0.01, 0.03), torque(spiked, 1)),
    Corruption("strap [N/m]", ("unmodelled-force",), None, (50.0, 100.0, 200.0), strapped),
    Corruption("spring at joint 2", ("unmodelled-force",), 1, (0.2, 0.5, 1.0), spring),
    Corruption("cross-talk into joint 2", ("cross-talk",), 1, (0.02, 0.05, 0.1), mixed),
    Corruption("friction (Stribeck, square, load)", ("unmodelled-friction",), 1, (0.0, 1.0, 2.0), other_friction),
    Corruption("data twice", ("repeated-data",), None, (1.0, 0.5, 0.2), twice),
    Corruption("torque is noise, joint 2", ("large-residual",), 1, (1.0,), torque(only_noise, 1)),
)

FRICTION = ("unmodelled-friction",)

DISTURBANCES = (
    Corruption("none", (), None, (0.0,), lambda log, *_: log),
    Corruption("torque drops to zero", ("dropout",), None, (0.01, 0.05), torque(dropped, None)),
    Corruption("stale torque samples", ("stale-samples",), None, (0.05, 0.2), torque(stale, None)),
    Corruption("torque saturated", ("saturation",), None, (0.95, 0.75), torque(clipped, None)),
    Corruption("one-sided spikes", ("spikes",), None, (0.005, 0.02), torque(spiked, None)),
    Corruption("angle zero, joint 1 [deg]", ("gravity-direction", "angle-offset"), None, (1.0, 5.0), angle(shifted, 0)),
    Corruption("angle zero, joint 2 [deg]", ("angle-offset",), 1, (1.0, 5.0), angle(shifted, 1)),
    Corruption("torque late [s]", ("torque-delay",), None, (0.005, 0.02), torque(late, None)),
    Corruption("torque low-passed [s]", ("torque-delay",), None, (0.005, 0.02), torque(low_passed, None)),
    Corruption("torque held [samples]", ("stale-samples",), None, (2.0, 5.0), torque(held, None)),
    Corruption("velocity late, joint 2 [s]", ("velocity-delay",), 1, (0.01, 0.05), late_velocity),
    Corruption("tilt [deg]", ("gravity-direction", "angle-offset"), None, (1.0, 5.0), tilted),
    Corruption("cross-talk", ("cross-talk",), None, (0.01, 0.03), talking),
    Corruption("friction under load", FRICTION, None, (0.02, 0.05), rubbing(lambda v, t: direction(v) * np.abs(t))),
    Corruption(
        "asymmetric friction", FRICTION, None, (0.02, 0.05), rubbing(lambda v, t: np.abs(v) / np.std(v, axis=0))
    ),
    Corruption(
        "quadratic friction", FRICTION, None, (0.02, 0.05), rubbing(lambda v, t: v * np.abs(v) / np.var(v, axis=0))
    ),
    Corruption(
        "Stribeck friction",
        FRICTION,
        None,
        (0.02, 0.05),
        rubbing(lambda v, t: direction(v) * np.exp(-((v / 0.2) ** 2))),
    ),
    Corruption(
        "noise that grows with speed", (), None, (0.02, 0.05), noisier(lambda v, t: np.abs(v) / np.std(v, axis=0))
    ),
    Corruption("noise that grows with torque", (), None, (0.02, 0.05), noisier(lambda v, t: np.abs(t))),
    Corruption("log twice", ("repeated-data",), None, (1.0,), twice),
    Corruption("parts that overlap", ("repeated-data",), None, (0.2, 0.5), overlapping),
    Corruption("slow clock", ("clock", "segment-length"), None, (0.01, 0.05), slow_clock),
    Corruption("angle wraps, joint 2 [rad]", ("angle-wrap",), 1, (-0.8,), wrapped),
    Corruption("torque in mN·m", ("torque-scale",), None, (1000.0,), torque(scaled, None)),
    Corruption("torque is noise", ("large-residual",), None, (1.0,), torque(only_noise, None)),
    Corruption("strap [N/m]", ("unmodelled-force",), None, (20.0, 50.0), strapped),
    Corruption("play, joint 2 [rad]", ("play",), 1, (0.001, 0.003), geared(lambda x, way: way * np.tanh(x / 0.03))),
    Corruption(
        "elastic joint 2, RMS twist [rad]", ("elastic-joint",), 1, (0.005, 0.02), geared(lambda x, twist: twist * x)
    ),
)
