"""Integration step of legs with a wearer: leg and limb, coupled by cuffs.

Each body has the scheme of :class:`exoid.rig.Stepper`. Springs of cuffs and muscles are evaluated at the middle
of the step, q + ½ dt v̄, with the unknown mean velocities. A cuff with stiffness k and damping d then has the damping c:

    c = d + ½ dt k,      τ_wearer = k (q_l − q) + c (v̄_l − v̄)

No cuff is too stiff for the step, and the work of its spring in a step is exactly the change of its energy. With the
change Δv of the velocities of the leg and Δv_l of the limb, and impulses g and g_l that contain the velocities before,

    A Δv − ½ dt c Δv_l = g − r,      A_l Δv_l − ½ dt c Δv = g_l.

Δv_l is eliminated. What remains is a stick-slip problem of the leg alone, with the mass matrix
A − (½ dt)² c A_l⁻¹ c.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.leg.torso import TorsoMotion
from exoid.tools.numbers import ROUNDED
from exoid.torques.position_units import position_units

from .controllers import Reference, Target
from .plant import Plant
from .stepper import Equations, Step, Stepper
from .wearer import IMPEDANCES, Wearer


class WornStepper:
    """B rigs with their wearers. Angles, velocities and friction are those of the legs."""

    def __init__(self, leg: Stepper, wearer: Wearer, count: int) -> None:
        self.plant, self.dt, self._leg = leg.plant, leg.dt, leg
        limb = limb_plant(leg.plant, wearer)
        refuse_intention(leg.plant, wearer, count * leg.dt)
        self.limb = Stepper(limb, leg.q, leg.v, leg.dt)
        self._muscles = muscle_torques(wearer, limb, leg.dt, count)
        shape = (leg.plant.n, leg.plant.count)
        self._k, self._d, self._muscle_k, muscle_d = (
            np.broadcast_to(getattr(wearer, name), shape) for name in IMPEDANCES
        )
        self._c, self._muscle_c = self._d + 0.5 * leg.dt * self._k, muscle_d + 0.5 * leg.dt * self._muscle_k
        self._half = 0.5 * leg.dt * self._c
        self._work, self._dissipated, self._turnover = (np.zeros(shape) for _ in range(3))

    @property
    def q(self) -> FloatArray:
        """Angles of the legs [rad], (n, B)."""
        return self._leg.q

    @property
    def v(self) -> FloatArray:
        """Velocities of the legs [rad/s], (n, B)."""
        return self._leg.v

    def interaction(self, q: FloatArray, v: FloatArray, limb_q: FloatArray, limb_v: FloatArray) -> FloatArray:
        """Compute the torque of the wearers on the legs, k (q_l − q) + d (v_l − v)."""
        return np.asarray(self._k * (limb_q - q) + self._d * (limb_v - v))

    @property
    def exchange(self) -> FloatArray:
        """Work of the muscles, energy that the cuffs dissipated, and ∫ |power| dt of the muscles so far [J], (3, B)."""
        return np.asarray(np.sum([self._work, self._dissipated, self._turnover], axis=1))

    def step(self, torque: FloatArray, damping: FloatArray) -> Step:
        """Advance legs and limbs by dt under the actuator torque τ₀ − damping · v̄."""
        leg, limb, c = self._leg, self.limb, self._c
        q, v, limb_v = leg.q, leg.v, limb.v
        spring = self._k * (limb.q - q)
        drive = next(self._muscles) - self._muscle_k * limb.q
        of_leg = leg.equations(torque + spring + c * limb_v, damping + c)
        of_limb = limb.equations(drive - spring + c * v, self._muscle_c + c)
        free, response = _limb_response(of_limb, self._half)
        half = self._half[:, None]
        step = leg.solve(Equations(of_leg.M - half * response, of_leg.impulse + self._half * free))
        change = 2.0 * (step.mean_velocity - v)
        mean = limb.move(limb_v + free + (response * change).sum(axis=1))
        slip, work = mean - step.mean_velocity, self.dt * (drive - self._muscle_c * mean) * mean
        self._work += work
        self._turnover += np.abs(work)
        self._dissipated += self.dt * self._d * slip * slip
        return step

    def energy(self) -> FloatArray:
        """Compute the mechanical energy of legs and limbs, springs of the cuffs included."""
        cuffs = 0.5 * (self._k * (self.limb.q - self._leg.q) ** 2).sum(axis=0)
        return np.asarray(self._leg.energy() + self.limb.energy() + cuffs)


def muscle_torques(wearer: Wearer, limb: Plant, dt: float, count: int) -> Iterator[FloatArray]:
    """Torque u = RNEA_limb(q_i, v_i, a_i) + k_m q_i + d_m v_i at the middle of each step; it repeats after `count`."""
    shape, first = (limb.n, limb.count), 0
    torque = np.zeros((1, *shape))
    while wearer.intention is not None and first < count:
        steps = range(first, min(first + 250, count))  # in chunks: RNEA of many samples at once is fast
        q, v, a = intended(wearer.intention, [(k + 0.5) * dt for k in steps], shape, wearer.feedforward)
        torque = np.asarray(wearer.muscle_stiffness) * q + np.asarray(wearer.muscle_damping) * v
        if wearer.feedforward:
            q, v, a = (x.transpose(0, 2, 1).reshape(-1, limb.n) for x in (q, v, a))
            torso, leg = TorsoMotion(pitch=np.tile(limb.pitch, len(steps))), limb.leg
            many = leg.chain is not None  # the closed form is faster for many rigs
            alone = leg.regressor(q, v, a, torso) @ leg.parameters if many else leg.inverse_dynamics(q, v, a, torso)
            torque = torque + alone.reshape(len(steps), limb.count, limb.n).transpose(0, 2, 1)
        yield from torque
        first = steps.stop
    while True:
        yield torque[-1]


def intended(
    intention: Reference, times: list[float], shape: tuple[int, int], with_acceleration: bool
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Evaluate the intended motion, (K, n, B) each."""
    targets = [intention.at(time) for time in times]
    if with_acceleration and any(target.a is None for target in targets):
        raise BadArgumentError(
            "the intention has no acceleration, which the muscles' feedforward needs",
            remedy="give an intention with accelerations, such as those of exoid.experiments, or feedforward=False",
        )
    if not with_acceleration:
        targets = [Target(target.q, target.v, np.zeros(1)) for target in targets]
    try:
        q, v, a = (np.array([np.broadcast_to(x, shape) for x in each]) for each in zip(*targets, strict=True))
    except ValueError:
        raise BadArgumentError(
            f"an intention of shape {np.shape(targets[0].q)} for {shape[0]} joints of {shape[1]} rigs",
            remedy=f"give {shape} or ({shape[0]}, 1) angles; gait_for_leg(leg, flexion) makes the gait of a leg",
        ) from None
    if not (np.isfinite(q).all() and np.isfinite(v).all() and np.isfinite(a).all()):
        raise BadArgumentError("the intention contains a number that is not finite", remedy="give angles in rad")
    return q, v, a


