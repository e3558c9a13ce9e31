"""What do a machine on a hook and one in flight tell? ANYmal in MuJoCo without ground; see docs/ground.md.

    python scripts/study_suspended.py --seeds 8      # seeds from 1000, about a minute each on one core

The legs wave, and the base swings or tumbles as they push it. An IMU measures the base; noise is that of the study of
point feet. The hook is a ball joint 0.2 m above the base, whose force is unknown. In flight there is no force.
"""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
from figures_over_seeds import run_seeds
from lxml import etree
from scipy.interpolate import make_interp_spline
from study_point_feet import ACCELEROMETER, ENCODER, FEET, GYRO, RATE, STEP, TORQUE, Kinematics, urdf, waves

import exoid
from exoid.errors import NotIdentifiableError
from exoid.leg.description import describe

HOOK = (0.05, 0.02, 0.2)  # in the axes of the base [m]
STIFFNESS, DAMPING = 150.0, 4.0  # of the position controllers [N·m/rad, N·m·s/rad]


def with_hook(text: str) -> str:
    """Fix a link "hook" to the base."""
    root = etree.fromstring(text)
    etree.SubElement(root, "link", name="hook")
    joint = etree.SubElement(root, "joint", name="hook_joint", type="fixed")
    for tag, name in (("parent", "base"), ("child", "hook")):
        etree.SubElement(joint, tag, link=name)
    etree.SubElement(joint, "origin", xyz=" ".join(map(str, HOOK)))
    return etree.tostring(root).decode()


def world(text: str, support: str) -> mujoco.MjModel:
    """ANYmal on a "hook", or in "flight"."""
    root = etree.fromstring(text)
    etree.SubElement(etree.SubElement(root, "mujoco"), "compiler", fusestatic="true")
    spec = mujoco.MjSpec.from_string(etree.tostring(root).decode())
    spec.option.timestep, spec.option.integrator = STEP, mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    base = spec.worldbody.first_body()
    if support == "hook":
        base.add_joint(name="hook", type=mujoco.mjtJoint.mjJNT_BALL, pos=HOOK)
    else:
        base.add_freejoint()
    for joint in spec.joints:
        if joint.type == mujoco.mjtJoint.mjJNT_HINGE:
            spec.add_actuator(name=joint.name, target=joint.name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
    return spec.compile()


def simulate(text: str, support: str, seconds: float, rng: np.random.Generator) -> exoid.Recording:
    """Wave the legs, and log what the sensors read."""
    kinematics, model = Kinematics(text), world(text, support)
    time = np.arange(0.0, seconds, 0.002)
    size = np.array([0.15, 0.3, 0.4] * 4)
    swing = np.column_stack([waves(time, rng, each, 0.35) for each in size])
    spline = make_interp_spline(time, kinematics.standing() + swing, k=3)
    speed, data = spline.derivative(), mujoco.MjData(model)
    joints = [model.joint(name) for name in kinematics.names]
    places, rates = (np.array([getattr(each, key)[0] for each in joints]) for key in ("qposadr", "dofadr"))
    act = np.array([model.actuator(name).id for name in kinematics.names])
    data.qpos[places], data.qvel[rates] = spline(0.0), speed(0.0)
    spin = 0 if support == "hook" else 3
    rows, every = [], round(1.0 / (RATE * STEP))
    for k in range(round(seconds / STEP) - 1):
        now = k * STEP
        data.ctrl[act] = STIFFNESS * (spline(now) - data.qpos[places]) + DAMPING * (speed(now) - data.qvel[rates])
        if k % every == 0:
            mujoco.mj_forward(model, data)
            acceleration = np.zeros(6)
            mujoco.mj_rnePostConstraint(model, data)
            body = model.body("base").id
            mujoco.mj_objectAcceleration(model, data, mujoco.mjtObj.mjOBJ_XBODY, body, acceleration, 1)
            rows.append((now, data.qpos[places], data.ctrl[act], data.qvel[spin : spin + 3].copy(), acceleration[3:]))
        mujoco.mj_step(model, data)
    time, q, tau, gyro, force = (np.array(column) for column in zip(*rows, strict=True))

    def noisy(values: np.ndarray, std: float | np.ndarray) -> np.ndarray:
        return values + std * rng.standard_normal(values.shape)

    base = exoid.BaseMotion.from_imu(noisy(gyro, GYRO), noisy(force, ACCELEROMETER))
    base = replace(base, calibrated=True)
    link = "hook" if support == "hook" else FEET[0]
    return exoid.Recording(
        time,
        noisy(q, ENCODER / np.sqrt(12.0)),
        tau=noisy(tau, TORQUE * tau.std(axis=0)),
        joint_names=tuple(kinematics.names),
        base=base,
        contacts={link: np.full(len(time), support == "hook")},
    )


def figures(text: str, seed: int) -> dict[str, float]:
    """Figures of one seed."""
    contacts = {"hook": "point", **dict.fromkeys(FEET, "point")}
    leg = exoid.Leg.from_description(describe(text, "anymal.urdf"), base="floating", contacts=contacts)
    mass, truth, found = leg.parameter_names[0], leg.parameters, {}
    for support in ("hook", "flight"):
        logs = [simulate(text, support, 20.0, np.random.default_rng([seed, k])) for k in range(2)]
        try:
            estimate = exoid.identify(leg, logs, terms=(), check=False)
            refused = 0.0
        except NotIdentifiableError as error:
            refused = float(mass in error.parameters)
            estimate = exoid.identify(leg, logs, terms=(), check=False, known={mass: float(truth[0])})
        error, std = np.abs(estimate.values - truth), estimate.std
        inside = 100.0 * float(np.mean(error[1:] < 1.96 * std[1:]))
        found[f"{support}: seeds whose total mass is refused by name [%]"] = 100.0 * refused
        if not refused:
            found[f"{support}: total mass, error [%]"] = 100.0 * float(error[0] / truth[0])
            found[f"{support}: total mass, standard deviation [%]"] = 100.0 * float(std[0] / truth[0])
        found[f"{support}: other parameters in their 95 % interval [%]"] = inside
    return found


if __name__ == "__main__":
    text = with_hook(urdf())
    run_seeds(__doc__, lambda seed: figures(text, seed))
