"""What can be said of the test stand's force sensor and of the torque of its knee?

    python scripts/study_teststand.py              # all tables: a quarter of a minute on one core
    python scripts/study_teststand.py --exchange   # the second half identifies, the first one tests

The data are :func:`exoid.datasets.teststand_leg`: the first half identifies, the second tests. Angles, torques and
forces pass a zero-phase low-pass of 5 Hz. NRMSE is the root mean square of the error of a torque over its standard
deviation. The model of a joint is

    m = G(q) − Jᵀ f + (c + l |G − Jᵀ f|) tanh(v / 0.08 rad/s) + d v + o,
    τ = k m (1 + s |m|),

with the gravity G of the URDF, the force f = R(tilt) (reading + zero) on the foot, the same for both joints, and J of a
leg whose zeros of the angles and link lengths may be off. k is the scale of the logged torque, and s lets the torque
constant fall with the current. The foot stands still and the rail is straight, so that the lateral position of the foot
is constant: a third measurement. Each parameter has a prior width; a hypothesis frees some parameters and keeps the
others at their start. chi² is the sum of squares of residuals (0.012 N·m at the hip, 0.08 N·m at the knee, 1.5 mm; 60
independent samples) and of deviations from priors.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import pinocchio as pin
import scipy

import exoid
from exoid._typing import FloatArray
from exoid.signals import zero_phase
from exoid.signals.datasets import ForceDataset
from exoid.signals.datasets.teststand import FOOT, RATE, URDF
from exoid.signals.link_wrenches import link_placements

CUTOFF, STRIDE = 5.0, 20
"""Cut-off of the low-pass [Hz], and stride of the samples that are used."""

SLIDING = 0.08
"""Velocity at which friction has three quarters of its size [rad/s]."""

HIP, KNEE, LATERAL, INDEPENDENT = 0.012, 0.08, 1.5e-3, 60
"""Residuals that a good model leaves [N·m, N·m, m], and number of independent samples of a half."""


class Parameter(NamedTuple):
    """Start and prior width of a parameter, and what it is."""

    start: float
    width: float
    meaning: str


PARAMETERS = {
    "c1": Parameter(0.0, 0.1, "Coulomb friction of the hip [N·m]"),
    "c2": Parameter(0.0, 0.2, "Coulomb friction of the knee [N·m]"),
    "l1": Parameter(0.0, 0.2, "friction of the hip per torque of the load"),
    "l2": Parameter(0.0, 0.2, "friction of the knee per torque of the load"),
    "v1": Parameter(0.0, 0.1, "viscous friction of the hip [N·m·s/rad]"),
    "v2": Parameter(0.0, 0.1, "viscous friction of the knee [N·m·s/rad]"),
    "o1": Parameter(0.0, 0.05, "offset of the hip's torque [N·m]"),
    "o2": Parameter(0.0, 0.2, "offset of the knee's torque [N·m]"),
    "x0": Parameter(0.0, 0.1, "lateral position of the foot [m]"),
    "zero1": Parameter(0.0, 0.05, "zero of the hip's angle [rad]"),
    "zero2": Parameter(0.0, 0.05, "zero of the knee's angle [rad]"),
    "thigh": Parameter(0.0, 0.003, "thigh longer than in the URDF [m]"),
    "shank": Parameter(0.0, 0.010, "shank with foot longer than in the URDF [m]"),
    "radius": Parameter(0.0, 0.010, "radius of a foot that rolls [m]"),
    "lean": Parameter(0.0, 0.02, "lean of the rail about y [rad]"),
    "tilt": Parameter(0.0, 0.05, "tilt of the sensor about y [rad]"),
    "fx0": Parameter(0.0, 0.5, "zero of the sensor along x [N]"),
    "fz0": Parameter(0.0, 3.0, "zero of the sensor along z [N]"),
    "gain": Parameter(1.0, 0.5, "gain of the sensor"),
    "k1": Parameter(1.0, 0.2, "logged torque per torque of the hip"),
    "k2": Parameter(1.0, 0.2, "logged torque per torque of the knee"),
    "s2": Parameter(0.0, 0.2, "share of the knee's torque constant lost per N·m"),
}

FRICTION = ("c1", "c2", "l1", "l2", "v1", "v2", "o1", "o2", "x0")
GEOMETRY = ("zero1", "zero2", "thigh", "shank")
MOUNTING = ("tilt", "fx0", "fz0")
CHOSEN = (*FRICTION, *GEOMETRY, *MOUNTING, "s2")

CALIBRATIONS: Mapping[str, Sequence[str]] = {
    "friction only": FRICTION,
    "scale of the knee": (*FRICTION, "k2"),
    "scale of both joints": (*FRICTION, "k1", "k2"),
    "geometry": (*FRICTION, *GEOMETRY),
    "mounting": (*FRICTION, *MOUNTING),
    "geometry, mounting": (*FRICTION, *GEOMETRY, *MOUNTING),
    "geometry, mounting, gain of the sensor": (*FRICTION, *GEOMETRY, *MOUNTING, "gain"),
    "geometry, mounting, scale of the knee": (*FRICTION, *GEOMETRY, *MOUNTING, "k2"),
    "geometry, mounting, scale of both joints": (*FRICTION, *GEOMETRY, *MOUNTING, "k1", "k2"),
    "geometry, mounting, falling constant (chosen)": CHOSEN,
    "chosen, scale of the knee": (*CHOSEN, "k2"),
    "chosen, scale of the hip": (*CHOSEN, "k1"),
    "chosen, the foot rolls": (*CHOSEN, "radius"),
    "chosen, the rail leans": (*CHOSEN, "lean"),
    "chosen, the foot rolls, the rail leans": (*CHOSEN, "radius", "lean"),
}

SIGNS: Mapping[str, Callable[[FloatArray], FloatArray]] = {
    "as logged": lambda f: f,
    "x reversed": lambda f: f * (-1.0, 1.0, 1.0),
    "z reversed": lambda f: f * (1.0, 1.0, -1.0),
    "x and z reversed": lambda f: f * (-1.0, 1.0, -1.0),
    "y in the place of x": lambda f: f[:, [1, 0, 2]],
    "-y in the place of x": lambda f: f[:, [1, 0, 2]] * (-1.0, 1.0, 1.0),
}


@dataclass(frozen=True, eq=False)
class Samples:
    """Filtered signals at the samples that are used, and the geometry of the URDF."""

    leg: exoid.Leg
    q: FloatArray
    v: FloatArray
    rubbing: FloatArray
    tau: FloatArray
    force: FloatArray
    lengths: tuple[float, float]

    @property
    def half(self) -> int:
        """First sample of the second half."""
        return len(self.q) // 2


def samples_of(data: ForceDataset) -> Samples:
    """Filter and thin the recording."""
    q = zero_phase(data.recording.q, RATE, CUTOFF)
    v = np.gradient(q, 1.0 / RATE, axis=0)
    rubbing = zero_phase(np.tanh(v / SLIDING), RATE, CUTOFF)
    tau, force = (zero_phase(x, RATE, CUTOFF) for x in (data.recording.tau, data.force))
    model, rows = data.leg.model, slice(None, None, STRIDE)
    knee, foot = model.jointPlacements[2].translation, model.frames[model.getFrameId(FOOT)].placement.translation
    lengths = (-float(knee[2]), -float(foot[2]))
    return Samples(data.leg, q[rows], v[rows], rubbing[rows], tau[rows], force[rows], lengths)


def exchanged(samples: Samples) -> Samples:
    """The second half before the first."""
    signals = {
        name: np.roll(getattr(samples, name), -samples.half, axis=0) for name in ("q", "v", "rubbing", "tau", "force")
    }
    return replace(samples, **signals)


def arms(samples: Samples, values: Mapping[str, float]) -> FloatArray:
    """Point of contact seen from hip and knee, (N, 2, 2): x and z, behind the joints."""
    thigh, shank = samples.lengths[0] + values["thigh"], samples.lengths[1] + values["shank"]
    hip = samples.q[:, 0] + values["zero1"]
    both = hip + samples.q[:, 1] + values["zero2"]
    from_knee = -shank * np.stack([np.sin(both), np.cos(both)], axis=1) - np.array([0.0, values["radius"]])
    return np.stack([from_knee - thigh * np.stack([np.sin(hip), np.cos(hip)], axis=1), from_knee], axis=1)


def lateral(samples: Samples, values: Mapping[str, float]) -> FloatArray:
    """Lateral position of the foot [m], less what it rolls, (N,): constant on a straight rail."""
    foot = arms(samples, values)[:, 0]
    return np.asarray(foot[:, 0] - values["lean"] * foot[:, 1] - values["radius"] * samples.q.sum(axis=1))


def force_of(samples: Samples, values: Mapping[str, float]) -> FloatArray:
    """Force on the foot along x and z of the root link, (N, 2)."""
    x, z = (values["gain"] * (samples.force[:, k] + values[zero]) for k, zero in ((0, "fx0"), (2, "fz0")))
    cos, sin = np.cos(values["tilt"]), np.sin(values["tilt"])
    return np.stack([cos * x + sin * z, -sin * x + cos * z], axis=1)


def gravity(samples: Samples, values: Mapping[str, float]) -> FloatArray:
    """Torque that holds the leg, by the inertias of the URDF, (N, 2)."""
    still = np.zeros_like(samples.q)
    return samples.leg.inverse_dynamics(samples.q + np.array([values["zero1"], values["zero2"]]), still, still)


def predicted(samples: Samples, values: Mapping[str, float]) -> FloatArray:
    """Logged torque that the model expects, (N, 2)."""
    foot, force = arms(samples, values), force_of(samples, values)
    pushed = foot[..., 1] * force[:, :1] - foot[..., 0] * force[:, 1:]  # Jᵀ f of joints about y
    load = gravity(samples, values) - pushed
    c, of_load, d, o, k = (np.array([values[f"{name}1"], values[f"{name}2"]]) for name in "clvok")
    torque = load + (c + of_load * np.abs(load)) * samples.rubbing + d * samples.v + o
    return np.asarray(k * torque * (1.0 + np.array([0.0, values["s2"]]) * np.abs(torque)))


def motor_torque(logged: FloatArray | float, values: Mapping[str, float], joint: int) -> FloatArray:
    """Torque of a drive whose log says ``logged``: τ = k m (1 + s |m|), solved for m."""
    scaled, s = np.asarray(logged) / values[("k1", "k2")[joint]], values["s2"] if joint else 0.0
    return scaled if s <= 0.0 else np.sign(scaled) * (np.sqrt(1.0 + 4.0 * s * np.abs(scaled)) - 1.0) / (2.0 * s)


def predicted_force(samples: Samples, values: Mapping[str, float]) -> FloatArray:
    """Reading of the sensor along x and z that the logged torque implies, (N, 2): the model the other way round."""
    c, of_load, d, o = (np.array([values[f"{name}1"], values[f"{name}2"]]) for name in "clvo")
    torque = np.stack([motor_torque(samples.tau[:, joint], values, joint) for joint in (0, 1)], axis=1)
    rest = torque - c * samples.rubbing - d * samples.v - o
    load = rest / (1.0 + of_load * samples.rubbing * np.sign(rest))
    foot, pushed = arms(samples, values), gravity(samples, values) - load
    jacobian = np.stack([foot[..., 1], -foot[..., 0]], axis=2)
    force = np.linalg.solve(jacobian, pushed[..., np.newaxis])[..., 0]
    cos, sin = np.cos(values["tilt"]), np.sin(values["tilt"])
    x, z = cos * force[:, 0] - sin * force[:, 1], sin * force[:, 0] + cos * force[:, 1]
    return np.stack([x, z], axis=1) / values["gain"] - np.array([values["fx0"], values["fz0"]])


class Fit(NamedTuple):
    """Calibration of the first half."""

    values: dict[str, float]
    std: dict[str, float]
    chi2: float


def fit(samples: Samples, free: Sequence[str]) -> Fit:
    """Find the parameters that the first half and the priors make most probable."""
    start, width = (np.array([getattr(PARAMETERS[name], part) for name in free]) for part in ("start", "width"))
    first, rows = slice(None, samples.half), np.sqrt(samples.half / INDEPENDENT)

    def residuals(x: FloatArray) -> FloatArray:
        values = values_of(free, x)
        torque = (samples.tau - predicted(samples, values))[first] / (HIP, KNEE)
        aside = (lateral(samples, values)[first] - values["x0"]) / LATERAL
        return np.concatenate([torque.ravel() / rows, aside / rows, (x - start) / width])

    found = scipy.optimize.least_squares(residuals, start, x_scale=width)
    std = np.sqrt(np.diag(np.linalg.inv(found.jac.T @ found.jac)))
    return Fit(values_of(free, found.x), dict(zip(free, std.tolist(), strict=True)), 2.0 * float(found.cost))


def values_of(free: Sequence[str], x: FloatArray) -> dict[str, float]:
    """All parameters, the others at their start."""
    return {name: parameter.start for name, parameter in PARAMETERS.items()} | dict(zip(free, x.tolist(), strict=True))


def nrmse(error: FloatArray, signal: FloatArray) -> FloatArray:
    """Root mean square of an error over the standard deviation of the signal, per column."""
    return np.asarray(np.sqrt(np.mean(error**2, axis=0)) / signal.std(axis=0))


def linear(samples: Samples, joint: int, columns: FloatArray) -> tuple[FloatArray, tuple[float, float]]:
    """Fit the torque of a joint by least squares; coefficients, and NRMSE of both halves."""
    tau, half = samples.tau[:, joint], samples.half
    rubbed = np.column_stack([columns, samples.rubbing[:, joint], samples.v[:, joint], np.ones(len(tau))])
    found = np.linalg.lstsq(rubbed[:half], tau[:half])[0]
    error = tau - rubbed @ found
    return found, (float(nrmse(error[:half], tau[:half])), float(nrmse(error[half:], tau[half:])))


def without_physics(samples: Samples) -> None:
    """Print what fits the torques as well without the force."""
    print("NRMSE of the half that tests (the other in brackets), friction and offset in all rows")
    angle = (samples.q[:, 1] - samples.q[:, 1].mean()) / np.ptp(samples.q[:, 1])
    still = np.zeros_like(samples.q)
    regressor = samples.leg.regressor(samples.q, still, still)
    start = values_of((), np.empty(0))
    foot = arms(samples, start)
    rows = {
        "polynomial of the knee's angle, degree 12": [angle[:, None] ** np.arange(1, 13)] * 2,
        "parameters of the leg free, no force": [regressor[:, joint] for joint in (0, 1)],
        "parameters of the leg and gains of fx, fz free": [
            np.column_stack(
                [
                    regressor[:, joint],
                    -foot[:, joint, 1] * samples.force[:, 0],
                    foot[:, joint, 0] * samples.force[:, 2],
                ]
            )
            for joint in (0, 1)
        ],
    }
    joints = ("hip", "knee")
    for name, columns in rows.items():
        found = [linear(samples, joint, columns[joint]) for joint in (0, 1)]
        errors = [f"{which} {test:.3f} ({train:.3f})" for which, (_, (train, test)) in zip(joints, found, strict=True)]
        print(f"  {name:48s}", *errors)
    p = len(samples.leg.parameter_names)
    gains = [f"{which} fx {b[p]:.2f}, fz {b[p + 1]:.2f}" for which, (b, _) in zip(joints, found, strict=True)]
    print(f"  gains of the last row: {'; '.join(gains)}")
    free, own = found[0][0][0], samples.leg.parameters[0]
    print(f"  {samples.leg.parameter_names[0]} of the last row {free:.2f} kg·m, of the URDF {own:.3f} kg·m")
    print(f"  correlation of the two angles: {np.corrcoef(samples.q.T)[0, 1]:.5f}\n")


def same_pose(data: ForceDataset) -> None:
    """Print how well force and torque agree where the leg stands in the same pose twice."""
    recording, model = data.recording, data.leg.model
    q, tau, force = (x[-200:].mean(axis=0) - x[:200].mean(axis=0) for x in (recording.q, recording.tau, data.force))
    foot = model.getFrameId(FOOT)
    jacobian = pin.computeFrameJacobian(model, model.createData(), recording.q[0], foot, pin.LOCAL_WORLD_ALIGNED)
    change = jacobian[:3].T @ force
    print("The leg stands in one pose at the beginning and at the end; changes from one to the other")
    for name, turn, torque, push in zip(("hip", "knee"), 1e3 * q, 1e3 * tau, 1e3 * change, strict=True):
        print(f"  {name:4s} angle {turn:.2f} mrad, torque {torque:.0f} mN·m, Jᵀ f {push:.0f} mN·m")
    limit = 0.03 * float(data.test.tau[:, 0].std())
    print(f"  0.03 of the hip's torque: {1e3 * limit:.1f} mN·m, {1e3 * limit / 20.0:.2f} mm of the arm of 20 N\n")


def rail(data: ForceDataset, chosen: Fit) -> None:
    """Print what acts on the base along the rail, and what exoid says of the friction there."""
    leg = exoid.Leg.from_urdf(URDF.path(), ("joint_z", *data.leg.joint_names))
    q = np.insert(data.recording.q, 0, 0.0, axis=1)
    q[:, 0] = -link_placements(leg, q, FOOT).translation[:, 2]  # the foot stays where it is
    acceleration = np.gradient(np.gradient(zero_phase(q[:, 0], RATE, CUTOFF), 1.0 / RATE), 1.0 / RATE)
    weight = leg.parameters[0] * (9.81 + acceleration)
    pushed = weight - zero_phase(data.force[:, 2], RATE, CUTOFF) - chosen.values["fz0"]
    ends = "{:.1f} to {:.1f} N".format(*np.quantile(pushed, [0.001, 0.999]))
    print(f"\nRail: hand and friction push the base by {ends}; the machine weighs {weight.mean():.1f} N")
    tau, held = np.insert(data.recording.tau, 0, 0.0, axis=1), np.ones(len(q), dtype=bool)
    recording = replace(data.recording, q=q, tau=tau, joint_names=leg.joint_names, passive=("joint_z",))
    known = dict(zip(leg.parameter_names, leg.parameters.tolist(), strict=True))
    try:
        exoid.identify(leg, replace(recording, contacts={"base_link": held}), known=known)
    except exoid.ExoidError as error:
        print(f"  a hand that holds base_link is said: {error.what}")


def hypotheses(samples: Samples) -> Fit:
    """Print the fit of each sign and of each calibration; the chosen one is returned."""
    print(
        "NRMSE of the half that identifies, and of the other; lateral motion x of the foot; torque of the knee at 2.70"
    )
    chosen = None
    cases = [(name, replace(samples, force=change(samples.force)), FRICTION) for name, change in SIGNS.items()]
    cases += [(name, samples, free) for name, free in CALIBRATIONS.items()]
    for name, those, free in cases:
        found = fit(those, free)
        chosen = found if free is CHOSEN else chosen
        of_foot = [
            f"{name} {found.values[name]:.4f} ± {found.std[name]:.4f}" for name in ("radius", "lean") if name in free
        ]
        error, half = those.tau - predicted(those, found.values), those.half
        halves = [nrmse(error[part], those.tau[part]) for part in (slice(None, half), slice(half, None))]
        aside, limit = 1e3 * lateral(those, found.values).std(), motor_torque(2.7, found.values, 1)
        print(
            f"  {name:48s} chi² {found.chi2:7.0f}  hip {halves[0][0]:.3f} {halves[1][0]:.3f}"
            f"  knee {halves[0][1]:.3f} {halves[1][1]:.3f}  x {aside:.1f} mm  {limit:.2f} N·m",
            *of_foot,
        )
    assert chosen is not None
    print("\nThe chosen calibration")
    for name in CHOSEN:
        print(f"  {name:6s} {chosen.values[name]:8.4f} ± {chosen.std[name]:.4f}  {PARAMETERS[name].meaning}")
    return chosen


def forces(samples: Samples, chosen: Fit) -> None:
    """Print the error of the force that the torques of the second half imply."""
    second, read = slice(samples.half, None), samples.force[:, [0, 2]]
    uncalibrated = values_of((), np.empty(0))
    angle = (samples.q[:, 1] - samples.q[:, 1].mean()) / np.ptp(samples.q[:, 1])
    powers = angle[:, None] ** np.arange(9)
    of_angle = powers @ np.linalg.lstsq(powers[: samples.half], read[: samples.half])[0]
    print("\nForce on the half that tests, error in N rms and as a share of its range")
    for name, force in (
        ("from torques, URDF and log as they are", predicted_force(samples, uncalibrated)),
        ("from torques, chosen calibration", predicted_force(samples, chosen.values)),
        ("no torque: polynomial of the angle, degree 8", of_angle),
    ):
        rms = np.sqrt(np.mean((force - read)[second] ** 2, axis=0))
        share = rms / np.ptp(read[second], axis=0)
        print(f"  {name:48s} x {rms[0]:.2f} N ({share[0]:.1%})  z {rms[1]:.2f} N ({share[1]:.1%})")


def main() -> None:
    """Print all tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--exchange", action="store_true", help="exchange the halves")
    exchange = parser.parse_args().exchange
    data = exoid.datasets.teststand_leg()
    samples = exchanged(samples_of(data)) if exchange else samples_of(data)
    at_limit = np.abs(data.recording.tau[:, 1] - 2.7) < 0.03
    print(f"{len(data.recording)} samples; knee within 0.03 N·m of its limit of 2.7 N·m for {at_limit.mean():.0%}\n")
    without_physics(samples)
    same_pose(data)
    chosen = hypotheses(samples)
    forces(samples, chosen)
    rail(data, chosen)


if __name__ == "__main__":
    main()