def limb_plant(plant: Plant, wearer: Wearer) -> Plant:
    """Build the limbs of the rigs of a plant: bodies without friction, on the same torso."""
    leg, limb = plant.leg, wearer.limb
    kinds = [[joint.shortname() for joint in body.model.joints] for body in (leg, limb)]
    places = zip(leg.model.jointPlacements, limb.model.jointPlacements, strict=False)
    alike = kinds[0] == kinds[1] and all(at.isApprox(there, ROUNDED) for at, there in places)
    if limb.joint_names != leg.joint_names or not alike:
        what = f"a limb of {limb.description.name} ({', '.join(limb.joint_names)}) in a leg of {plant.description}"
        raise BadArgumentError(what, remedy="make the wearer of the plant's leg: Wearer.build(plant.leg, height, mass)")
    for name in IMPEDANCES:
        columns = np.shape(getattr(wearer, name))[1:]
        if columns not in ((), (1,), (plant.count,)):
            what = f"{name} for {columns[0]} rigs on {plant.count}"
            raise BadArgumentError(what, remedy="give one number for each joint")
    return Plant.build(limb, pitch=plant.pitch, end_stops=False)


def refuse_intention(plant: Plant, wearer: Wearer, duration: float) -> None:
    """Refuse an intended motion that the rigs cannot follow."""
    if wearer.intention is None:
        return
    times = np.linspace(0.0, duration, max(2, round(100.0 * duration) + 1)).tolist()
    q = intended(wearer.intention, times, (plant.n, plant.count), wearer.feedforward)[0]
    lower, upper = (np.clip(x, -2.0 * np.pi, 2.0 * np.pi) for x in (plant.lower, plant.upper))  # larger: degrees
    beyond = np.argwhere((q < lower - ROUNDED) | (q > upper + ROUNDED))
    if len(beyond):
        k, joint, rig = beyond[0]
        name, unit = plant.leg.joint_names[joint], position_units(plant.leg)[joint].rad
        raise BadArgumentError(
            f"the wearer intends {q[k, joint, rig]:.4g} {unit} of {name} at {times[k]:.2f} s, "
            f"beyond {lower[joint, rig]:.4g} and {upper[joint, rig]:.4g} {unit}",
            remedy="give an intention in rad or m between the end stops, or build the plant with end_stops=False",
        )


def _limb_response(limb: Equations, half: FloatArray) -> tuple[FloatArray, FloatArray]:
    """A_l⁻¹ g_l, (n, B), and A_l⁻¹ diag(½ dt c), (n, n, B)."""
    n, count = half.shape
    if count == 1:  # one small system: LAPACK is faster than array operations
        columns = np.hstack([limb.impulse, np.diag(half[:, 0])])
        found = np.linalg.solve(limb.M[..., 0], columns)
        return np.asarray(found[:, :1]), np.asarray(found[:, 1:, None])
    rows = np.zeros((n, 2 * n + 1, count))
    rows[:, :n], rows[:, n] = limb
    rows[np.arange(n), np.arange(n + 1, 2 * n + 1)] = half
    for k in range(n):  # Gauss-Jordan; A_l is positive definite, so pivoting is not needed
        pivot = rows[k] / rows[k, k]
        rows -= rows[:, k : k + 1] * pivot
        rows[k] = pivot
    return rows[:, n], rows[:, n + 1 :]
