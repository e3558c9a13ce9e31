"""Does the force under a hopper on a rail follow from joint torques? Jumps and squats in MuJoCo; see docs/ground.md.

    python scripts/study_rail.py --seeds 8           # seeds from 1000, about half a minute each on one core
    python scripts/study_rail.py --radius 0.015      # a ball of that radius [m], said to be a point: its centre
    python scripts/study_rail.py --radius 0.015 --said 0.015     # and said to be a ball
    python scripts/study_rail.py --beside 0.02       # is a place of the foot named that is so far off?

Each seed has a hopper of its own: masses, lengths, rotors, friction of joints and rail. It stands on a point and moves
along a vertical rail. The force under the foot is measured in the training alone; the test has a foot switch. Noise:
1 % of the torques and of the force, 17 bits of the encoders, 0.05 mm of the rail's scale.
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
from figures_over_seeds import run_seeds
from lxml import etree
from scipy.interpolate import PchipInterpolator

import exoid
from exoid.leg.description import describe

RATE, STEP = 500.0, 2e-4  # of the log [Hz], and step of the simulation [s]
RADIUS = 2e-4  # of the sphere that touches the ground [m]: a point
PRESSED = 3.0  # force that closes the switch [N]
TORQUE, FORCE, ENCODER, SCALE = 0.01, 0.01, 2.0 * np.pi / 2**17 / np.sqrt(12.0), 5e-5
TERMS = (exoid.Coulomb(smoothing=0.02, reversal_speed=0.0), exoid.Viscous(), exoid.Armature(joints=("hip", "knee")))

URDF = """<robot name="hopper"><link name="base">{base}</link><link name="thigh">{thigh}</link>
<link name="shank">{shank}</link><link name="foot"/>
<joint name="hip" type="continuous"><parent link="base"/><child link="thigh"/><axis xyz="0 1 0"/></joint>
<joint name="knee" type="continuous"><parent link="thigh"/><child link="shank"/><origin xyz="0 0.03 -{long[0]}"/>
<axis xyz="0 1 0"/></joint>
<joint name="sole" type="fixed"><parent link="shank"/><child link="foot"/><origin xyz="0 0 -{long[1]}"/></joint>
</robot>"""


@dataclass(frozen=True)
class Hopper:
    """A hopper: its URDF, lengths of thigh and shank, rotors, friction of rail, hip and knee, radius of its foot."""

    urdf: str
    long: tuple[float, float]
    armature: np.ndarray
    coulomb: np.ndarray
    viscous: np.ndarray
    radius: float

    @classmethod
    def drawn(cls, rng: np.random.Generator, radius: float = RADIUS) -> Hopper:
        """Draw one."""
        long, mass = rng.uniform(0.16, 0.28, 2), rng.uniform([2.0, 0.4, 0.15], [6.0, 1.2, 0.4])

        def inertial(mass: float, centre: tuple[float, ...], radius: float) -> str:
            place = " ".join(f"{x:.5f}" for x in centre)
            moment = " ".join(f'i{axis}{axis}="{mass * radius**2:.6f}"' for axis in "xyz")
            return (
                f'<inertial><origin xyz="{place}"/><mass value="{mass:.5f}"/>'
                f'<inertia {moment} ixy="0" ixz="0" iyz="0"/></inertial>'
            )

        parts = {"base": inertial(mass[0], (0.0, 0.0, 0.05), 0.06)}
        for k, name in enumerate(("thigh", "shank")):
            centre = (rng.uniform(-0.01, 0.01), 0.0, -long[k] * rng.uniform(0.3, 0.5))
            parts[name] = inertial(mass[k + 1], centre, 0.3 * long[k])
        rotors, weight = rng.uniform(0.002, 0.01, 2), 9.81 * mass.sum()
        friction = [
            np.array([share * weight, *joints])
            for share, joints in (
                (rng.uniform(0.01, 0.06), rng.uniform(0.05, 0.3, 2)),
                (rng.uniform(0.0, 0.1), rng.uniform(0.01, 0.1, 2)),
            )
        ]
        return cls(URDF.format(long=long, **parts), tuple(long), rotors, *friction, radius)

    def world(self) -> mujoco.MjModel:
        """The hopper above level ground."""
        root = etree.fromstring(self.urdf)
        etree.SubElement(etree.SubElement(root, "mujoco"), "compiler", fusestatic="false")
        collision = etree.SubElement(root.find("link[@name='foot']"), "collision")
        etree.SubElement(etree.SubElement(collision, "geometry"), "sphere", radius=str(self.radius))
        spec = mujoco.MjSpec.from_string(etree.tostring(root).decode())
        spec.option.timestep, spec.option.integrator = STEP, mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        spec.option.cone, spec.option.impratio = mujoco.mjtCone.mjCONE_ELLIPTIC, 50
        spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[10.0, 10.0, 0.1])
        spec.worldbody.first_body().add_joint(name="base_z", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[0, 0, 1])
        for geom in spec.geoms:
            geom.friction, geom.condim, geom.solref = [1.0, 0.0, 0.0], 3, [0.004, 1.0]
            geom.density = 0.0
        rotors = np.append(0.0, self.armature)
        for name, *values in zip(("base_z", "hip", "knee"), rotors, self.coulomb, self.viscous, strict=True):
            joint = spec.joint(name)
            joint.solref_friction, joint.solimp_friction = [2.0 * STEP, 1.0], [0.99, 0.999, 1e-4, 0.5, 2.0]
            joint.armature, joint.frictionloss, joint.damping = values[0], values[1], [values[2], 0.0, 0.0]
        for name in ("hip", "knee"):
            spec.add_actuator(name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        return spec.compile()


def angles(long: tuple[float, float], foot: np.ndarray) -> np.ndarray:
    """Hip and knee for places of the foot below the hip, forward and down, (N, 2); the knee points forward."""
    a, b = long
    x, down = foot.T
    knee = np.arccos(np.clip((x**2 + down**2 - a**2 - b**2) / (2.0 * a * b), -1.0, 1.0))
    return np.column_stack([np.arctan2(-x, down) - np.arctan2(b * np.sin(knee), a + b * np.cos(knee)), knee])


def reference(long: tuple[float, float], kind: str, seconds: float, rng: np.random.Generator) -> PchipInterpolator:
    """Place of the foot below the hip: "jump", or "press", which bends and stretches the leg on the ground."""
    reach = sum(long)
    if kind == "press":
        time = np.arange(0.0, seconds, 0.002)
        rates, sizes = rng.uniform([0.3, 0.9, 1.7], [0.8, 1.6, 2.4]), np.array([0.1, 0.05, 0.022])
        waves = (sizes * np.sin(2.0 * np.pi * np.outer(time, rates) + rng.uniform(0.0, 6.0, 3))).sum(axis=1)
        return PchipInterpolator(time, np.column_stack([np.zeros_like(time), reach * (0.72 + waves)]))
    knots, now = [(0.0, 0.0, 0.75), (0.3, 0.0, 0.75)], 0.3
    while now < seconds:
        low, high, aside = rng.uniform(0.5, 0.65), rng.uniform(0.9, 0.95), rng.uniform(-0.15, 0.15)
        # crouch, push, swing in the air, land, settle
        for wait, x, down in ((0.35, 0, low), (0.12, 0, high), (0.1, aside, 0.8), (0.12, 0, 0.85), (0.35, 0, 0.75)):
            now += wait
            knots.append((now, x, down))
    times, x, down = np.array(knots).T
    return PchipInterpolator(times, reach * np.column_stack([x, down]))


@dataclass(frozen=True)
class Run:
    """What MuJoCo did: coordinates, torques of hip and knee, and the force on the foot."""

    time: np.ndarray
    q: np.ndarray
    tau: np.ndarray
    force: np.ndarray
    radius: float

    def recording(self, rng: np.random.Generator, *, plate: bool) -> exoid.Recording:
        """Log of the sensors, with the force or with a foot switch."""
        q = self.q + np.array([SCALE, ENCODER, ENCODER]) * rng.standard_normal(self.q.shape)
        tau = np.hstack(
            [np.zeros((len(q), 1)), self.tau + TORQUE * self.tau.std(axis=0) * rng.standard_normal(self.tau.shape)]
        )
        force = self.force + FORCE * self.force[:, 2].std() * rng.standard_normal(self.force.shape)
        turned = q[:, 1:].sum(axis=1)
        on_link = np.column_stack(
            [
                np.cos(turned) * force[:, 0] - np.sin(turned) * force[:, 2],
                force[:, 1],
                np.sin(turned) * force[:, 0] + np.cos(turned) * force[:, 2],
            ]
        )
        lowest = self.radius * np.column_stack([np.sin(turned), 0.0 * turned, -np.cos(turned)])
        return exoid.Recording(
            self.time,
            q,
            tau=tau,
            joint_names=("base_z", "hip", "knee"),
            passive=("base_z",),
            wrenches={"foot": exoid.Wrench(on_link, np.cross(lowest, on_link))} if plate else {},
            contacts={"foot": self.force[:, 2] > PRESSED},
        )


def simulate(hopper: Hopper, kind: str, seconds: float, rng: np.random.Generator) -> Run:
    """Follow a reference by position controllers."""
    model = hopper.world()
    data, plan = mujoco.MjData(model), reference(hopper.long, kind, seconds, rng)
    weight = 9.81 * float(model.body_mass.sum())
    stiffness = 60.0 * weight * sum(hopper.long) / 2.0
    damping = 0.03 * stiffness
    foot = plan(0.0)
    data.qpos[:] = [foot[1] + hopper.radius, *angles(hopper.long, foot[np.newaxis])[0]]
    rows, wrench, every = [], np.zeros(6), round(1.0 / (RATE * STEP))
    goals = angles(hopper.long, plan(np.arange(0.0, seconds, STEP)))
    rates = np.gradient(goals, STEP, axis=0)
    angle, speed, torque = data.qpos[1:], data.qvel[1:], data.ctrl  # MuJoCo's own memory
    for k in range(-round(1.0 / STEP), len(goals)):
        now = max(k, 0)
        torque[:] = stiffness * (goals[now] - angle) + damping * ((k >= 0) * rates[now] - speed)
        if k >= 0 and k % every == 0:
            mujoco.mj_forward(model, data)
            force = np.zeros(3)
            for c, contact in enumerate(data.contact):
                mujoco.mj_contactForce(model, data, c, wrench)
                force += contact.frame.reshape(3, 3).T @ wrench[:3]
            rows.append((now * STEP, data.qpos.copy(), data.ctrl.copy(), force))
        mujoco.mj_step(model, data)
    return Run(*(np.array(column) for column in zip(*rows, strict=True)), hopper.radius)


def named_places(hopper: Hopper, beside: float, rng: np.random.Generator) -> dict[str, float]:
    """Describe the foot before, behind, above and below its place; how often is that named, with size and direction?"""
    runs = [simulate(hopper, kind, 20.0, rng) for kind in ("jump", "press")]
    sensed = {"switches": [run.recording(rng, plate=False) for run in runs]}
    sensed["force measured in squats"] = [runs[1].recording(rng, plate=True)]
    found = {}
    for sensor, logs in sensed.items():
        named = {}
        for x, z in ((0.0, 0.0), (beside, 0.0), (-beside, 0.0), (0.0, beside), (0.0, -beside)):
            text = hopper.urdf.replace(f'"0 0 -{hopper.long[1]}"', f'"{x} 0 {z - hopper.long[1]}"')
            leg = exoid.Leg.from_description(describe(text, "hopper.urdf"), base="z", contacts={"foot": "point"})
            told = exoid.identify(leg, logs, terms=TERMS).findings
            named[x, z] = [one for one in told if one.kind == "contact-place"]
        ways = {(beside, 0.0): "behind", (-beside, 0.0): "before", (0.0, beside): "below", (0.0, -beside): "above"}
        right = [
            any(way in one.message and abs(abs(one.value) - beside) < 0.2 * beside for one in named[place][:1])
            for place, way in ways.items()
        ]
        found[f"{sensor}: wrong places named [%]"] = 100.0 * float(np.mean([bool(named[place]) for place in ways]))
        found[f"{sensor}: with the right direction, and size within a fifth [%]"] = 100.0 * float(np.mean(right))
        found[f"{sensor}: right places said to be wrong [%]"] = 100.0 * bool(named[0.0, 0.0])
    return found


def figures(seed: int, radius: float = RADIUS, said: float = 0.0, beside: float = 0.0) -> dict[str, float]:
    """Figures of one seed."""
    rng = np.random.default_rng(seed)
    hopper = Hopper.drawn(rng, radius)
    if beside:
        return named_places(hopper, beside, rng)
    leg = exoid.Leg.from_description(describe(hopper.urdf, "hopper.urdf"), base="z", contacts={"foot": said or "point"})
    runs = {kind: [simulate(hopper, kind, 20.0, rng) for _ in range(2)] for kind in ("jump", "press")}
    found = {}
    for train, test in (("jump", "press"), ("press", "jump")):
        logs = [run.recording(rng, plate=True) for run in runs[train]]
        estimate = exoid.identify(leg, logs, terms=TERMS)
        other = runs[test][1]
        log = other.recording(rng, plate=False)
        force = exoid.ground_forces(estimate, log)["foot"]
        at = np.searchsorted(other.time, force.time)
        true = other.force[at, 2]
        error = force.force[:, 2] - true
        of_estimate = {
            "NRMSE of the vertical force": np.sqrt(np.mean(error**2)) / true.std(),
            "force inside the 95 % band [%]": 100.0 * np.mean(np.abs(error) < force.force_half[:, 2]),
            "samples in contact that are predicted [%]": 100.0
            * len(at)
            / np.count_nonzero(other.force[:, 2] > PRESSED),
            "total mass, error [%]": 100.0 * abs(estimate.values[0] / leg.parameters[0] - 1.0),
        }
        found |= {f"{train} to {test}: {name}": float(value) for name, value in of_estimate.items()}
    return found


if __name__ == "__main__":
    run_seeds(__doc__, figures, radius=RADIUS, said=0.0, beside=0.0)
