"""Motions of an exoskeleton that stands: joint angles from the feet, torques from the equation of motion."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import scipy

from exoid import BaseMotion, Coulomb, Leg, Recording, Viscous, Wrench
from exoid.leg.base_kinematics import BaseKinematics
from exoid.torques import TorqueModel

TERMS = (Coulomb(smoothing=0.05, reversal_speed=0.0), Viscous())
GRAVITY = 9.81
ORDER = 7
"""Of the splines that motions are differentiated by."""


def friction(v: np.ndarray) -> np.ndarray:
    """Torque that has the form of the terms [N·m]."""
    return 1.5 * np.tanh(v / 0.05) + 0.8 * v


class Standing(NamedTuple):
    """A recording, and what is not in it."""

    recording: Recording
    base: BaseKinematics
    wrenches: dict[str, Wrench]
    exact: tuple[np.ndarray, np.ndarray, np.ndarray]


def waves(time: np.ndarray, rng: np.random.Generator, middle: float, size: float, slowest: float = 0.2) -> np.ndarray:
    """Sum of five sines between the slowest frequency and five times that."""
    frequencies = slowest * (1.0 + np.arange(5))
    parts = np.sin(2.0 * np.pi * np.outer(time, frequencies) + rng.uniform(0.0, 2.0 * np.pi, 5))
    return middle + size * (parts / (1.0 + np.arange(5))).sum(axis=1) / np.sqrt(2.0)


def leg_angles(leg: Leg, hip: np.ndarray, pitch: np.ndarray, sole: float = 0.0) -> np.ndarray:
    """Hip, knee and ankle angles that put a foot at the origin under a hip at (x, z)."""
    chain = leg.limbs[0].chain
    first, second = (complex(x, z) for x, z in chain.offsets)
    reach = -(hip[:, 0] + 1j * hip[:, 1])
    cosine = (np.abs(reach) ** 2 - abs(first) ** 2 - abs(second) ** 2) / (2.0 * abs(first) * abs(second))
    knee = -np.arccos(cosine) - np.angle(second / first)
    thigh = np.angle(reach / (first + second * np.exp(1j * knee)))
    return np.column_stack([thigh - pitch, knee, sole - thigh - knee])


def derivatives(time: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First and second derivative by a spline."""
    spline = scipy.interpolate.make_interp_spline(time, values, k=ORDER)
    return spline(time, 1), spline(time, 2)


def standing(leg: Leg, feet: str, seconds: float = 20.0, seed: int = 0, rate: float = 250.0, **options) -> Standing:
    """Squat, shift and pitch on "both" feet, or on the "left" while the right leg swings.

    The load is shared by a share that varies, which is what only measured wrenches tell. The ground may "lean" [rad],
    and the "sole" of the left foot tip by an angle of the time [rad], about a "pivot" x + i z from its origin [m].
    """
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, seconds, 1.0 / rate)
    hip = np.column_stack([waves(time, rng, 0.02, 0.04), waves(time, rng, 0.74, 0.04)])
    pitch = waves(time, rng, 0.1, 0.12)
    sole = options.pop("sole", np.zeros_like)(time)
    origin = options.pop("pivot", 0.0) * (1.0 - np.exp(1j * sole))
    left = leg_angles(leg, hip - np.column_stack([origin.real, origin.imag]), pitch, sole)
    if feet == "both":
        right = leg_angles(leg, hip + np.array([0.08, 0.0]), pitch)
    else:
        middles, sizes = (0.4, -0.8, 0.0), (0.4, 0.35, 0.3)
        right = np.column_stack([waves(time, rng, m, s, 0.25) for m, s in zip(middles, sizes, strict=True)])
    q = np.hstack([left, right])
    v, a = derivatives(time, q)
    base = _base(leg, time, hip, pitch, options.pop("lean", 0.0))
    rows = leg.inverse_dynamics(q, v, a, base)
    if "payloads" in options:
        model = TorqueModel(leg, ())
        rows = rows + model.motion(q, v, a, base, options["payloads"]).payload
    count = leg.base_rows
    share = np.clip(waves(time, rng, 0.5, 0.1), 0.0, 1.0)[:, None] if feet == "both" else np.zeros((len(time), 1))
    tau, wrenches, loads = rows[:, count:].copy(), {}, rows[:, :count]
    for foot, part in (("right_foot", share), ("left_foot", 1.0 - share)):
        jacobian = leg.contact_jacobian(q, foot)
        wrench = np.linalg.solve(np.swapaxes(jacobian[..., :count], 1, 2), (part * loads)[..., None])[..., 0]
        tau -= np.einsum("ncj,nc->nj", jacobian[..., count:], wrench)
        zero = np.zeros(len(time))
        # level axes of the foot are x forward, y left, z up; the pitch is about -y
        wrenches[foot] = Wrench(
            np.column_stack([wrench[:, 0], zero, wrench[:, 1]]), np.column_stack([zero, -wrench[:, 2], zero])
        )
    extra = options.pop("friction", None)
    if extra is not None:
        tau = tau + extra(v)
    contacts = {"left_foot": np.ones(len(time), dtype=bool)}
    if feet == "both":
        contacts["right_foot"] = contacts["left_foot"]
    noise = options.pop("noise", 0.0)
    encoder = options.pop("encoder", 0.0)
    angles = q + encoder * rng.standard_normal(q.shape)
    torques = tau + noise * rng.standard_normal(q.shape)
    recording = Recording(time, angles, tau=torques, joint_names=leg.joint_names, contacts=contacts, **options)
    return Standing(recording, base, wrenches, (q, v, a))


