"""A worn CUHK-EXO that the tests of laws for wearers share: hardware as the leg, a wearer of 1.70 m and 65 kg in it."""

import numpy as np
from controlled_legs import LEG

from exoid.experiments import healthy_gait
from exoid.rig import Plant, Wearer, limb_of

GAIT = healthy_gait(1.0, 1.2)
LIMB = limb_of(LEG, 1.70, 65.0)
HARDWARE = LEG.with_parameters(LEG.parameters - LIMB.parameters)
FRICTION = {"c0_hip": 1.4, "c0_knee": 0.6, "d_hip": 0.1, "d_knee": 0.2}
ROTORS = {"Ia_hip": 0.1, "Ia_knee": 0.1}
SMOOTH = Plant.build(HARDWARE, ROTORS, end_stops=False)
RUBBING = Plant.build(HARDWARE, {**ROTORS, **FRICTION})
WALKING = Wearer(LIMB, muscle_stiffness=100.0, muscle_damping=5.0, intention=GAIT)


def dynamic_torque(plant: Plant, q, v, a):
    """M a + C v of the bodies and rotors, (N, n)."""
    leg = plant.leg.with_parameters(plant.parameters[:, 0])
    return leg.inverse_dynamics(q, v, a) - leg.gravity(q) + a * plant.armature[:, 0]


def accelerations(run):
    """Derivative of the true velocities by central differences, (N, n)."""
    return np.gradient(run.v, run.time, axis=0)
