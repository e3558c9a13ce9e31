"""What do point feet tell of a quadruped? ANYmal stands, lifts its feet and trots in MuJoCo; see docs/ground.md.

    python scripts/study_point_feet.py --seeds 8      # seeds from 1000, some minutes each on one core
    python scripts/study_point_feet.py --radius 0.03 --said 0.03    # balls [m] that are said to be balls

An IMU measures the base, and switches say which feet are down; forces on the feet are not measured. Noise: 1 % of the
torques, 17 bits of the encoders, 2e-3 rad/s and 0.02 m/s² of the IMU. Training: two sways on four feet, and four lifts
of each foot in turn. Test: a trot and jumps, of which no part was in the training.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import mujoco
import numpy as np
import pinocchio as pin
from example_robot_data.robots_loader import ROBOTS, getModelPath
from figures_over_seeds import run_seeds
from lxml import etree
from scipy.interpolate import PchipInterpolator, make_interp_spline
from scipy.spatial.transform import Rotation

import exoid
from exoid.errors import NotIdentifiableError
from exoid.estimate.friction_cone import cone_findings
from exoid.estimate.ground_validation import compare_on_ground
from exoid.torques.contacts import split

LEGS = ("LF", "RF", "LH", "RH")
FEET = tuple(f"{leg}_FOOT" for leg in LEGS)
RADIUS = 2e-4  # of the spheres that touch the ground [m]: points
PRESSED = 8.0  # force that closes a switch [N]
RATE = 400.0  # of the log [Hz]
STEP = 5e-4  # of the simulation [s]
STIFFNESS, DAMPING = 800.0, 12.0  # of the position controllers [N·m/rad, N·m·s/rad]
TORQUE, ENCODER, GYRO, ACCELEROMETER = 0.01, 2.0 * np.pi / 2**17, 2e-3, 0.02
BENT = {"HAA": 0.0, "HFE": 0.6, "KFE": -1.2}  # angles of a front leg that stands [rad]; hind legs bend the other way


def urdf() -> str:
    """ANYmal without meshes, its base with the inertia of the link that is fixed to it."""
    about = ROBOTS["anymal"]
    inside = f"{about.path}/{about.urdf_subpath}/{about.urdf_filename}"
    root = etree.parse(f"{getModelPath(inside)}/{inside}").getroot()
    for shape in (*root.findall("link/visual"), *root.findall("link/collision")):
        shape.getparent().remove(shape)
    base, inertia = (root.find(f"link[@name='{name}']") for name in ("base", "base_inertia"))
    base.remove(base.find("inertial"))
    base.append(inertia.find("inertial"))
    joint = next(each for each in root.findall("joint") if each.find("child").get("link") == "base_inertia")
    for each in (inertia, joint):
        root.remove(each)
    return etree.tostring(root).decode()


def world(text: str, radius: float) -> mujoco.MjModel:
    """ANYmal on level ground, with a motor at each joint."""
    root = etree.fromstring(text)
    etree.SubElement(etree.SubElement(root, "mujoco"), "compiler", fusestatic="true")
    for foot in FEET:
        collision = etree.SubElement(root.find(f"link[@name='{foot}']"), "collision")
        etree.SubElement(etree.SubElement(collision, "geometry"), "sphere", radius=str(radius))
    spec = mujoco.MjSpec.from_string(etree.tostring(root).decode())
    spec.option.timestep, spec.option.integrator = STEP, mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.cone, spec.option.impratio = mujoco.mjtCone.mjCONE_ELLIPTIC, 50
    spec.worldbody.first_body().add_freejoint()
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[10.0, 10.0, 0.1])
    for geom in spec.geoms:
        geom.friction, geom.condim, geom.solref = [0.8, 0.0, 0.0], 3, [0.004, 1.0]
        geom.density = 0.0
    for joint in spec.joints:
        if joint.type == mujoco.mjtJoint.mjJNT_HINGE:
            spec.add_actuator(name=joint.name, target=joint.name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
    return spec.compile()


class Kinematics:
    """Joint angles from places of the feet in the axes of the base."""

    def __init__(self, text: str) -> None:
        self.model = pin.buildModelFromXML(text)
        self.data = self.model.createData()
        self.names = list(self.model.names)[1:]
        self.frames = {leg: self.model.getFrameId(f"{leg}_FOOT") for leg in LEGS}
        self.joints = {leg: [k for k, name in enumerate(self.names) if name.startswith(leg)] for leg in LEGS}

    def standing(self) -> np.ndarray:
        """Angles of a pose with bent knees."""
        signs = [1.0 if name[1] == "F" else -1.0 for name in self.names]
        return np.array([sign * BENT[name[3:]] for sign, name in zip(signs, self.names, strict=True)])

    def feet(self, q: np.ndarray) -> dict[str, np.ndarray]:
        """Places of the feet in the axes of the base."""
        pin.framesForwardKinematics(self.model, self.data, q)
        return {leg: self.data.oMf[frame].translation.copy() for leg, frame in self.frames.items()}

    def angles(self, q: np.ndarray, targets: dict[str, np.ndarray]) -> np.ndarray:
        """Newton's method from angles nearby."""
        q = q.copy()
        for _ in range(6):
            at = self.feet(q)
            pin.computeJointJacobians(self.model, self.data, q)
            for leg, joints in self.joints.items():
                axes = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
                J = pin.getFrameJacobian(self.model, self.data, self.frames[leg], axes)[:3, joints]
                q[joints] += np.clip(np.linalg.solve(J, targets[leg] - at[leg]), -0.3, 0.3)
            if max(np.abs(targets[leg] - at[leg]).max() for leg in LEGS) < 1e-9:
                break
        return q


