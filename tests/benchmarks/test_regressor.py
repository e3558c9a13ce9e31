"""How fast and how sparing the batched regressor is, against loops over Pinocchio's and against FIGAROH's.

``pytest tests/benchmarks/test_regressor.py -s`` prints the ratios; FIGAROH's if ``pip install figaroh`` was run before.
"""

import warnings

import numpy as np
import pinocchio as pin
import pytest
from planar_chains import assert_relative, random_motion
from turns import best_of_turns, looped, show, with_memory

import exoid
from exoid import Coulomb, Viscous
from exoid.torques import TorqueModel

SAMPLES = 100_000
ROUNDS = 4
STORED, BARE, FIGAROH = 7.0, 5.0, 36.0
"""Ratios below which something has become slower; 11, 7.9 and 46 are the least that were measured, on busy machines."""
EXTRA_MEMORY = 100e6
"""Bytes beyond the output."""

LEG = exoid.load_leg("bleex")
MODEL = TorqueModel(LEG, (Coulomb(), Viscous()))
MOTION = random_motion(np.random.default_rng(0), 3, SAMPLES)
OURS = "batched, with six friction columns, output allocated"


def batched() -> np.ndarray:
    """Documented parameters, Coulomb and viscous friction, (N, 3, 15)."""
    return MODEL.regressor(*MOTION)


def loop_stored() -> np.ndarray:
    """Pinocchio's regressor sample by sample, (N, 3, 30)."""
    return looped(LEG.model, MOTION, np.empty((SAMPLES, 3, 30)))


@pytest.fixture(scope="module")
def figaroh():
    """FIGAROH's regressor of the same leg, with its friction columns; by its faster way, without a backend."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # its compiled parts warn of converters that are registered twice
        module = pytest.importorskip("figaroh.tools.regressor", reason="needs figaroh")
    robot, settings = pin.RobotWrapper(LEG.model), {"has_friction": True, "act_idxv": [0, 1, 2]}

    def regressor() -> np.ndarray:
        """All joints' rows one after the other, (3 N, 36)."""
        return module.build_regressor_basic(robot, *MOTION, settings)

    return regressor


def test_the_batched_regressor_is_many_times_as_fast_as_a_loop_over_pinocchios():
    works = {
        OURS: batched,
        "loop over Pinocchio's, stored, reduced": lambda: LEG.reduction.reduce(loop_stored()),
        "loop over Pinocchio's, stored": loop_stored,
        "loop over Pinocchio's, thrown away": lambda: looped(LEG.model, MOTION),
    }
    best = best_of_turns(works, ROUNDS)
    show(f"Regressor of {SAMPLES:,} samples, three segments", best, OURS)
    assert best["loop over Pinocchio's, stored"] >= STORED * best[OURS]
    assert best["loop over Pinocchio's, thrown away"] >= BARE * best[OURS]


def test_figarohs_regressor_is_the_same(figaroh):
    whole = figaroh().reshape(3, SAMPLES, 36).transpose(1, 0, 2)
    assert_relative(LEG.reduction.reduce(np.ascontiguousarray(whole[..., :30])), batched()[:, :, :9], 1e-12)


def test_the_batched_regressor_is_many_times_as_fast_as_figarohs(figaroh):
    best = best_of_turns({OURS: batched, "FIGAROH's build_regressor_basic": figaroh}, ROUNDS)
    show(f"Regressor of {SAMPLES:,} samples, three segments", best, OURS)
    assert best["FIGAROH's build_regressor_basic"] >= FIGAROH * best[OURS]


def test_the_batched_regressor_needs_little_memory_beyond_its_output():
    batched()
    W, peak = with_memory(batched)
    assert W.nbytes == SAMPLES * 3 * 15 * 8
    assert peak >= W.nbytes
    print(f"\n{(peak - W.nbytes) / 1e6:.1f} MB beyond the output of {W.nbytes / 1e6:.0f} MB")
    assert peak - W.nbytes <= EXTRA_MEMORY
