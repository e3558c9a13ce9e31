"""Nuisance columns: how the torque would change if the log or the model had a fault.

For a small fault δ the torque is τ = W β + z δ, with z the derivative of the predicted torque by the fault: −dτ/dt for
a torque that is late, ∂τ/∂q for an angle zero, ∂τ/∂L for a segment's length. The columns stand beside those of the
parameters, pass the same filter, and are tested in :mod:`exoid.identification.findings.score`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.leg.dynamics import gravity_slopes, inverse_dynamics_slopes
from exoid.leg.leg import Leg
from exoid.regression.least_squares import TINY
from exoid.signals.cutoff import white_noise
from exoid.signals.differentiation import difference
from exoid.signals.filters.low_pass import slow_part
from exoid.torques import Coulomb, Motion, TorqueModel
from exoid.torques.catalog import radians

from .arms import ArmShapes

STEP = 1e-4  # of finite differences [rad, or a part of the quantity]
LOADED, FOLLOWED = 0.05, 0.02  # standard deviations of Gaussians: of a joint's load, and of its effect on the angle [s]

RINGING, DAMPING = np.geomspace(2.0, 9.0, 40), 0.1
"""Frequencies [Hz] at which a link may ring on its spring, and its damping: so much that neighbours overlap."""


class Column(NamedTuple):
    """One nuisance column."""

    kind: str  # key of COLUMNS: what it is the derivative by
    place: int  # index of the joint or segment
    other: int = -1  # index of another joint, or of one of several columns; −1 for none


@dataclass(frozen=True, eq=False)
class NuisanceColumns:
    """Nuisance columns of a torque model, which stand beside those of its parameters."""

    model: TorqueModel  # the torque model
    columns: Sequence[Column]  # what each column is, K of them
    values: FloatArray  # parameters at which derivatives are taken, (P,)
    carried: FloatArray  # what payloads add to those of the leg, (R,)
    rate: float  # sampling rate [Hz]
    speed: FloatArray  # RMS speed of each joint [rad/s], (n,)
    hints: FloatArray  # see :func:`residual_hints`, (n, 3)
    moving: bool = True  # whether samples are a motion in time; False for poses
    arms: Mapping[int, ArmShapes] = field(default_factory=dict)  # of linear actuators, by the index of their joint
    # frequencies at which links ring on springs by the first block of samples [Hz], 0 for none
    seen: dict[str, FloatArray] = field(default_factory=dict)
    states: tuple[()] = ()  # the columns have no internal state

    @cached_property
    def acting(self) -> NDArray[np.bool_]:
        """Columns that can act on each joint, (n, K)."""
        joints = np.arange(len(self.model.leg.joint_names))
        return np.array([(joints == c.place) | (c.kind in OF_ALL_JOINTS) for c in self.columns], dtype=np.bool_).T

    def fill(self, motion: Motion, columns: FloatArray, out: FloatArray) -> None:
        """Write the columns."""
        of_leg = np.tensordot(self.values[: len(self.carried)] + self.carried, columns[: len(self.carried)], axes=1)
        known = np.zeros_like(of_leg) if motion.payload is None else motion.payload.T
        torque = known + np.tensordot(self.values, columns[: len(self.values)], axes=1)
        measured = np.zeros_like(torque) if motion.measured is None else motion.measured.T
        at = _Point(self, motion, columns[: len(self.values)], torque, of_leg, measured, known)
        alike: dict[tuple[str, int], list[tuple[FloatArray, int]]] = {}
        for (kind, place, other), of_column in zip(self.columns, out, strict=True):
            alike.setdefault((kind, other), []).append((of_column, place))
        for (kind, other), places in alike.items():
            found = COLUMNS[kind](at, other)
            for of_column, place in places:
                of_column[... if kind in OF_ALL_JOINTS else place] = found[place]


@dataclass(frozen=True, eq=False)
class _Point:
    """What the columns of one block of samples are derivatives at."""

    of: NuisanceColumns  # the columns
    motion: Motion  # angles, velocities and accelerations
    W: FloatArray  # columns of the parameters, (P, n, N)
    torque: FloatArray  # predicted torque [N·m], (n, N)
    of_leg: FloatArray  # its rigid-body part [N·m], (n, N)
    measured: FloatArray  # measured torque, zero where there is none [N·m], (n, N)
    known: FloatArray  # torque of payloads less that of measured wrenches [N·m], (n, N)

    @cached_property
    def leg(self) -> Leg:
        """The leg with the fitted parameters."""
        leg = self.of.model.leg
        return leg.with_parameters(self.of.values[: len(self.of.carried)] + self.of.carried)

    def sign(self, sharper: float = 1.0) -> FloatArray:
        """Direction of the motion of each joint, over the width of Coulomb friction, 0.05 rad/s without it, (n, N)."""
        width = 0.05 * radians(self.of.model.leg)
        for block in self.of.model.blocks:
            if isinstance(block.term, Coulomb) and block.term.smoothing > 0.0:
                width[list(block.joints)] = block.term.smoothing
        return np.asarray(np.tanh(sharper * self.motion.v.T / width[:, None]))

    @cached_property
    def slopes(self) -> FloatArray:
        """Derivatives of rigid-body torques by angles, velocities and accelerations, each joint's, (3, n, n, N)."""
        leg, motion = self.of.model.leg, self.motion
        if not leg.limbs and leg.closure is None:
            slopes = inverse_dynamics_slopes(self.leg.model, motion.q, motion.v, motion.a)
            return np.ascontiguousarray(np.transpose(slopes, (0, 3, 2, 1)))
        samples, n = motion.q.shape  # Pinocchio's are slower for planar legs, and know no closed loops
        several = Motion(*motion[:4]).rows(np.tile(np.arange(samples), 3 * n))
        for k, x in enumerate(several[:3]):
            for j in range(n):
                x.reshape(3, n, samples, n)[k, j, :, j] += STEP
        torque = self.regressor_torque(leg, several).reshape(n, 3, n, samples)
        return np.asarray((torque - self.of_leg[:, None, None]).transpose(1, 2, 0, 3) / STEP)

    def by_joints(self, *changes: FloatArray) -> FloatArray:
        """Change of the rigid-body torque by that of each joint's angle, velocity and acceleration, (n, n, N)."""
        return np.asarray(np.einsum("kjin,kjn->jin", self.slopes[: len(changes)], np.array(changes)))

    def regressor_torque(self, leg: Leg, motion: Motion) -> FloatArray:
        """Rigid-body torque of a leg by its regressor, (n, N)."""
        count = len(leg.parameter_names)
        out = np.zeros((count, *motion.q.shape[::-1]))
        leg.fill_regressor(motion.q, motion.v, motion.a, out, motion.torso)
        return np.asarray(np.tensordot(self.of.values[:count] + self.of.carried, out, axes=1))


