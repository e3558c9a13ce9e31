"""Faults of a log that are planted, one at a time: each has the one finding of its kind, with its joint and size."""

import dataclasses
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pytest
from logs import clean, of_kind, with_column
from swings import Swing, late

import exoid
from exoid.signals import zero_phase


class Fault(NamedTuple):
    """A way to spoil a log, and the finding: its kind, joint, value, words of the message, and leg."""

    spoil: Callable[[exoid.Recording], exoid.Recording | list[exoid.Recording]]
    kind: str
    joint: int | None = None
    value: Any = None
    words: str = ""
    leg: str = "bleex"


def column(quantity, joint, change):
    """Spoil one column."""
    return lambda log: with_column(dataclasses.replace(log, largest_angle=np.inf), quantity, joint, change)


def frozen(start, count):
    """Repeat one sample."""
    return lambda x: np.where((np.arange(len(x)) >= start) & (np.arange(len(x)) < start + count), x[start], x)


def turned(degrees):
    return lambda x: x + np.deg2rad(degrees)


def columns(**order):
    """Put columns of quantities into another order."""
    return lambda log: dataclasses.replace(log, **{name: getattr(log, name)[:, k] for name, k in order.items()})


def scaled(factor):
    return lambda log: dataclasses.replace(log, tau=factor * log.tau)


def without_samples(log, count=4):
    """Leave out samples of fast motion behind new stamps."""
    fast = int(np.argmax(np.abs(np.gradient(log.q, axis=0)).sum(axis=1)[500:2000])) + 500
    keep = np.delete(np.arange(len(log)), np.s_[fast : fast + count])
    return dataclasses.replace(log, time=log.time[: len(keep)], q=log.q[keep], tau=log.tau[keep])


def noisy(log, part):
    noise = np.random.default_rng(0).standard_normal(log.tau.shape)
    return dataclasses.replace(log, tau=log.tau + part * log.tau.std(axis=0) * noise)


def jittered(log):
    late = 0.002 * np.random.default_rng(0).standard_normal(len(log))
    return dataclasses.replace(log, time=np.maximum.accumulate(log.time + late) + 1e-6 * np.arange(len(log)))


def late_velocity(log):
    v = np.gradient(log.q, axis=0) * log.sample_rate
    v[:, 1] = np.interp(log.time - 0.05, log.time, v[:, 1])
    return dataclasses.replace(log, v=v)


def behind(lag):
    """Let the knee's link follow its motor, which has the encoder and the friction, by an angle of its torque."""

    def spoil(log):
        leg, _ = clean()
        swing = Swing(leg, seconds=30.0, seed=1, smoothing=0.015)
        twist = lag(leg.inverse_dynamics(*swing.motion)[:, 1])
        of_link, of_motor = (swing.coulomb[1] * np.tanh(v / 0.015) + swing.viscous[1] * v for v in speeds(swing, twist))
        turned = with_column(log, "q", 1, lambda x: x + twist)
        return with_column(turned, "tau", 1, lambda x: x + of_motor - of_link)

    return spoil


def speeds(swing, twist):
    """Velocities of the knee's link and of its motor."""
    v = swing.motion[1][:, 1]
    return v, v + np.gradient(twist) * swing.rate


def about(value, size):
    return pytest.approx(value, abs=size)


