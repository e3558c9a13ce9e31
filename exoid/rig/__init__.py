"""Virtual rig: simulated legs with friction, actuators, sampled controllers and sensors, one or many at once."""

from exoid.leg.payload import Payload

from .actuators import Actuator, HydraulicServo, IdealTorque, StepTorque
from .bodies import limb_of, plant_with_payloads
from .controllers import Controller, ProportionalDerivative, Reference, Target
from .plant import Plant
from .run import Energy, Run
from .sensors import Sensors
from .simulate import Rates, simulate
from .stepper import Stepper
from .wearer import Wearer

__all__ = [
    "Actuator",
    "Controller",
    "Energy",
    "HydraulicServo",
    "IdealTorque",
    "Payload",
    "Plant",
    "ProportionalDerivative",
    "Rates",
    "Reference",
    "Run",
    "Sensors",
    "StepTorque",
    "Stepper",
    "Target",
    "Wearer",
    "limb_of",
    "plant_with_payloads",
    "simulate",
]
