"""The firmware of examples/stm32, built by its Makefile and run on an emulated processor, with or without a leg."""

import shutil
import struct
import sys
from collections.abc import Collection
from pathlib import Path
from typing import NamedTuple

import numpy as np
from cortex_m import Elf, Machine
from doc_pages import ROOT, Page
from processes import run

from exoid import Estimate
from exoid.control import Limited, State, gravity_friction_pd, pd
from exoid.experiments import Hold
from exoid.rig import IdealTorque, Plant, Rates, Target, simulate

EXAMPLE = ROOT / "examples" / "stm32"
CAN1_RX0, TIM6 = 20, 54
RATE, PERIOD = 500.0, 2.0
SWING = np.array([0.5, -0.7, 0.15])
KP, KD, LIMIT, SLEW = (200.0, 150.0, 40.0), (20.0, 15.0, 4.0), (60.0, 60.0, 30.0), 2000.0
ALL = (0, 1, 2)


class Step(NamedTuple):
    """What one step received and sent.

    Attributes:
        q: Angles of the encoders' frames [rad], (3,).
        v: Velocities likewise [rad/s], (3,).
        current: Currents of the frames to the drives [A], (3,).
        instructions: Instructions of the timer's interrupt, if they are counted.
    """

    q: np.ndarray
    v: np.ndarray
    current: np.ndarray
    instructions: int


class Firmware:
    """The program after a reset, with encoders, drives and a button."""

    def __init__(self, elf: Elf, *, count: bool = False) -> None:
        self.machine = Machine(elf, count=count)
        self.counter = 0
        self.machine.boot()

    @property
    def fed(self) -> int:
        """How often the watchdog was fed."""
        return int(self.machine.read("stub_fed_count", np.uint32)[0])

    def press(self, down: bool) -> None:
        """Press the button or release it."""
        self.machine.write("stub_gpioc", np.uint32([0 if down else 0x2000]))

    def set(self, variable: str, value: int) -> None:
        """Set a fault of the stubs."""
        self.machine.write(variable, np.uint32([value]))

    def step(self, q: np.ndarray, v: np.ndarray, *, reports: Collection[int] = ALL, hangs: bool = False) -> Step:
        """Let some encoders send their frames, then the timer overflow; an encoder that hangs repeats its counter."""
        self.counter = (self.counter + (not hangs)) % 256
        counts, velocities = np.rint(q * 65536 / (2 * np.pi)).astype(int), np.rint(1000.0 * v).astype(int)
        for j in reports:
            data = struct.pack("<ihBx", counts[j], velocities[j], self.counter)
            self.machine.write("stub_received", np.frombuffer(struct.pack("<II8s", 0x100 + j, 7, data), np.uint8))
            self.machine.interrupt(CAN1_RX0)
        instructions = self.machine.interrupt(TIM6)
        return Step(counts * 2 * np.pi / 65536, 0.001 * velocities, self._sent(), instructions)

    def _sent(self) -> np.ndarray:
        """Currents of the last three frames."""
        frame = np.dtype([("id", "<u4"), ("bytes", "<u4"), ("data", ">i4"), ("unused", "4B")])
        frames = self.machine.read("stub_sent", frame)
        assert frames["id"].tolist() in ([0x101, 0x102, 0x103], [0, 0, 0])
        return frames["data"] / 1000.0


class InTheLoop:
    """The firmware as controller of a simulated leg: the button is pressed once, then the leg follows its motion."""

    def __init__(self, firmware: Firmware, estimate: Estimate) -> None:
        self.firmware, self.estimate, self.steps = firmware, estimate, list[Step]()

    def command(self, target: Target, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        self.firmware.press(len(self.steps) == 10)
        self.steps.append(self.firmware.step(q[:, 0], v[:, 0]))
        return self.estimate.actuators.torque_of(self.steps[-1].current[None], q.T, v.T).T

    def run(self, seconds: float) -> list[Step]:
        """Simulate the leg of the estimate, which hangs at first."""
        known = {name: value for name, value in zip(self.estimate.names, self.estimate.values, strict=True)
                 if name.startswith(("X", "Y", "J", "c0", "d_"))}  # fmt: skip
        plant = Plant.build(self.estimate.leg, known)
        simulate(plant, Hold(np.zeros((3, 1))), self, IdealTorque(), seconds, rates=Rates(RATE, RATE))
        return self.steps


class LawInPython:
    """Currents of the law in Python, step by step; each begins at the torque of the last."""

    def __init__(self, estimate: Estimate) -> None:
        self.actuators, self.last = estimate.actuators, np.zeros(3)
        laws = {"law": gravity_friction_pd(estimate, KP, KD, rate=RATE), "damping": pd(0.0, KD, rate=RATE),
                "zero": pd(0.0, 0.0, rate=RATE)}  # fmt: skip
        self.laws = {name: Limited(law, LIMIT, SLEW) for name, law in laws.items()}

    def current(self, kind: str, step: Step, target: Target) -> np.ndarray:
        """Currents of the law or of its safe torque [A], (3,)."""
        law, state = self.laws[kind], State(step.q, step.v, 0.0, self.last)
        self.last = law.step(law.begin(state), state, target)[0]
        return self.actuators.command(self.last[None], step.q[None], step.v[None])[0]


def motion(start: np.ndarray, step: int) -> Target:
    """Reference of main.c, so many steps after its beginning."""
    w = 2 * np.pi / PERIOD
    phase = w * step / RATE
    return Target(start + 0.5 * SWING * (1.0 - np.cos(phase)), 0.5 * SWING * w * np.sin(phase))


def build(folder: Path) -> tuple[Elf, Estimate]:
    """Do what the README of the example says, with Zig's compiler."""
    copy = folder / "stm32"
    shutil.copytree(EXAMPLE, copy)
    Page.read("examples/stm32/README.md").run(copy)
    run("make", "zig", f"PYTHON={sys.executable}", cwd=copy)
    return Elf.read(copy / "leg.elf"), Estimate.load(copy / "est.json")


def measured(elf: Elf, estimate: Estimate) -> list[str]:
    """What the program takes, in lines; the largest step comes early, where the leg accelerates."""
    firmware = Firmware(elf, count=True)
    taken = [step.instructions for step in InTheLoop(firmware, estimate).run(0.6)]
    own = firmware.machine.instructions("law_") / len(taken)
    return [
        f"flash: {elf.flash} bytes of code and constants",
        f"RAM:   {elf.ram} bytes of variables, {firmware.machine.stack} bytes of stack",
        f"step:  {max(taken)} instructions at most, {np.mean(taken):.0f} on average, {own:.0f} of them in law.c",
    ]
