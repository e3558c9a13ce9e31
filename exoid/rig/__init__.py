"""A virtual rig: the truth, actuators and sensors of exoskeleton legs on a jig, to try experiments on."""

from .actuators import Actuator, DcMotor, Drive, HydraulicServo, IdealTorque
from .controllers import Controller, Proportional, ProportionalDerivative, Reference, Target
from .payload import Payload, load_leg_with, load_plant, sandbags
from .pinocchio_stepper import PinocchioStepper
from .plant import Plant
from .sensors import Sensors
from .simulate import Energy, Rates, Run, simulate
from .smooth_stepper import SmoothStepper
from .stepper import PlanarStepper, Step, Stepper

__all__ = [
    "Actuator",
    "Controller",
    "DcMotor",
    "Drive",
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
    "Step",
    "Stepper",
    "Target",
    "load_leg_with",
    "load_plant",
    "sandbags",
    "simulate",
]
