"""The loop in which a recording was made: what is needed to simulate it with a model."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError, NotSupportedError
from exoid.rig import (
    Actuator,
    Controller,
    IdealTorque,
    PlanarStepper,
    Plant,
    Rates,
    Reference,
    SmoothStepper,
    Target,
    simulate,
)
from exoid.signals import Recording
from exoid.torques import Armature, Coulomb, Offset, Stiffness, Term, TorqueModel, Viscous
from exoid.torques.term import number
from exoid.torques.terms import DryFriction

DISSIPATIVE: dict[type[Term], str] = {Coulomb: "c0", Viscous: "d", Armature: "Ia"}
"""Symbols of parameters that are kept from being negative: no simulation runs on friction that feeds energy in."""

SPRINGS: dict[type[Term], dict[str, int]] = {Stiffness: {"b2": 0, "b1": 1, "b0": 2}, Offset: {"offset": 2}}
"""Rows of a plant's stiffness; an offset of the torque is a spring of constant torque."""


class Simulated(NamedTuple):
    """Motion and torque of B models at the stamps of a recording, (N, n, B) each."""

    q: FloatArray  # angles [rad]
    tau: FloatArray  # actuator torques [N·m]


@dataclass(frozen=True)
class ClosedLoop:
    """Controller, reference and actuator of a recording; its stamps are times of the reference.

    Attributes:
        controller: Controller; it receives angles and velocities without noise.
        reference: Reference trajectory.
        actuator: Actuator between command and torque.
        control_rate: Rate of a sampled controller [Hz]; None for one that is much faster than the log.
        step: Largest step of the simulation [s]; shortened to a whole part of the log's interval.
        lead: The simulation starts on the reference so long before the recording [s], for its transient to die out.
    """

    controller: Controller
    reference: Reference
    actuator: Actuator = IdealTorque()  # noqa: RUF009 - frozen
    control_rate: float | None = None
    step: float = 2e-3
    lead: float = 2.0

    def __post_init__(self) -> None:
        """Check the numbers."""
        rate = 1.0 if self.control_rate is None else self.control_rate
        if not (0.0 < self.step < math.inf and 0.0 <= self.lead < math.inf and 0.0 < rate < math.inf):
            raise BadArgumentError(
                f"a loop with step {self.step}, lead {self.lead} and control rate {self.control_rate}",
                remedy="give step and lead in seconds, the rate in Hz",
            )

    def simulate(self, model: TorqueModel, values: FloatArray, recording: Recording) -> Simulated:
        """Simulate B models as the recording was made.

        Args:
            model: A planar leg and terms that the rig knows.
            values: β of each, (P, B).
            recording: With even stamps.

        Returns:
            Angles and torques at the stamps.

        Raises:
            ExoidError: The rig knows no such term, or a run diverges.
        """
        plant, stepper = as_plant(model, values, recording)
        interval = 1.0 / recording.sample_rate
        every = math.ceil(interval / self.step - 1e-9)
        lead = math.ceil(self.lead / interval - 1e-9)
        start = float(recording.time[0]) - lead * interval
        rates = Rates(self.control_rate or np.inf, recording.sample_rate, interval / every)
        duration = (lead + len(recording) - 1) * interval
        reference = _Later(self.reference, start)
        run = simulate(plant, reference, self.controller, self.actuator, duration, rates=rates, stepper=stepper)
        return Simulated(run.q[lead:], run.tau[lead:])


class _Later(NamedTuple):
    """A reference whose time starts later."""

    reference: Reference
    start: float

    def at(self, time: float) -> Target:
        """Return the target at a time [s] of the recording."""
        return self.reference.at(self.start + time)


def as_plant(
    model: TorqueModel, values: FloatArray, recording: Recording
) -> tuple[Plant, type[PlanarStepper] | partial[SmoothStepper]]:
    """Build the rigs of B models, and choose how friction is simulated: smooth, or such that joints stick."""
    leg, count, rigid = model.leg, values.shape[1], len(model.leg.parameter_names)
    shape = (len(model.leg.joint_labels), values.shape[1])
    stiffness, arrays = np.zeros((3, *shape)), {symbol: np.zeros(shape) for symbol in DISSIPATIVE.values()}
    rows = dict(zip(model.names[rigid:], values[rigid:], strict=True))
    for block in model.blocks:
        kind = type(block.term)  # by its type: another one may mean another thing by the same symbol
        for symbol, name in zip(block.term.symbols, block.names, strict=True):
            if name not in rows:
                continue
            if symbol in SPRINGS.get(kind, {}):
                stiffness[SPRINGS[kind][symbol], block.joints[0]] += rows[name]
            elif DISSIPATIVE.get(kind) == symbol:
                arrays[symbol][block.joints[0]] += np.maximum(rows[name], 0.0)
            else:
                raise NotSupportedError(
                    f"no rig has the parameter {name}", remedy="use terms that can be simulated, or wls"
                )
    pitch = 0.0 if recording.torso is None else float(np.asarray(recording.torso.pitch).flat[0])
    plant = Plant(
        leg=leg,
        parameters=np.array(values[:rigid]),
        stiffness=stiffness,
        coulomb=arrays["c0"],
        static=arrays["c0"],
        viscous=arrays["d"],
        armature=arrays["Ia"],
        pitch=np.full(count, pitch),
        lower=np.full(shape, -np.inf),
        upper=np.full(shape, np.inf),
    )
    widths = {number(term.smoothing) for term in model.terms if isinstance(term, DryFriction)}
    if len(widths) > 1:
        raise NotSupportedError(
            "Coulomb friction of different smoothing cannot be simulated", remedy="use one for all joints"
        )
    width = widths.pop() if widths else 0.0
    return plant, partial(SmoothStepper, smoothing=width) if width > 0.0 else PlanarStepper
