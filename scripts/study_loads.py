"""Loads strapped on and sensors that fail, on machines that are not in the package; and quiet minutes.

    python scripts/study_loads.py load                    # 1 to 3 kg on the shank behind 40 s of motion
    python scripts/study_loads.py learning                # the same behind 12 to 20 s, while the estimate still learns
    python scripts/study_loads.py torque-scale            # a torque grows or shrinks by a fifth behind 40 s of motion
    python scripts/study_loads.py angle-offset            # the zero of an angle jumps by 1 to 3 degrees
    python scripts/study_loads.py torque-delay            # one torque, or all by turns, come 10 to 50 ms later
    python scripts/study_loads.py quiet --minutes 2       # motion of so many minutes for each machine, without a load

Machines are drawn by seed: a leg of three joints, one of two, and one with abduction. Their motion is a sum of three
harmonics; their torques are Pinocchio's, with friction, noise, and encoders of 65 536 counts at 100 Hz.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pinocchio as pin

import exoid
from exoid._typing import FloatArray
from exoid.errors import NotIdentifiableError
from exoid.online import RecursiveEstimator, load_change

RATE = 100.0
TERMS = (exoid.Coulomb(smoothing=0.02, reversal_speed=0.0), exoid.Viscous(), exoid.Offset())
STRIDES = (0.5, 0.507, 1.2, 4.0, 10.0, 12.0)  # 0.5 s are exactly 50 samples, each stride the same ones
FAULTS = ("torque-scale", "angle-offset", "torque-delay")
PLACE = (0.0, 0.0, -0.2)
"""Place of the load in the frame of the knee [m]."""

# Axis, mass [kg] and length [m] of each joint's segment, mean and largest harmonic of its angle [rad]
SEGMENTS = {
    "abduction": ("1 0 0", 1.5, 0.05, 0.0, 0.12),
    "hip": ("0 1 0", 9.0, 0.42, -0.2, 0.4),
    "knee": ("0 1 0", 4.0, 0.40, 0.5, 0.5),
    "ankle": ("0 1 0", 1.5, 0.12, 0.0, 0.2),
}
MACHINES = {
    "three joints": ("hip", "knee", "ankle"),
    "two joints": ("hip", "knee"),
    "abduction": ("abduction", "hip", "knee"),
}


@dataclass(frozen=True)
class Walker:
    """Leg drawn by a seed, which moves in strides."""

    text: str  # URDF
    leg: exoid.Leg
    stride: float  # [s]
    rng: np.random.Generator
    friction: FloatArray  # Coulomb friction [N·m], (n,)
    mean: FloatArray  # mean angles [rad], (n,)
    harmonics: FloatArray  # cosine and sine coefficients of three harmonics [rad], (2, 3, n)

    @classmethod
    def of(cls, seed: int, stride: float, machine: str = "three joints") -> Walker:
        """Draw a machine."""
        rng, parts, parent, above, joints = np.random.default_rng(seed), "", "torso", 0.0, MACHINES[machine]
        for joint in joints:
            axis, mass, length, *_ = SEGMENTS[joint]
            m, size = mass * rng.uniform(0.7, 1.3), length * rng.uniform(0.9, 1.1)
            inertia, x, z = m * size**2 / 12.0, rng.uniform(-0.03, 0.03), -size * rng.uniform(0.3, 0.6)
            parts += (
                f'<link name="at {joint}"><inertial><origin xyz="{x} 0 {z}"/><mass value="{m}"/><inertia '
                f'ixx="{inertia}" iyy="{inertia}" izz="{inertia / 5.0}" ixy="0" ixz="0" iyz="0"/></inertial></link>'
                f'<joint name="{joint}" type="continuous"><parent link="{parent}"/><child link="at {joint}"/>'
                f'<origin xyz="0 0 {-above}"/><axis xyz="{axis}"/></joint>'
            )
            parent, above = f"at {joint}", size
        text = f'<robot name="walker"><link name="torso"/>{parts}</robot>'
        leg = exoid.Leg.from_description(exoid.leg.description.describe(text), joints)
        friction = np.array([2.0, 1.5, 0.8])[: len(joints)] * rng.uniform(0.5, 1.2, len(joints))
        mean, largest = np.array([SEGMENTS[joint][3:] for joint in joints]).T
        angle, order = rng.uniform(0.0, 2.0 * np.pi, (3, len(joints))), np.arange(1.0, 4.0)[:, None]
        sizes = min(1.0, stride / 1.2) * largest * rng.uniform(0.6, 1.0, angle.shape) / order**1.5
        return cls(text, leg, stride, rng, friction, mean, sizes * np.array([np.cos(angle), np.sin(angle)]))

    def walk(self, seconds: float, load: float = 0.0, begin: float = 0.0) -> tuple[FloatArray, FloatArray]:
        """Measure angles and torques with so many kg on the shank, (N, n) each."""
        return self.measure(self.angles(begin + np.arange(0.0, seconds, 1.0 / RATE)), load)

    def angles(self, t: FloatArray) -> FloatArray:
        """Angles, velocities and accelerations, (3, N, n)."""
        omega = 2.0 * np.pi / self.stride * np.arange(1.0, 4.0)
        turn = np.exp(1j * t[:, None] * omega)
        coefficients = self.harmonics[0] - 1j * self.harmonics[1]
        q, v, a = (((turn * (1j * omega) ** k) @ coefficients).real for k in range(3))
        return np.array([q + self.mean, v, a])

    def measure(self, motion: FloatArray, load: float) -> tuple[FloatArray, FloatArray]:
        """Angles and torques of a motion, with friction and noise."""
        model, (q, v, a) = pin.buildModelFromXML(self.text), motion
        if load:
            body = pin.Inertia(load, np.array(PLACE), np.zeros((3, 3)))
            model.appendBodyToJoint(model.getJointId("knee"), body, pin.SE3.Identity())
        data, unbounded = model.createData(), np.stack([np.cos(q), np.sin(q)], axis=2).reshape(len(q), -1)
        tau = np.array([pin.rnea(model, data, *sample).copy() for sample in zip(unbounded, v, a, strict=True)])
        tau += self.friction * np.tanh(v / 0.02) + np.array([0.5, 0.3, 0.2])[: q.shape[1]] * v
        tau += np.array([0.4, 0.3, 0.2])[: q.shape[1]] * self.rng.standard_normal(q.shape)
        count = 2.0 * np.pi / 65536
        return np.round(q / count) * count, tau


class Found(NamedTuple):
    """What was found one stride or 5 s after a load, whichever is longer."""

    error: float  # of its mass [kg]; NaN where it could not be estimated
    std: float  # [kg]
    names: tuple[str, ...]  # changes that were named
    delay: float  # time until the first name [s]
    warned: bool  # whether a finding says that something is ambiguous, or contradicts


def strap_on(seed: int, stride: float, machine: str, *, learning: bool = False) -> Found:
    """Strap 1 to 3 kg on the shank of a machine that moves."""
    walker = Walker.of(seed, stride, machine)
    mass = walker.rng.uniform(1.0, 3.0)
    begin = walker.rng.uniform(12.0, 20.0) if learning else 40.0 + walker.rng.uniform(0.0, stride)
    online = RecursiveEstimator(walker.leg, TERMS, rate=RATE)
    update(online, walker.walk(begin))
    try:
        known = online.estimate
        update(online, walker.walk(max(5.0, stride), mass, begin))
        found = load_change(known, online.estimate, "knee", PLACE)
    except NotIdentifiableError:  # such as friction of a joint that moved one way only
        return Found(np.nan, np.nan, named(online), np.nan, warned=True)
    warned = any(one.kind in ("change-ambiguous", "residuals-grew") for one in online.findings)
    delay = online.changes[0].time - begin if online.changes else np.nan
    return Found(found.mass - mass, found.std, named(online), delay, warned)


class Spoilt(NamedTuple):
    """What was said some time after a sensor failed."""

    right: tuple[str, ...]  # the change that should be named
    names: tuple[str, ...]  # changes that were named
    before: float  # worst error of a parameter of the leg before it, in standard deviations
    after: float  # and at the end
    warned: bool  # whether a finding warns


def spoil(seed: int, stride: float, machine: str, fault: str) -> Spoilt:
    """Let the sensor of a joint fail behind 40 s of motion, and go on for two strides or 30 s, whichever is longer."""
    walker, begin = Walker.of(seed, stride, machine), round(40.0 * RATE)
    joint, sign = int(walker.rng.integers(len(walker.friction))), walker.rng.choice([-1.0, 1.0])
    joints = slice(None) if fault == "torque-delay" and seed % 2 else slice(joint, joint + 1)
    size, late = sign * np.deg2rad(walker.rng.uniform(1.0, 3.0)), int(walker.rng.integers(1, 6))
    q, tau = walker.walk(40.0 + max(30.0, 2.0 * stride))
    if fault == "torque-scale":
        tau[begin:, joints] *= 1.0 + 0.2 * sign
    elif fault == "angle-offset":
        q[begin:, joints] += size
    else:
        tau[begin:, joints] = tau[begin - late : -late, joints]
    online, errors = RecursiveEstimator(walker.leg, TERMS, rate=RATE), []
    for part in (slice(begin), slice(begin, None)):
        update(online, (q[part], tau[part]))
        try:
            estimate, count = online.estimate, len(walker.leg.parameters)
            error = (estimate.values[:count] - walker.leg.parameters) / estimate.std[:count]
            errors.append(float(np.abs(error).max()))
        except NotIdentifiableError:
            errors.append(np.nan)
    right = (f"{fault} at {walker.leg.joint_names[joint] if joints.stop else ''}",)
    warned = any(one.severity == "warning" for one in online.findings)
    return Spoilt(right, named(online), errors[0], errors[1], warned)


def update(online: RecursiveEstimator, samples: tuple[FloatArray, FloatArray]) -> None:
    """Take angles and torques in."""
    online.update(samples[0], None, None, samples[1])


def named(online: RecursiveEstimator) -> tuple[str, ...]:
    """Names of the changes that were detected."""
    return tuple(f"{one.kind} at {one.joint}" for one in online.changes)


def summary(every: list[Found]) -> str:
    """Write one line."""
    known = [one for one in every if np.isfinite(one.error)]
    if not known:
        return "not determined"
    error, std, delay = (np.array([getattr(one, name) for one in known]) for name in ("error", "std", "delay"))
    after = delay[np.isfinite(delay)]
    wrong = [one for one in every if set(one.names) - {"load at knee"}]
    narrow = sum(abs(one.error) > max(0.1, 4.0 * one.std) and not one.warned for one in known)
    return (
        f"P95 of errors {np.quantile(np.abs(error), 0.95):6.3f} kg, std {np.median(std):6.3f} kg, within 1.96 std "
        f"{np.mean(np.abs(error) < 1.96 * std):4.0%}, determined {len(known):2} of {len(every)}, named "
        f"{len(after):2}, wrongly {len(wrong)}, after "
        f"{np.median(after) if len(after) else np.nan:.1f} s, wrong and narrow {narrow}"
    )


def summary_of_faults(every: list[Spoilt]) -> str:
    """Write one line."""
    right = sum(one.names == one.right for one in every)
    silent = [one for one in every if not one.names and not one.warned]
    wrong = sorted({name for one in every if one.names != one.right for name in one.names})
    before, after = (np.nan_to_num([getattr(one, name) for one in every]) for name in ("before", "after"))
    lies = sum(one.after > max(5.0, 1.5 * one.before) and not one.warned for one in every)
    return (
        f"named {right:2} of {len(every)}, not noticed {len(silent)}, wrongly {', '.join(wrong) or 'none'}; "
        f"worst error {max(before):.1f} std before and {max(after):.1f} after, wrong in silence {lies}"
    )


def main() -> None:
    """Read the command line, and print a table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("study", choices=("load", "learning", *FAULTS, "quiet"))
    parser.add_argument("--seeds", type=int, default=16)
    parser.add_argument("--first", type=int, default=1000, help="first seed")
    parser.add_argument("--minutes", type=float, default=2.0)
    given = parser.parse_args()
    seeds = range(given.first, given.first + given.seeds)
    for machine in MACHINES:
        for stride in STRIDES:
            if given.study == "quiet":
                alarms: list[str] = []
                for seed in seeds:
                    walker = Walker.of(seed, stride, machine)
                    online = RecursiveEstimator(walker.leg, TERMS, rate=RATE)
                    update(online, walker.walk(60.0 * given.minutes))
                    alarms += named(online)
                print(f"{machine:13} {stride:4g} s: {', '.join(alarms) or 'none'}", flush=True)
                continue
            if given.study in FAULTS:
                spoilt = [spoil(seed, stride, machine, given.study) for seed in seeds]
                print(f"{machine:13} {stride:4g} s: {summary_of_faults(spoilt)}", flush=True)
                continue
            every = [strap_on(seed, stride, machine, learning=given.study == "learning") for seed in seeds]
            print(f"{machine:13} {stride:4g} s: {summary(every)}", flush=True)


if __name__ == "__main__":
    main()
