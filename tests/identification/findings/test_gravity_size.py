"""An accelerometer that is off along the vertical is found, and a correct one on a walking base is not."""

from dataclasses import replace

import numpy as np
import pytest
from walking import Walk

import exoid
from exoid import BaseMotion


def kinds(log):
    return {f.kind: f.value for f in exoid.check(exoid.load_leg("bleex"), log, terms=())}


def biased(log, bias):
    base = log.base
    return replace(log, base=BaseMotion(base.angular_velocity, base.specific_force + bias, base.position))


@pytest.mark.parametrize("bias", [0.2, -0.2])
def test_a_vertical_bias_is_found(bias):
    log = Walk(exoid.load_leg("bleex"), seconds=30.0, rate=100.0).recording()
    assert kinds(biased(log, (0.0, 0.0, bias)))["gravity-size"] == pytest.approx(bias, abs=0.03)


@pytest.mark.parametrize("seed", range(6))
def test_nothing_is_said_of_a_correct_sensor(seed):
    walk = Walk(exoid.load_leg("bleex"), seconds=30.0, rate=100.0, seed=seed, pitch=0.1 + 0.1 * seed)
    assert "gravity-size" not in kinds(walk.recording())


def test_a_drifting_gyroscope_is_no_turn():
    log = Walk(exoid.load_leg("bleex"), seconds=30.0, rate=100.0).recording()
    base = log.base
    drifting = BaseMotion(base.angular_velocity + np.array([0.0, 0.02, 0.0]), base.specific_force, base.position)
    assert "gravity-size" not in kinds(replace(log, base=drifting))