def waves(time: np.ndarray, rng: np.random.Generator, size: float, slowest: float = 0.2) -> np.ndarray:
    """Sum of five sines."""
    rates = 2.0 * np.pi * slowest * (1.0 + np.arange(5))
    parts = np.sin(np.outer(time, rates) + rng.uniform(0.0, 2.0 * np.pi, 5))
    return size * (parts / (1.0 + np.arange(5))).sum(axis=1) / np.sqrt(2.0)


def smooth(x: np.ndarray) -> np.ndarray:
    """Step from 0 to 1 without a jolt."""
    x = np.clip(x, 0.0, 1.0)
    return x**2 * (3.0 - 2.0 * x)


def reference(kinematics: Kinematics, kind: str, seconds: float, rng: np.random.Generator) -> tuple[np.ndarray, ...]:
    """Times and joint angles of a motion: "sway", "lift", "trot", "jump" or "little", a sway of some millimetres."""
    time, q = np.arange(0.0, seconds, 0.002), kinematics.standing()
    ramp, feet = smooth(time)[:, np.newaxis], kinematics.feet(q)
    scale = {"sway": 1.0, "lift": 0.4, "trot": 0.3, "jump": 0.1, "little": 0.05}[kind]
    place = scale * ramp * np.column_stack([waves(time, rng, size) for size in (0.04, 0.04, 0.035)])
    tilt = scale * ramp * np.column_stack([waves(time, rng, size) for size in (0.12, 0.1, 0.12)])
    targets = {leg: np.tile(feet[leg], (len(time), 1)) for leg in LEGS}
    if kind == "jump":  # crouch, push, draw the feet up, land
        knots, heights = [0.0, 0.5, 0.9, 1.04, 1.2, 1.4, 2.0], [0.0, 0.0, -0.08, 0.1, 0.0, 0.03, 0.0]
        place[:, 2] += PchipInterpolator(knots, heights)(time % 2.0)
    for k, leg in enumerate(LEGS):
        if kind == "trot":
            phase = (time / 0.5 + (0.0 if leg in ("LF", "RH") else 0.5)) % 1.0
            lifted = np.where(phase > 0.5, 0.08 * np.sin(2.0 * np.pi * (phase - 0.5)) ** 2, 0.0)
            targets[leg][:, 2] += ramp[:, 0] * lifted
        if kind == "lift":  # in its quarter of the time, the base moves over the others, and the foot waves
            u = (time / seconds * 4.0 - k) * np.where((time >= k * seconds / 4) & (time < (k + 1) * seconds / 4), 1, 0)
            place[:, :2] -= 0.2 * np.outer(smooth(np.minimum(u, 1.0 - u) / 0.15), feet[leg][:2])
            up = smooth(np.minimum(u - 0.2, 0.8 - u) / 0.1)
            wave = np.column_stack([waves(time, rng, size, 0.6) for size in (0.05, 0.03, 0.03)])
            targets[leg] += up[:, np.newaxis] * (wave + np.array([0.0, 0.0, 0.1]))
    turns = Rotation.from_euler("xyz", tilt).as_matrix()
    angles = np.empty((len(time), 12))
    for k, turn in enumerate(turns):
        q = angles[k] = kinematics.angles(q, {leg: turn.T @ (targets[leg][k] - place[k]) for leg in LEGS})
    return time, angles


@dataclass(frozen=True)
class Run:
    """What MuJoCo did: angles, torques, rates of turn and specific forces of the base, and forces on the feet."""

    time: np.ndarray
    q: np.ndarray
    tau: np.ndarray
    gyro: np.ndarray
    force: np.ndarray
    feet: np.ndarray

    def recording(self, names: tuple[str, ...], rng: np.random.Generator, noise: float = 1.0) -> exoid.Recording:
        """Log of the sensors."""

        def noisy(values: np.ndarray, std: float | np.ndarray) -> np.ndarray:
            return values + noise * std * rng.standard_normal(values.shape)

        base = exoid.BaseMotion.from_imu(noisy(self.gyro, GYRO), noisy(self.force, ACCELEROMETER))
        contacts = {foot: self.feet[:, k] > PRESSED for k, foot in enumerate(FEET)}
        tau, q = noisy(self.tau, TORQUE * self.tau.std(axis=0)), noisy(self.q, ENCODER / np.sqrt(12.0))
        return exoid.Recording(self.time, q, tau=tau, joint_names=names, base=base, contacts=contacts)


