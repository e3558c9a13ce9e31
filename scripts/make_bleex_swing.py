"""Record two swings of a virtual BLEEX leg: the example logs that come with the package.

The left leg of Tables II-III with the friction of Table IV (hip: an assumed 0.5 N·m) hangs from a fixed torso. A PD
controller follows five-harmonic motions; encoders of 2^16 counts a turn and torque sensors with noise are logged at
100 Hz. The log starts and ends mid-motion, as real ones do.

Run: python scripts/make_bleex_swing.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
from scipy.integrate import solve_ivp

import exoid
from exoid import published

FOLDER = Path(__file__).resolve().parents[1] / "exoid" / "datasets"
RATE = 100.0
"""Of the log [Hz]."""
ENCODER_COUNT = 2.0 * np.pi / 2**16
"""[rad]."""
TORQUE_NOISE = np.array([0.3, 0.2, 0.1])
"""Standard deviation at hip, knee and ankle [N·m]."""
COULOMB = np.array([0.5, *(published.bleex_resistances("left")[f"c0_{joint}"] for joint in ("knee", "ankle"))])
"""[N·m]."""
VISCOUS = np.array([0.3, 0.2, 0.1])
"""Assumed; the documents found too little to measure [N·m·s/rad]."""
STICK_SLIP = 0.01
"""Velocity over which friction changes its sign [rad/s]."""
CENTRE = np.deg2rad([40.0, -55.0, 0.0])
AMPLITUDE = np.deg2rad([24.0, 26.0, 22.0])
STIFFNESS, DAMPING = np.array([600.0, 300.0, 80.0]), np.array([30.0, 12.0, 2.0])
HARMONICS = 2.0 * np.pi * 0.15 * np.arange(1, 6)


def reference(t: float, amplitude: np.ndarray, phase: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Angles [rad] and velocities [rad/s] of the motion to follow; amplitude and phase are (3, 5)."""
    argument = HARMONICS * t + phase
    return CENTRE + (amplitude * np.sin(argument)).sum(1), (amplitude * HARMONICS * np.cos(argument)).sum(1)


def record(seed: int, duration: float) -> exoid.Recording:
    """Simulate one motion and log it."""
    rng = np.random.default_rng(seed)
    leg = exoid.load_leg("bleex", side="left", inertias="identified")
    data = leg.model.createData()
    amplitude = AMPLITUDE[:, None] * rng.uniform(0.4, 1.0, (3, 5)) / np.array([1.0, 1.2, 1.5, 2.0, 2.5])
    phase = rng.uniform(0.0, 2.0 * np.pi, (3, 5))

    def actuator(t: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        wanted, rate = reference(t, amplitude, phase)
        return STIFFNESS * (wanted - q) + DAMPING * (rate - v)

    def motion(t: float, state: np.ndarray) -> np.ndarray:
        q, v = state[:3], state[3:]
        friction = COULOMB * np.tanh(v / STICK_SLIP) + VISCOUS * v
        return np.concatenate([v, pin.aba(leg.model, data, q, v, actuator(t, q, v) - friction)])

    stamps = 1.0 + np.arange(int(duration * RATE)) / RATE
    start = np.concatenate(reference(0.0, amplitude, phase))
    run = solve_ivp(motion, (0.0, stamps[-1]), start, t_eval=stamps, rtol=1e-8, atol=1e-10, max_step=5e-3)
    q, v = run.y[:3].T, run.y[3:].T
    torque = np.array([actuator(*row) for row in zip(stamps, q, v, strict=True)])
    return exoid.Recording(
        time=np.round(stamps - stamps[0], 6),
        q=np.round(np.round(q / ENCODER_COUNT) * ENCODER_COUNT, 7),
        tau=np.round(torque + rng.normal(scale=TORQUE_NOISE, size=torque.shape), 3),
        joint_names=leg.joint_names,
    )


if __name__ == "__main__":
    record(seed=1, duration=30.0).to_csv(FOLDER / "bleex_swing.csv")
    record(seed=2, duration=15.0).to_csv(FOLDER / "bleex_swing_test.csv")
