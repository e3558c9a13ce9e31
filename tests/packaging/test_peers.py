"""The comparison with other tools: its judgement reads models rightly, and the page states what the scripts have."""

import importlib
import sys
from pathlib import Path

import numpy as np
import pytest

import exoid

ROOT = Path(__file__).resolve().parents[2]
FOLDER, PAGE = ROOT / "scripts" / "peers", ROOT / "docs" / "comparison.md"

pytestmark = pytest.mark.skipif(not FOLDER.is_dir(), reason="needs the source tree")


@pytest.fixture
def scripts(monkeypatch):
    """The modules of the folder, which import each other by their names."""
    monkeypatch.syspath_prepend(str(FOLDER))
    names = ("task", "compare", "reversals")
    yield tuple(importlib.import_module(name) for name in names)
    for name in names:
        sys.modules.pop(name, None)


def test_a_model_is_read_as_its_own_parameters(scripts):
    task, *_ = scripts
    leg = exoid.load_leg("bleex", side="left", inertias="identified")
    coulomb, viscous = np.array([0.5, 0.4, 0.3]), np.array([0.3, 0.2, 0.1])

    def torque(q, v, a):
        rotors = np.array([0.0, 0.02, 0.01]) * a
        return leg.inverse_dynamics(q, v, a) + coulomb * np.sign(v) + viscous * v + rotors + 0.7

    found = task.read_as_parameters(leg, torque)
    np.testing.assert_allclose(list(found.values()), [*leg.parameters, *coulomb, *viscous], rtol=1e-9, atol=1e-10)
