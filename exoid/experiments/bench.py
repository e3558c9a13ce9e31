"""Everything of a rig but its legs."""

from __future__ import annotations

from dataclasses import dataclass

from exoid.rig import Actuator, Controller, Rates, Sensors


@dataclass(frozen=True)
class Bench:
    """How rigs are driven, measured and timed.

    Attributes:
        controller: Of the joints.
        actuator: Behind each command.
        sensors: In front of each log.
        rates: Of controller, log and plant.
    """

    controller: Controller
    actuator: Actuator
    sensors: Sensors
    rates: Rates
