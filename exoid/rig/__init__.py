"""Virtual rig: simulated legs with friction, actuators, sampled controllers and sensors, one or many at once."""

from exoid.leg.payload import Payload

from .actuators import Actuator, DcMotor, HydraulicServo, IdealTorque, StepTorque
from .bodies import leg_with_payloads, limb_of, plant_with_payloads, sandbags
from .controllers import Controller, Proportional, ProportionalDerivative, Reference, Target
from .pinocchio_stepper import PinocchioStepper
from .plant import Plant
from .run import Energy, Run
from .sensors import Sensors
from .simulate import Rates, simulate
from .smooth_stepper import CoupledMotors, CoupledStepper, SmoothStepper
from .stepper import PlanarStepper
from .wearer import Wearer

__all__ = [
    "Actuator",
    "Controller",
    "CoupledMotors",
    "CoupledStepper",
    "DcMotor",
    "Energy",
    "HydraulicServo",
    "IdealTorque",
    "Payload",
    "PinocchioStepper",
    "PlanarStepper",
    "Plant",
    "Proportional",
    "ProportionalDerivative",
    "Rates",
    "Reference",
    "Run",
    "Sensors",
    "SmoothStepper",
    "StepTorque",
    "Target",
    "Wearer",
    "leg_with_payloads",
    "limb_of",
    "plant_with_payloads",
    "sandbags",
    "simulate",
]
