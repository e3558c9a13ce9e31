"""The closed loop without switches on the rig, with a hand on a rail."""

import numpy as np

from exoid.control.functions import FUNCTIONS, Body, joint_angles
from exoid.control.ground import ContactFilter, CoordinatedLoop, Coordinator, stance
from exoid.experiments.ground.stance import HAND_RAIL
from exoid.lab.coordination import study
from exoid.rig import Rates
from exoid.rig.ground import GroundMotion, GroundSensors, simulate_on_ground
from exoid.torques.model import TorqueModel

RATES, SENSORS = Rates(500.0, 500.0, 1e-3), GroundSensors(angle_noise=3e-5)


def loop_of(plant, requests, start="stand", rate=500.0):
    functions = {name: make(Body.of(plant.leg, plant.soles)) for name, make in FUNCTIONS.items()}
    model = TorqueModel(plant.leg, study.TERMS)
    values = np.array([plant.values[name] for name in model.names])
    told = ContactFilter(model, values, np.diag((0.01 * values) ** 2), plant.soles, np.zeros(3), rate)
    coordinator = Coordinator(functions, plant.leg.limits.effort, rate=500.0)
    return CoordinatedLoop(stance(plant), told, coordinator, requests, start)


def run_of(plant, loop, name, begin, seconds, wearer, **options):
    """The rail follows the plan of a function that begins at a time."""
    function = loop.coordinator.functions[name]
    time = np.arange(begin - 0.3, begin + seconds, 0.01)
    rows = np.round(200.0 * np.clip((time - begin) / function.duration, 0.0, 1.0)).astype(int)
    q = joint_angles(plant.leg, function.flexion[rows])
    motion = GroundMotion(time, q, np.zeros_like(q), function.torso[rows])
    return simulate_on_ground(
        plant, motion, loop, rates=RATES, sensors=SENSORS, spring=HAND_RAIL, wearer=wearer, seed=3, **options
    )