SWAP = [3, 4, 5, 0, 1, 2]
"""Joints of the other leg."""


def mirrored(log: Standing) -> Standing:
    """The same motion with left and right changed."""
    recording = log.recording
    contacts = {_other(link): flags for link, flags in recording.contacts.items()}
    turned = replace(recording, q=recording.q[:, SWAP], tau=recording.tau[:, SWAP], contacts=contacts)
    wrenches = {_other(link): wrench for link, wrench in log.wrenches.items()}
    return Standing(turned, log.base, wrenches, tuple(part[:, SWAP] for part in log.exact))


def session(leg: Leg, seed: int = 0, **options) -> list[Standing]:
    """A motion on both feet, and each leg swinging while the other stands."""
    feet = ("both", "left", "left")
    both, left, other = (standing(leg, rest, seed=seed + k, **options) for k, rest in enumerate(feet))
    return [both, left, mirrored(other)]


def with_imu(log, seed, force_bias=(0.1, 0.0, 0.15), gyro_bias=(0.0, 0.01, 0.0), noise=1.0) -> Recording:
    """The recording with an IMU that has the usual noise, or more, and these biases [m/s², rad/s]."""
    rng = np.random.default_rng(seed)
    gyro = log.base.angular_velocity + 0.005 * noise * rng.standard_normal((len(log.base), 3)) + gyro_bias
    force = log.base.specific_force + 0.05 * noise * rng.standard_normal((len(log.base), 3)) + force_bias
    return replace(log.recording, base=BaseMotion(gyro, force))


def _other(link: str) -> str:
    return {"left_foot": "right_foot", "right_foot": "left_foot"}[link]


def _base(leg: Leg, time: np.ndarray, hip: np.ndarray, pitch: np.ndarray, lean: float) -> BaseKinematics:
    """Motion of a torso whose origin is at the hip within the plane."""
    plane = leg.limbs[0].chain.plane
    rate, change = derivatives(time, pitch)
    _, acceleration = derivatives(time, hip)
    lifted = acceleration + GRAVITY * np.array([np.sin(lean), np.cos(lean)])
    turn = np.exp(-1j * pitch) * (lifted[:, 0] + 1j * lifted[:, 1])
    force = np.outer(turn.real, plane.forward) + np.outer(turn.imag, plane.up)
    return BaseKinematics(-np.outer(rate, plane.lateral), -np.outer(change, plane.lateral), force)
