"""Legs, plants and estimates that the tests of control share."""

from functools import cache

import numpy as np
import pinocchio as pin
from made_estimates import made

import exoid
from exoid import published
from exoid.estimate import Estimate
from exoid.rig import Plant, Target
from exoid.signals import ZeroPhase
from exoid.torques import Armature, Coulomb, Offset, Stiffness, TorqueModel, Viscous

LEG = exoid.load_leg("cuhk")
TERMS = (Stiffness(degree=1, joints=("knee",)), Coulomb(), Viscous(), Armature(), Offset(joints=("hip",)))
ROTOR = 0.8


def cuhk_plant(rotor: float = ROTOR, *, end_stops: bool = True, **changes: float) -> Plant:
    """The CUHK-EXO of the documents' assumptions."""
    values = {**published.cuhk_parameters(), **published.cuhk_resistances()}
    values |= {"Ia_hip": rotor, "Ia_knee": rotor}
    return Plant.build(LEG, {**values, **changes}, end_stops=end_stops)


def frictionless(plant: Plant) -> Plant:
    still = np.zeros_like(plant.coulomb)
    return Plant(**{**{f: getattr(plant, f) for f in plant.__dataclass_fields__}, "coulomb": still, "static": still})


def estimate_of(model: TorqueModel, values: dict[str, float]) -> Estimate:
    """An estimate of these values, as if identified."""
    every = np.array([values.get(name, 0.0) for name in model.names])
    return made(model, every, 1e-6 * np.eye(len(every)), preparation=ZeroPhase(3.0))


@cache
def exact_estimate(rotor: float = ROTOR) -> Estimate:
    """The truth of :func:`cuhk_plant` as an estimate; the rotor of the hip is part of J1."""
    values = {**published.cuhk_parameters(), **published.cuhk_resistances(), "Ia_knee": rotor}
    values["J1"] += rotor
    return estimate_of(TorqueModel(LEG, TERMS), values)


def true_torque(plant: Plant, q, v, a):
    """Pinocchio's RNEA and the plant's springs, rotors and smooth friction, one sample, written out."""
    leg = plant.leg.with_parameters(plant.parameters[:, 0])
    b2, b1, b0 = plant.stiffness[..., 0]
    rigid = pin.rnea(leg.model, leg.model.createData(), q, v, a) + plant.armature[:, 0] * a
    return rigid + b2 * q**2 + b1 * q + b0 + plant.viscous[:, 0] * v


def random_target(seed=0, n=2):
    q, v, a = np.random.default_rng(seed).uniform(-1.0, 1.0, (3, n))
    return Target(q, v, a)
