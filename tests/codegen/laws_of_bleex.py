"""Laws of a BLEEX leg with many terms, for tests of their C."""

from dataclasses import replace
from functools import cache

import numpy as np
from compiled import made_up

import exoid
from exoid import Armature, Coulomb, Offset, Stiffness, Viscous
from exoid.control import (
    PASSIVE,
    SHARP,
    ControlModel,
    FrictionCompensation,
    Limited,
    State,
    computed_torque,
    feedforward_pd,
    gravity_friction_pd,
    gravity_support,
    impedance,
    lqr,
    mean_pose,
    pd,
    sensitivity_amplification,
    stateful,
)
from exoid.control.observers import MomentumObserver, SensorNoise
from exoid.experiments import gait_for_leg, healthy_gait
from exoid.rig import Target
from exoid.torques import CouplingSpring, Stribeck

KP, KD = np.array([80.0, 60.0, 20.0]), np.array([8.0, 6.0, 2.0])
LIMIT, SLEW = np.array([150.0, 125.0, 90.0]), np.array([4000.0, 3000.0, 2000.0])
PERIOD = 2.0

TERMS = (
    Stiffness(degree=3, joints=("knee",)),
    Offset(joints=("ankle",)),
    Coulomb(),
    Viscous(),
    Armature(),
    Stribeck(joints=("ankle",)),
    CouplingSpring(joints=("knee", "hip"), ratios=(1.0, -0.6)),
)


@cache
def model() -> ControlModel:
    """A leg with springs, couplings and Stribeck friction."""
    leg = exoid.load_leg("bleex", inertias="identified")
    estimate = made_up(leg, TERMS, seed=3)
    own = len(leg.parameter_names)
    values = np.concatenate([leg.parameters, 0.3 * np.abs(estimate.values[own:])])  # friction that resists
    return ControlModel.of(made_up(leg, TERMS, values=values, covariance=np.diag((0.1 * values) ** 2)))


@cache
def laws() -> dict[str, object]:
    """Every law that has a form in C, with several ways to compensate friction."""
    source = model()
    return {
        "pd": Limited(pd(KP, KD), LIMIT),
        "gravity_friction_pd": Limited(gravity_friction_pd(source, KP, KD), LIMIT, SLEW),
        "gravity_only": gravity_friction_pd(source, KP, 0.0, friction=None, rate=200.0),
        "feedforward_pd": feedforward_pd(source, KP, KD, friction=FrictionCompensation("desired", 0.03, 0.7)),
        "computed_torque": Limited(computed_torque(source, 25.0, 10.0, friction=SHARP), slew=SLEW),
        "gravity_support": Limited(gravity_support(source, (1.0, 0.6, 0.3), friction=PASSIVE), LIMIT),
        "sensitivity_amplification": sensitivity_amplification(source, (2.0, 4.0, 1.5), bandwidth=12.0, rate=200.0),
        "impedance": impedance(source, KP, KD),
        "lqr": lqr(source, mean_pose(gait(), PERIOD)),
        "passive_ankle": computed_torque(replace(source, passive=("left_ankle",)), 25.0, 10.0),
    }


def gait():
    """A gait within the limits of the leg."""
    return gait_for_leg(model().leg, healthy_gait(0.8, PERIOD))


@cache
def observer() -> MomentumObserver:
    """The observer, with measured velocities."""
    return MomentumObserver(model(), 8.0, 200.0, noise=SensorNoise(0.05, 0.05), torque_delay=0.0)


def random_values(count: int, seed: int = 0) -> dict[str, np.ndarray]:
    """States and targets within and beyond what a leg does, float numbers exactly."""
    rng = np.random.default_rng(seed)
    q, q_d = rng.uniform(-1.5, 1.5, (2, count, 3))
    v, v_d = rng.normal(0.0, 3.0, (2, count, 3))
    v[::7, 0], v_d[::5, 1] = 0.0, 0.0
    values = {"q": q, "v": v, "q_d": q_d, "v_d": v_d, "a_d": rng.normal(0.0, 20.0, (count, 3))}
    values |= {"interaction": rng.normal(0.0, 10.0, (count, 3))}
    values["tau_m"] = values["interaction"]
    return {name: x.astype(np.float32).astype(np.float64) for name, x in values.items()}


def torques_in_python(law: object, values: dict[str, np.ndarray], *, last: np.ndarray | None = None) -> np.ndarray:
    """A law in Python, sample by sample; the torque before the first one is zero, as in C."""
    steps, found = stateful(law), []
    pushed = values.get("interaction", np.zeros_like(values["q"]))
    columns = (values[name] for name in ("q", "v", "q_d", "v_d", "a_d"))
    last, memory = np.zeros(3) if last is None else last, steps.begin(State(values["q"][0], values["v"][0]))
    for q, v, q_d, v_d, a_d, interaction in zip(*columns, pushed, strict=True):
        last, memory = steps.step(memory, State(q, v, 0.0, last, interaction), Target(q_d, v_d, a_d))
        found.append(last)
    return np.array(found)
