"""How far a model's motion parts from the measured one within a horizon, on data it was not identified from."""

from __future__ import annotations

import numpy as np

import exoid
from exoid.estimate import predict_motion

HORIZONS = (0.1, 0.25, 0.5, 1.0)


def main() -> None:
    """Print a table in Markdown: RMS over the whole recording, in degrees."""
    print(f"| data | joint | {' | '.join(f'{horizon:g} s' for horizon in HORIZONS)} |")
    print(f"|---|---|{'---|' * len(HORIZONS)}")
    for name in ("bleex_swing", "dfki_double_pendulum"):
        data = getattr(exoid.datasets, name)()
        estimate = exoid.identify(data.leg, data.train)
        errors = [
            np.rad2deg(np.sqrt(np.mean((predict_motion(estimate, data.test, horizon).q - data.test.q) ** 2, axis=0)))
            for horizon in HORIZONS
        ]
        for joint, row in zip(data.leg.joint_labels, np.transpose(errors), strict=True):
            print(f"| {name} | {joint} | {' | '.join(f'{error:.2f}' for error in row)} |")


if __name__ == "__main__":
    main()
