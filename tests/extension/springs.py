"""The package exoid_springs, and logs of a leg with its end stops."""

import importlib.util
import os
import sys
from pathlib import Path

import numpy as np
import processes
from swings import Swing

import exoid

PROJECT = Path(__file__).resolve().parent / "exoid_springs"
EXOID = Path(exoid.__file__).resolve().parents[1]

STIFFNESS = {"hip": 40.0, "knee": 25.0}
"""Of the end stops [N·m/rad²], at both sides from 0.3 rad on."""


def run(*arguments, path=(), **options) -> str:
    """Run Python in an interpreter of its own, with these folders on its path, and check its exit status."""
    places = [*map(str, path), str(EXOID), *os.environ.get("PYTHONPATH", "").split(os.pathsep)]
    env = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, places))}
    return processes.run(sys.executable, *arguments, env=env, **options)


def command(*arguments, **options) -> str:
    """Run the command ``exoid``."""
    return run("-c", "from exoid.cli import main; main()", *arguments, **options)


def swing_with_stops(seed=0, noise=0.02) -> exoid.Recording:
    """A log of the CUHK leg with Coulomb and viscous friction, and with end stops at both joints."""
    swing = Swing(exoid.load_leg("cuhk"), seed=1 + seed)
    q, _, _ = swing.motion
    stops = np.array([*STIFFNESS.values()]) * np.sign(q) * np.maximum(np.abs(q) - 0.3, 0.0) ** 2
    assert (stops != 0.0).any(axis=0).all()
    rng = np.random.default_rng(seed)
    return swing.recording(tau=swing.torque + stops + rng.normal(scale=noise, size=q.shape))


def load_module(name: str = "exoid_springs"):
    """Import the package from the project's folder, which is on no path."""
    spec = importlib.util.spec_from_file_location(name, PROJECT / name / "__init__.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module
