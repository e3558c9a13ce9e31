"""Logs of a virtual BLEEX that swings, stands and walks."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from exoid._typing import FloatArray
from exoid.experiments.ground import Stance, bleex_machine, single_support, squats_and_shifts, swing, walking
from exoid.rig.ground import GroundPlant, GroundRun, GroundSensors
from exoid.signals import BaseMotion, Recording
from exoid.tools.numbers import checked

SENSORS = GroundSensors()
"""Noise: angles 1e-4 rad; torques 0.5, 0.4 and 0.2 N·m; plates 3 N and 0.3 N·m; IMU 0.05 m/s² and 0.005 rad/s."""

GYRO_BIAS, FORCE_BIAS = 0.01, 0.1
"""Standard deviations of the unknown biases of the IMU [rad/s, m/s²], which are those of all logs of a session."""

WRONG = 0.05
"""Share of the samples of stance at which a foot switch is open by mistake."""

ON_ONE_FOOT = Stance(squat=0.03, shift=0.01, bow=0.05, swing=0.22)
"""Motion on one foot: for no seed from 0 to 15 the other foot comes near the ground."""

STANCE = ("squats", "left", "right")
"""Motions on the ground: squats on both feet, and each foot alone."""


@dataclass(frozen=True)
class StanceExtent:
    """Durations of the logs [s].

    Attributes:
        stance: Squats, and single support on each leg.
        swing: Both legs swing while a stand holds the torso.
        unseen: Motions on which the ground force is predicted.
        walking: Walking in a harness.

    Raises:
        ExoidError: A log is shorter than 3 s.
    """

    stance: float = 15.0
    swing: float = 15.0
    unseen: float = 8.0
    walking: float = 80.0

    def __post_init__(self) -> None:
        """Check the durations."""
        for name in ("stance", "swing", "unseen", "walking"):
            checked(getattr(self, name), f"the seconds of {name}", least=3.0)


@dataclass(frozen=True, eq=False)
class StanceRuns:
    """Runs of the virtual BLEEX."""

    plant: GroundPlant  # the machine
    # runs by the name of the motion: "squats", "left", "right", "swing", "walking", "unseen squats", "unseen
    # left" and "slipping squats"
    runs: Mapping[str, GroundRun]
    bias: FloatArray  # bias of the IMU in all logs, of angular velocity [rad/s] and specific force [m/s²], (6,)
    seed: int  # seed of phases, bias and noise

    def log(self, motion: str, *, plates: bool = False, wrong: float = 0.0, held: bool = True) -> Recording:
        """Read the sensors."""
        # The same motion on other ground has the same noise, so that the ground alone makes a difference.
        run, number = self.runs[motion], list(self.runs).index({"slipping squats": "squats"}.get(motion, motion))
        # Link that hand rail, harness and stand hold.
        logged = [link for link in run.wrenches if (held if link == "torso" else plates)]
        recording = run.recording(SENSORS, np.random.default_rng([self.seed, number]), wrenches=logged)
        base = recording.base
        assert base is not None
        moved = BaseMotion(
            base.angular_velocity + self.bias[:3], base.specific_force + self.bias[3:], base.position, pose=base.pose
        )
        if wrong:
            again = run.recording(replace(SENSORS, mislabelled=wrong), np.random.default_rng([self.seed, number]))
            contacts = {link: again.contacts.get(link, flags) for link, flags in recording.contacts.items()}
            recording = replace(recording, contacts=contacts)
        return replace(recording, base=moved)

    def stance(self, *, plates: bool = False, wrong: float = 0.0) -> list[Recording]:
        """Read the sensors of all motions on the ground, see :meth:`log`."""
        return [self.log(motion, plates=plates, wrong=wrong) for motion in STANCE]


def run_stance(
    seed: int = 0, extent: StanceExtent | None = None, report: Callable[[float], None] | None = None
) -> StanceRuns:
    """Run all motions.

    Args:
        seed: Seed of phases, bias and noise.
        extent: Durations; None for the default ones.
        report: Function that receives the completed share, 0 to 1.

    Returns:
        The runs.

    Raises:
        ExoidError: MuJoCo is not installed.
    """
    extent, report = extent or StanceExtent(), report or (lambda _: None)
    plant, first = bleex_machine(), 10 * seed
    motions: dict[str, Callable[[], GroundRun]] = {
        "squats": lambda: squats_and_shifts(plant, extent.stance, seed=first),
        "left": lambda: single_support(plant, extent.stance, standing=0, stance=ON_ONE_FOOT, seed=first + 1),
        "right": lambda: single_support(plant, extent.stance, standing=1, stance=ON_ONE_FOOT, seed=first + 2),
        "swing": lambda: swing(plant, extent.swing, scale=0.85, seed=first + 3),
        "unseen squats": lambda: squats_and_shifts(plant, extent.unseen, seed=first + 4),
        "unseen left": lambda: single_support(plant, extent.unseen, standing=0, stance=ON_ONE_FOOT, seed=first + 5),
        # Friction of a ground on which feet slip for about 5 % of the time.
        "slipping squats": lambda: squats_and_shifts(bleex_machine(ground_friction=0.022), extent.stance, seed=first),
        "walking": lambda: walking(plant, extent.walking),
    }
    runs = {}
    for k, (name, run) in enumerate(motions.items()):
        runs[name] = run()
        report((k + 1) / len(motions))
    sizes = np.repeat([GYRO_BIAS, FORCE_BIAS], 3)
    return StanceRuns(plant, runs, sizes * np.random.default_rng([seed, 99]).standard_normal(6), seed)
