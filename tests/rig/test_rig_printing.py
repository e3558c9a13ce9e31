"""Plants, runs and energy balances print a few lines that say what they are, not their arrays."""

import numpy as np
import pytest
from rigs import BLEEX, FRICTION, Swing

from exoid.rig import IdealTorque, Plant, ProportionalDerivative, Rates, Sensors, simulate

LAW = ProportionalDerivative([300.0, 100.0, 20.0], [20.0, 5.0, 0.5])


@pytest.fixture(scope="module")
def plant():
    return Plant.concatenate([Plant.build(BLEEX, FRICTION), Plant.build(BLEEX, {**FRICTION, "c0_hip": 3.0})])


@pytest.fixture(scope="module")
def run(plant):
    sensors = Sensors(torque_noise=0.1)
    return simulate(plant, Swing(), LAW, IdealTorque(), 10.0, sensors=sensors, rates=Rates(step=1e-3, log=100.0))


def row(text, joint):
    return next(line.split() for line in text.splitlines() if line.strip().startswith(joint))


def test_a_run_of_many_samples_prints_a_table_of_one_line_a_joint(run):
    text = str(run)
    assert len(text.splitlines()) == 9
    assert "2 × bleex.urdf (left_hip, left_knee, left_ankle): 1001 samples at 100 Hz, 10 s" in text
    assert f"{run.energy.relative_error.max():.1g}" in text.splitlines()[-1]
    lowest, _, highest, speed, error, rms, torque = row(text, "left_knee")[1:]
    knee = np.rad2deg(run.q[:, 1])
    assert float(lowest) == pytest.approx(knee.min(), rel=5e-3)
    assert float(highest) == pytest.approx(knee.max(), rel=5e-3)
    off = np.rad2deg(run.q[:, 1] - run.target[:, 1])
    shown = [float(x) for x in (speed, error, rms, torque)]
    truth = [np.abs(run.v[:, 1]).max(), np.abs(off).max(), np.sqrt((off**2).mean()), np.abs(run.tau[:, 1]).max()]
    assert shown == pytest.approx(truth, rel=5e-3)


def test_a_plant_prints_the_range_of_each_quantity_over_its_rigs(plant):
    text = str(plant)
    assert len(text.splitlines()) == 7
    assert row(text, "left_hip")[1:4] == ["2", "to", "3"]
    assert row(text, "left_knee")[1] == f"{FRICTION['c0_knee']:g}"


def test_representations_are_one_line_without_arrays(plant, run):
    assert repr(plant) == "Plant(2 × bleex.urdf (left_hip, left_knee, left_ankle))"
    assert repr(run).startswith("Run(2 × bleex.urdf (left_hip, left_knee, left_ankle): 1001 samples")
    work = sorted(run.energy.work)
    assert f"work {work[0]:.3g} to {work[1]:.3g} J" in repr(run.energy)
    for each in (plant, run, run.energy):
        assert "array" not in repr(each)
        assert "\n" not in repr(each)
