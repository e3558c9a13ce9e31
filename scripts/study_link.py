"""How much does a lossy 30 Hz link between planner and controller cost? Figures of docs/control.md.

    python scripts/study_link.py                # 4 seeds, two minutes

Document 2 sends its reference at 30 Hz over a serial line. Here a packet holds the angles and the time at which it was
sent. It takes 10 ms and a random time (8 ms in the mean), packets keep their order, 2 % are late by another 100 ms, and
5 % are lost. The receiver lags by a fixed delay and interpolates between the packets that it has. Where they end it
goes on with their last velocity, and stops. Errors of CUHK-EXO are those against the gait of that delay ago.
"""

from __future__ import annotations

import argparse
import warnings
from dataclasses import dataclass

import numpy as np
import scipy

from exoid import load_leg
from exoid.control import feedforward_pd, simulate_law
from exoid.control.standard_laws import SENSORS
from exoid.experiments import healthy_gait
from exoid.leg.published import cuhk_resistances
from exoid.rig import Plant, Reference, Target

RATE, LATENCY, JITTER, LATE = 30.0, 0.010, 0.008, 0.100
KP, KD = (22.0, 55.0), (2.2, 5.5)
KNOTS = 8  # packets of which the receiver makes a spline
COAST = 0.05  # time for which it goes on where packets end [s]
LINKS = {"no loss, constant delay": (0.0, 0.0, 0.0), "5 % lost, jitter, 2 % late": (0.05, JITTER, 0.02)}


@dataclass(frozen=True)
class Link:
    """Reference that arrives in packets; pure, as what is known at a time is what has arrived until then."""

    sent: np.ndarray  # times of the packets that arrive [s], (K,)
    arrived: np.ndarray  # times of their arrival [s], (K,)
    angles: np.ndarray  # their angles [rad], (K, n)
    delay: float  # delay of the receiver [s]

    @classmethod
    def over(cls, source: Reference, seconds: float, delay: float, link: tuple[float, float, float], seed: int) -> Link:
        """Send a reference from one second before the run."""
        rng, (loss, jitter, late) = np.random.default_rng(seed), link
        sent = np.arange(-RATE, seconds * RATE) / RATE
        travel = LATENCY + rng.exponential(max(jitter, 1e-12), len(sent)) + LATE * (rng.random(len(sent)) < late)
        angles = np.round(np.array([source.at(t).q[:, 0] for t in sent]), 4)  # 14 bits for a turn
        there = rng.random(len(sent)) >= loss
        return cls(sent[there], np.maximum.accumulate(sent + travel)[there], angles[there], delay)

    def at(self, time: float) -> Target:
        """Interpolate between the packets that have arrived."""
        count = int(np.searchsorted(self.arrived, time, side="right"))
        known = slice(max(count - KNOTS, 0), count)
        sent, wanted = self.sent[known], time - self.delay
        curve = scipy.interpolate.CubicSpline(sent, self.angles[known])
        q, v, a = (curve(min(wanted, sent[-1]), k) for k in range(3))
        ahead = min(max(wanted - sent[-1], 0.0), COAST)
        if wanted > sent[-1]:
            q, v, a = q + ahead * v, v * (wanted < sent[-1] + COAST), 0.0 * a
        return Target(q[:, None], v[:, None], a[:, None])


def errors(period: float, rate: float, delay: float, name: str, seed: int) -> np.ndarray:
    """RMS and largest error against the gait that was sent [deg], (2, n)."""
    plant = Plant.build(load_leg("cuhk"), cuhk_resistances())
    gait, seconds = healthy_gait(1.2, period), period + 4.0
    model = Plant.build(load_leg("cuhk"), {k: 0.8 * x for k, x in cuhk_resistances().items()})  # friction 20 % wrong
    law = feedforward_pd(model, KP, KD, rate=rate)
    link = Link.over(gait, seconds, delay, LINKS[name], seed) if name in LINKS else gait
    run = simulate_law(plant, law, link, seconds, sensors=SENSORS, log_rate=100.0, seed=seed)
    settled = run.time > 2.0
    aim = np.array([gait.at(t - (delay if name in LINKS else 0.0)).q[:, 0] for t in run.time[settled]])
    error = np.rad2deg(run.q[settled] - aim)
    return np.array([np.sqrt((error**2).mean(axis=0)), np.abs(error).max(axis=0)])


def main() -> None:
    """Read the options and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--first", type=int, default=1000)
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    print(
        f"{'stride, law, delay of the receiver':37s}{'link':27s}{'rms [°]':>16s}{'peak [°]':>16s}{'rms / no loss':>16s}"
    )
    for period in (2.0, 10.0):
        for rate in (100.0, 1000.0):
            for delay in (0.10, 0.20):
                lossless = None
                for name in LINKS:
                    seeds = range(options.first, options.first + (options.seeds if "lost" in name else 1))
                    found = np.array([errors(period, rate, delay, name, seed) for seed in seeds])
                    lossless = found[0, 0] if lossless is None else lossless
                    rms, peak = np.sqrt((found[:, 0] ** 2).mean(axis=0)), found[:, 1].max(axis=0)
                    where = f"{period:g} s, {rate:g} Hz, {1e3 * delay:.0f} ms"
                    cells = f"{rms[0]:8.3f}{rms[1]:8.3f}{peak[0]:8.2f}{peak[1]:8.2f}"
                    print(f"{where:37s}{name:27s}{cells}{(found[:, 0] / lossless).max():16.3f}", flush=True)


if __name__ == "__main__":
    main()