def simulate(text: str, kind: str, seconds: float, seed: int, radius: float = RADIUS) -> Run:
    """Follow a reference by position controllers."""
    kinematics, model = Kinematics(text), world(text, radius)
    time, angles = reference(kinematics, kind, seconds, np.random.default_rng(seed))
    names = [model.joint(k).name for k in range(1, model.njnt)]
    order = [names.index(name) for name in kinematics.names]
    spline = make_interp_spline(time, angles, k=3)
    speed, data = spline.derivative(), mujoco.MjData(model)
    back = np.argsort(order)
    data.qpos[7:], data.qpos[3] = angles[0][back], 1.0
    data.qpos[2] = radius - min(place[2] for place in kinematics.feet(angles[0]).values())
    balls = {k: int(model.geom_bodyid[k]) for k in range(model.ngeom) if model.geom_bodyid[k]}
    legs = {k: LEGS.index(model.body(body).name[:2]) for k, body in balls.items()}
    rows, wrench, every = [], np.zeros(6), round(1.0 / (RATE * STEP))
    for k in range(-round(1.0 / STEP), round(seconds / STEP) - 1):  # a second to come to rest
        now, moving = max(k, 0) * STEP, k >= 0
        data.ctrl[back] = STIFFNESS * (spline(now) - data.qpos[7:][order])
        data.ctrl[back] += DAMPING * (moving * speed(now) - data.qvel[6:][order])
        if moving and k % every == 0:
            mujoco.mj_forward(model, data)
            upright = Rotation.from_quat(data.qpos[[4, 5, 6, 3]]).inv()
            normal = np.zeros(4)
            for c, contact in enumerate(data.contact):
                mujoco.mj_contactForce(model, data, c, wrench)
                normal[legs[next(each for each in (contact.geom1, contact.geom2) if each in legs)]] += wrench[0]
            force = upright.apply(data.qacc[:3] + np.array([0.0, 0.0, 9.81]))
            rows.append((now, data.qpos[7:][order], data.ctrl[order], data.qvel[3:6].copy(), force, normal))
        mujoco.mj_step(model, data)
    return Run(*(np.array(column) for column in zip(*rows, strict=True)))


def figures(text: str, seed: int, radius: float = RADIUS, said: float = 0.0) -> dict[str, float]:
    """Figures of one seed."""
    from exoid.leg.description import describe  # noqa: PLC0415

    leg = exoid.Leg.from_description(
        describe(text, "anymal.urdf"), base="floating", contacts=dict.fromkeys(FEET, said or "point")
    )
    kinds = ("sway", "lift", "lift", "sway")
    runs = [simulate(text, kind, 20.0, 10 * seed + k, radius) for k, kind in enumerate(kinds)]
    logs = [run.recording(leg.joint_names, np.random.default_rng([seed, k])) for k, run in enumerate(runs)]
    estimate = exoid.identify(leg, logs, terms=(), check=False)
    error = estimate.values - leg.parameters
    inside = np.abs(error) < estimate.std * 1.96
    found = {
        "total mass, error [%]": 100.0 * abs(error[0]) / leg.parameters[0],
        "parameters in their 95 % interval [%]": 100.0 * float(np.mean(inside)),
    }
    alarms = [any(cone_findings(estimate, split(leg, log, estimate.preparation).stretches)) for log in logs]
    for k, kind in enumerate(("trot", "jump")):
        run = simulate(text, kind, 10.0, 10 * seed + 9 - k, radius)
        log = run.recording(leg.joint_names, np.random.default_rng([seed, 9]))
        residuals = []
        for each in (estimate, replace(estimate, values=leg.parameters)):
            compared = compare_on_ground(each, log, each.preparation, 1.0)
            residuals.append(float(np.sqrt(np.mean((compared.measured - compared.predicted) ** 2))))
        found[f"residual on a {kind}, over that of the true parameters"] = residuals[0] / residuals[1]
        found[f"residual on a {kind} [N·m]"] = residuals[0]
        alarms.append(any(cone_findings(estimate, split(leg, log, estimate.preparation).stretches)))
    found["healthy logs with a finding friction-cone [%]"] = 100.0 * float(np.mean(alarms))
    run = simulate(text, "little", 10.0, 10 * seed + 7, radius)
    little = run.recording(leg.joint_names, np.random.default_rng([seed, 7]))
    try:
        exoid.identify(leg, little, terms=(), check=False)
        found["sway of some millimetres refused [%]"] = 0.0
    except NotIdentifiableError:
        found["sway of some millimetres refused [%]"] = 100.0
    return found


if __name__ == "__main__":
    text = urdf()
    run_seeds(__doc__, lambda seed, radius, said: figures(text, seed, radius, said), radius=RADIUS, said=0.0)