def _earlier(at: _Point, x: FloatArray) -> FloatArray:
    """Change of a torque by a delay of 1 s, −dτ/dt, by polynomials through five samples."""
    if not at.of.moving or x.shape[-1] < 5 or not x.any():
        return np.zeros_like(x)
    return -difference(x.T, at.of.rate, 1, 4).T


def _smoothed(at: _Point, _: int) -> FloatArray:
    """What a low-pass without delay takes away from a torque; nothing of one whose noise it would have taken, too."""
    # noise of sensors is 0.1 % or more, and 0.02 % in means of 20 samples
    smooth = white_noise(at.measured.T) < 1e-4 * np.std(at.measured, axis=1) if at.of.moving else np.zeros(1)
    slow = slow_part(at.torque.T, at.of.rate, 3.0).T if smooth.any() else at.torque
    return smooth[:, None] * (slow - at.torque)


def _gravity(at: _Point, _: int) -> list[FloatArray]:
    """Derivatives of the gravity torque by a tilt about each of the two axes that are nearest to horizontal."""
    model, tree = at.leg.model, at.leg.tree_motion(at.motion.q)
    gravity, slopes = model.gravity.linear, gravity_slopes(model, tree.q)
    axes = np.delete(np.eye(3), np.argmax(np.abs(gravity)), axis=0)
    return [tree.project(np.tensordot(np.cross(axis, gravity), slopes, axes=1)).T for axis in axes]


def _length(at: _Point, _: int) -> list[FloatArray]:
    """Derivatives of the torque by the relative length of each segment."""
    leg, found = at.of.model.leg, []
    assert leg.machine is not None
    (limb,) = leg.limbs
    for j in range(len(limb.chain.offsets)):
        offsets = limb.chain.offsets.copy()
        offsets[j] *= 1.0 + STEP
        changed = replace(limb, chain=replace(limb.chain, offsets=offsets))
        longer = replace(leg, machine=replace(leg.machine, limbs=(changed,)))
        found.append((at.regressor_torque(longer, at.motion) - at.of_leg) / STEP)
    return found