SWAP, T, BEYOND = [1, 0, 2], np.arange(3000), column("tau", 1, lambda x: x + 7.0 * (x - np.clip(x, -8.0, 8.0)))
FEW, FEWER = (np.random.default_rng(1).random(3000) < share for share in (0.02, 0.01))
FAULTS = {
    "frozen torque": Fault(column("tau", 1, frozen(1000, 300)), "stuck-channel", 1, about(3.0, 0.03), "12.137 s"),
    "frozen angle": Fault(column("q", 1, frozen(620, 200)), "stuck-channel", 1, None, "angle"),
    "samples missing": Fault(without_samples, "missing-samples", None, about(0.04, 0.004)),
    "two runs joined": Fault(lambda log: without_samples(log, 100), "missing-samples", None, None, "at once"),
    "dropouts": Fault(column("tau", 0, lambda x: np.where(FEW, 0.0, x)), "dropout", 0, about(FEW.mean(), 0.005)),
    "a slower bus": Fault(column("tau", 2, lambda x: x[T // 4 * 4]), "stale-samples", 2, about(0.75, 0.01)),
    "spikes": Fault(column("tau", 0, lambda x: x + FEWER * 3.0 * x.std()), "spikes", 0, None, "one side"),
    "spikes to both sides": Fault(column("tau", 0, lambda x: x * (1.0 - 9.0 * FEWER)), "spikes", 0, None, "% of"),
    "one angle late": Fault(column("q", 1, lambda x: np.interp(T - 1.5, T, x)), "angle-delay", 1, about(0.015, 0.002)),
    "a smoothed torque": Fault(column("tau", 1, lambda x: zero_phase(x, 100.0, 2.5)), "smoothed-torque", 1),
    "a motor that saturates": Fault(column("tau", 1, lambda x: x - 5e-4 * x**3), "torque-curve", 1),
    "commands beyond a limit that the first log does not reach": Fault(
        lambda log: [BEYOND(log).slice(28, 243), BEYOND(log).slice(243, 900)],
        *("saturation", 1, about(0.875, 0.02), "beyond about 7.81 N·m, 34% of the samples"),
    ),
    "two scales": Fault(column("tau", 1, lambda x: x + 0.03 * np.abs(x)), "torque-curve", 1, about(0.03, 0.005)),
    "a zero that drifts": Fault(column("tau", 1, lambda x: x + 1e-3 * T), "change", 1, about(0.1, 0.005), "zero"),
    "late velocity": Fault(late_velocity, "velocity-delay", 1, about(0.05, 0.005)),
    "a turn more": Fault(column("q", 1, lambda x: x + 2.0 * np.pi * (np.arange(len(x)) > 1500)), "angle-wrap", 1),
    **{
        f"{name}, torques {delay} s late": Fault(
            lambda log, s=delay: late(log, s, range(log.q.shape[1])),
            *("torque-delay", None, about(delay, 0.001), "", name),
        )
        for name, delay in (("bleex", 0.005), ("bleex", 0.05), ("cuhk", 0.02))
    },
    "one torque late": Fault(lambda log: late(log, 0.01, [1]), "torque-delay", 1, about(0.01, 0.001)),
    **{f"sign of torque {j}": Fault(column("tau", j, np.negative), "torque-sign", j, -1.0) for j in range(3)},
    "sign of all torques": Fault(scaled(-1.0), "torque-sign"),
    **{f"sign of angle {j}": Fault(column("q", j, np.negative), "angle-sign", j) for j in (1, 2)},
    **{
        f"{' and '.join(which)} swapped": Fault(columns(**dict.fromkeys(which, SWAP)), "joint-order", -1)
        for which in (("tau",), ("q",), ("tau", "q"))
    },
    "N·mm": Fault(scaled(1000.0), "torque-scale", None, about(1000.0, 100.0), "N·mm"),
    "another unit": Fault(scaled(0.05), "torque-scale", None, about(0.05, 0.005)),
    **{
        f"a torque {k} times as large": Fault(
            column("tau", j, lambda x, k=k: k * x), "torque-scale", j, about(k, 0.03), "", name
        )
        for k, j, name in ((1.2, 1, "bleex"), (0.5, 2, "bleex"), (3.0, 1, "bleex"), (0.5, 1, "cuhk"))
    },
    "degrees": Fault(column("q", 1, np.rad2deg), "angle-scale", 1, about(57.3, 0.1)),
    "scale of one angle": Fault(column("q", 1, lambda x: 1.1 * x), "angle-scale", 1, about(1.1, 0.02)),
    "zero 5° off": Fault(column("q", 1, turned(5)), "angle-offset", 1, about(5.0 / 57.3, 5.0 / 164.0)),
    "zero of the last joint": Fault(  # beside another fault
        lambda log: late(column("q", 1, lambda x: x + 0.3)(log), 0.02, [0, 1]),
        *("angle-offset", 1, about(0.3, 0.03), "", "cuhk"),
    ),
    "zero that noise hides": Fault(
        lambda log: noisy(column("q", 1, turned(5))(log), 0.1), "angle-offset", 1, about(0.09, 0.005), "the log alone"
    ),
    "base tilted by 15°": Fault(column("q", 0, turned(-15)), "gravity-direction", None, about(0.262, 0.091)),
    "cross-talk": Fault(
        lambda log: with_column(log, "tau", 1, lambda x: x + 0.05 * log.tau[:, 0]), "cross-talk", 1, about(0.05, 0.01)
    ),
    **{
        f"an angle off {k} times a turn": Fault(
            column("q", 1, lambda x, k=k, a=a: x + a * np.sin(k * x + k)), "angle-ripple", 1, about(a, 0.2 * a)
        )
        for k, a in ((4, 0.01), (8, 0.005), (50, 0.0008))
    },
    "a push": Fault(
        column("tau", 1, lambda x: x + 2.0 * x.std() * np.exp(-(((np.arange(len(x)) - 1500) / 50.0) ** 2))),
        *("large-residual", 1, None, "over half of that around 17.1"),
    ),
    "stamps of arrival": Fault(jittered, "stamp-jitter", None, about(0.002, 2e-4)),
    "play in a gear": Fault(behind(lambda load: 0.001 * np.tanh(load / 0.1)), "play", 1, about(0.00125, 0.0003)),
    "an elastic joint": Fault(behind(lambda load: load / 300.0), "elastic-joint", 1, about(300.0, 30.0)),
    "a slow clock": Fault(
        lambda log: dataclasses.replace(log, time=0.98 * log.time), "clock", None, about(-0.02, 0.004)
    ),
}

VARIANTS = ("sign of torque 1", "sign of torque 2", "tau and q swapped", "q swapped")


@pytest.mark.parametrize("fault", [pytest.param(f, marks=[pytest.mark.slow] * f.startswith(VARIANTS)) for f in FAULTS])
def test_a_fault_has_the_finding_of_its_kind_with_joint_and_size(fault):
    spoil, kind, joint, value, words, name = FAULTS[fault]
    leg, log = clean(name)
    finding = of_kind(exoid.check(leg, spoil(log)), kind)
    assert finding.joint == {None: "", -1: ", ".join(leg.joint_names[:2])}.get(joint, leg.joint_names[joint or 0])
    assert value is None or finding.value == value
    assert words in finding.message
    if finding.interval is not None:
        low, high = finding.interval
        assert 0.0 < high - low < 0.3 * abs(finding.value)
