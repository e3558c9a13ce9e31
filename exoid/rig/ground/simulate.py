"""Simulation of a machine on the ground: MuJoCo in small steps, a controller, true motion and wrenches."""

from __future__ import annotations

import numpy as np

from exoid.errors import ExoidError
from exoid.rig.simulate import DIVERGED_SPEED, Rates

from .engine import Engine
from .holder import hold
from .ledger import Ledger
from .motion import GroundMotion, JointGains, Spring
from .plant import GroundPlant
from .run import GroundRun
from .samples import Samples

STEP = 5e-4
"""Default step [s]."""

RATES = Rates(control=2000.0, log=500.0, step=STEP)
"""Default rates: the controller acts at every step, so that torque and motion of a sample are of one time."""


def simulate_on_ground(
    plant: GroundPlant,
    motion: GroundMotion,
    gains: JointGains,
    *,
    rail: bool = False,
    spring: Spring | None = None,
    rates: Rates = RATES,
) -> GroundRun:
    """Let a machine follow a motion on flat ground.

    MuJoCo computes bodies and contact. Each step is semi-implicit: v⁺ = v + dt a, q⁺ = q + dt v⁺. The acceleration a of
    a sample obeys the equation of motion with the q, v, torque and wrenches of that sample, and is the second
    difference of q. The controller reads exact angles. The same input gives the same bytes.

    Args:
        plant: The machine.
        motion: Reference that begins before time zero, or at it. Its first pose, at rest, is the start; its last time
            ends the run.
        gains: Gains of the joints.
        rail: Whether a vertical rail holds the torso, which then does not move forward and does not pitch.
        spring: Spring and damper that hold the torso, whose carriage moves as ``motion.base``; None for none.
        rates: Rates of controller and log, and step of the simulation.

    Returns:
        True motion, torque and wrenches at the rate of the log, with an audit of energy and momentum.

    Raises:
        ExoidError: MuJoCo is not installed, rates do not fit, a rail and a spring hold the torso, the motion is too
            short, or the machine diverges.
    """
    if rail and spring is not None:
        raise ExoidError("a rail and a spring hold the torso", remedy="choose one of both")
    every_control, every_log = rates.steps()
    first, last = (round(float(t) / rates.step) for t in motion.time[[0, -1]])
    if first > 0 or last < 1:
        raise ExoidError(
            f"the reference is from {motion.time[0]:g} to {motion.time[-1]:g} s",
            remedy="begin at zero or before, and end after zero",
        )
    targets = motion.at(rates.step * np.arange(first, last + 1, dtype=np.float64))
    engine = Engine(plant, rates.step, rail=rail)
    engine.place(targets.q[0], targets.base[0])
    holder = hold(engine, spring, targets) if spring is not None else None
    limit, (stiffness, damping) = plant.leg.limits.effort, gains.arrays(len(engine.q))
    ledger, samples, torque = Ledger(engine, last), Samples(engine, holder), np.zeros(len(engine.q))
    for k in range(last - first + 1):
        now = k + first
        engine.begin()
        q, v = engine.q, engine.v
        if k % every_control == 0:
            command = targets.torque[k] + stiffness * (targets.q[k] - q) + damping * (targets.v[k] - v)
            torque = np.clip(command, -limit, limit)
        applied = engine.applied
        applied[engine.base :] = torque - plant.resistance(q, v)
        applied[: engine.base] = 0.0
        held = None if holder is None else holder.force(k)
        if held is not None:
            applied += held
        logs = now >= 0 and now % every_log == 0
        if now >= 0:
            ledger.begin(now)
            samples.begin_step()
        if logs:
            samples.begin()
        engine.finish()
        if now >= 0:
            ledger.finish(now, torque, held)
            samples.finish_step()
        if logs:
            samples.finish(now * rates.step, torque)
        if not engine.rate @ engine.rate < DIVERGED_SPEED**2:
            raise ExoidError(
                f"the machine diverged before {now * rates.step:.3g} s",
                remedy="lower the gains, slow the motion, or shorten the step",
            )
    return samples.run(ledger.audit(rates.step))