def _compliance(at: _Point, _: int) -> FloatArray:
    """Change by 1 rad/(N·m) between encoder and link, q_link = q − τ / k (Spong 1987), by its derivative for 1 / k."""
    torque = at.of_leg
    if at.of.moving:
        # A link follows its motor below its resonance only: above, derivatives would amplify noise and what friction
        # does. Accelerations at the ends of a log are wrong, and would spread.
        ends = min(int(2.0 * LOADED * at.of.rate) + 1, (torque.shape[1] - 1) // 3)
        inner = np.pad(torque[:, ends:-ends], ((0, 0), (ends, ends)), "reflect", reflect_type="odd")
        torque = scipy.ndimage.gaussian_filter1d(inner, LOADED * at.of.rate)
    return _behind(at, torque)


def _ringing(at: _Point, _: int) -> FloatArray:
    """The same near a resonance, J q̈_link + c q̇_link = k (q − q_link), where the residual looks like one."""
    if at.of.moving and "ringing" not in at.of.seen:
        at.of.seen["ringing"] = _frequencies(at.of_leg, at.measured - at.torque, at.of.rate)
    lag, ringing = np.zeros_like(at.of_leg), at.of.seen.get("ringing", ())
    for j in np.flatnonzero(ringing).tolist():
        w, start = 2.0 * np.pi * ringing[j], at.of_leg[j, 0]
        poles = w * np.exp(np.array([1j, -1j]) * np.arccos(-DAMPING))
        b, a = scipy.signal.zpk2tf(*scipy.signal.bilinear_zpk([], poles, w**2, at.of.rate))
        lag[j] = start + scipy.signal.lfilter(b, a, at.of_leg[j] - start)  # what is constant passes unchanged
    return _behind(at, lag)


def _frequencies(torque: FloatArray, residual: FloatArray, rate: float) -> FloatArray:
    """Frequency of each joint's resonance that would leave least of a residual e: |e − H T| < |e|; 0 for none [Hz]."""
    f = scipy.fft.rfftfreq(torque.shape[1], 1.0 / rate)
    band = (f > 1.5) & (f < 10.0)  # parameters explain what is slower, and encoders spoil what is faster
    signals = np.hanning(torque.shape[1]) * [torque - torque.mean(axis=1, keepdims=True), residual]
    T, e = scipy.fft.rfft(signals)[..., band]
    ratio = f[band] / RINGING[:, None]
    H = 1.0 / (1.0 - ratio**2 + 2.0j * DAMPING * ratio) - 1.0  # torque of the spring, less that of a rigid joint
    gain = 2.0 * np.real(H @ (T * e.conj()).T) - np.abs(H) ** 2 @ (np.abs(T) ** 2).T
    return np.where(gain.max(axis=0) > 0.0, RINGING[gain.argmax(axis=0)], 0.0)


def _beyond(at: _Point, _: int) -> FloatArray:
    """What is logged beyond the limit of a drive, as a command may be."""
    return np.sign(at.measured) * np.maximum(np.abs(at.measured) - at.of.hints[:, :1], 0.0) * at.of.moving


def residual_hints(model: TorqueModel, motions: Sequence[Motion], torques: FloatArray) -> FloatArray:
    """Limit beyond which leaving a torque (N, n) out helps a fit most, share beyond, and waves of an angle, (n, 3)."""
    W, found = np.concatenate([model.columns(one) for one in motions], axis=2).transpose(1, 2, 0), []
    motion, m = [np.vstack(x).T for x in zip(*(one[:3] for one in motions), strict=True)], np.arange(6, 121)
    for of_joint, tau, q, v, a in zip(W, torques.T, *motion, strict=True):
        limits = np.quantile(np.abs(tau), np.linspace(0.4, 0.99, 30))
        Q, _ = np.linalg.qr(of_joint[:, of_joint.any(axis=0)])
        signals = np.vstack([tau, np.sign(tau) * np.maximum(np.abs(tau) - limits[:, None], 0.0)])
        left, *beyond = signals - signals @ Q @ Q.T
        limit = limits[np.argmax([max(float(left @ x), 0.0) ** 2 / max(float(x @ x), TINY) for x in beyond])]
        # an angle that is off by waves exp(i m q) leaves residuals like their second derivatives, Z = (i m a - m² v²) E
        E, each = np.vander(np.exp(1j * q), 121, increasing=True)[:, m], np.vstack([left, Q.T])
        of_left, *of_fit = 1j * m * ((each * a) @ E) - m**2 * ((each * v**2) @ E)
        apart = m**2 * (a @ a) + m**4 * np.sum(v**4) - np.linalg.norm(of_fit, axis=0) ** 2
        waves = m[np.argmax(np.abs(of_left) ** 2 / np.maximum(apart, TINY))]
        found.append((limit, np.mean(np.abs(tau) > limit), waves))
    return np.array(found)


def _play(at: _Point, _: int) -> FloatArray:
    """Change by 1 rad of play to each side, q_link = q − b sgn τ: the link rests on the side of its load."""
    # The load is what was measured less friction, which is in front of the gear: the model's has the jumps of the angle
    load = at.measured - at.torque + at.of_leg
    load = scipy.ndimage.gaussian_filter1d(load, LOADED * at.of.rate) if at.of.moving else load
    return _behind(at, np.sign(load))


def _behind(at: _Point, lag: FloatArray) -> FloatArray:
    """Change of the torque where links are behind their encoders by angles (n, N), and their motion by derivatives."""
    if not at.of.moving or not lag.any():
        return -at.by_joints(lag)
    # cut at 4 standard deviations, the kernel of the second derivative would see a constant
    of, width = scipy.ndimage.gaussian_filter1d, FOLLOWED * at.of.rate
    twist = (of(lag, width, order=k, truncate=6.0) * at.of.rate**k for k in range(3))
    return -at.by_joints(*twist)


def _ripple(at: _Point, k: int) -> FloatArray:
    """Change where an angle is off by sin or cos of m q: of 2 m the sine, of 2 m + 1 the cosine; m is found for 0."""
    m = at.of.hints[:, 2:] if k < 2 else k // 2
    q, v, a = (x.T for x in at.motion[:3])
    wave, slope = (np.sin(m * q), np.cos(m * q)) if k % 2 == 0 else (np.cos(m * q), -np.sin(m * q))
    return at.by_joints(wave, m * slope * v, m * slope * a - m**2 * wave * v**2)


COLUMNS: dict[str, Callable[[_Point, int], Sequence[FloatArray] | Mapping[int, FloatArray] | FloatArray]] = {
    "delay": lambda at, _: _earlier(at, at.torque),
    "delays": lambda at, _: [_earlier(at, at.torque)],
    "delays t": lambda at, _: [_earlier(at, at.torque)],
    "gain": lambda at, _: at.torque,
    # of rigid bodies: a curve of friction is friction of another form
    "gain |τ|": lambda at, _: np.abs(at.of_leg),
    "gain τ²": lambda at, _: at.of_leg**3 / np.maximum(np.mean(at.of_leg**2, axis=1, keepdims=True), TINY),
    "beyond": _beyond,
    "smoothing": _smoothed,
    # rotor and friction of the joint, where its encoder may sit, are not in the slopes of rigid bodies
    "late angle": lambda at, _: (
        _behind(at, -at.motion.v.T) - np.eye(len(at.torque))[..., None] * _earlier(at, at.torque - at.of_leg)
    ),
    "gains": lambda at, _: [at.torque],
    # nobody's sensor sees the torque of a joint that is passive, or that was not measured
    "cross-talk": lambda at, k: [at.torque[k] * at.measured[k].any()] * len(at.torque),
    "zero": lambda at, _: at.slopes[0],
    "scale": lambda at, _: at.by_joints(*(x.T for x in at.motion[:3])),
    "gravity": _gravity,
    "length": _length,
    # by the relative speed of the clock: velocities go with it, accelerations twice
    "clock": lambda at, _: [np.einsum("kjin,knj->in", at.slopes[1:], [at.motion.v, 2.0 * at.motion.a])],
    "known": lambda at, _: [at.known],
    "known delay": lambda at, _: [-_earlier(at, at.known)],
    "compliance": _compliance,
    "ringing": _ringing,
    "play": _play,
    "ripple": _ripple,
    "arm": lambda at, k: {j: arm.shapes(at.motion.q[:, j])[k] * at.torque[j] for j, arm in at.of.arms.items()},
    "constant": lambda at, _: np.ones_like(at.torque),
    "constant t": lambda at, _: np.ones_like(at.torque),
    "force": lambda at, other: [at.motion.q[:, other]] * len(at.torque),
    "force²": lambda at, _: at.motion.q.T**2,
    "sharpness": lambda at, _: at.sign(sharper=4.0),
    "reversals": lambda at, _: _earlier(at, at.sign()),  # a joint that stuck, or presliding, turns at another time
    "turning": lambda at, _: _earlier(at, _earlier(at, at.sign())),  # how long such a turn takes
    "friction |v|": lambda at, _: np.abs(at.motion.v.T),
    "friction v²": lambda at, _: at.motion.v.T * np.abs(at.motion.v.T),
    # falls off at a quarter of the RMS speed
    "friction Stribeck": lambda at, _: at.sign() * np.exp(-((4.0 * at.motion.v / at.of.speed.clip(1e-6)) ** 2)).T,
    "friction load": lambda at, _: at.sign() * np.abs(at.of_leg),
    "friction t": lambda at, _: np.tensordot(at.of.values * at.of.model.friction, at.W, axes=1),  # no rotor warms up
}
"""Nuisance columns by what they are derivatives of: of every place, (N,) of one joint, or (n, N) in `OF_ALL_JOINTS`.
The rows of a check multiply those that end in t by the time since the log began."""

OF_ALL_JOINTS = (
    *("delays", "gains", "delays t", "zero", "scale", "gravity", "length", "clock", "known", "known delay"),
    *("compliance", "ringing", "play", "ripple", "late angle"),
)
"""Columns that act on the torques of all joints."""
