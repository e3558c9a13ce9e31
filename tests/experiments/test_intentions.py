"""Tremor and stumble of a wearer."""

import numpy as np
import pytest

import exoid
from exoid.errors import ExoidError
from exoid.experiments import Hold, Stumble, Tremor, healthy_gait
from exoid.rig import IdealTorque, Plant, ProportionalDerivative, Rates, Wearer, simulate

GAIT, LEG = healthy_gait(0.8, 1.2), exoid.load_leg("cuhk")
MOTIONS = {
    "tremor": Tremor(GAIT, (0.02, 0.01), 8.0),
    "stumble": Stumble(GAIT, (0.3, -0.2), 0.5),
    "both": Stumble(Tremor(GAIT, 0.01), 0.2, 0.3, 0.6),
}


@pytest.mark.parametrize("motion", MOTIONS.values(), ids=MOTIONS)
def test_velocity_and_acceleration_are_derivatives(motion):
    step, times = 1e-5, np.linspace(0.05, 1.4, 57)
    for t in times:
        before, now, after = (motion.at(t + shift) for shift in (-step, 0.0, step))
        np.testing.assert_allclose((after.q - before.q) / (2 * step), now.v, atol=1e-6)
        np.testing.assert_allclose((after.v - before.v) / (2 * step), now.a, atol=1e-3)


def test_a_stumble_is_over_after_its_time():
    motion = MOTIONS["stumble"]
    np.testing.assert_allclose(motion.at(0.7).q - GAIT.at(0.7).q, [[0.3], [-0.2]], rtol=1e-12)
    for t in (0.0, 0.5, 0.9, 2.0):
        for moved, plain in zip(motion.at(t), GAIT.at(t), strict=True):
            np.testing.assert_allclose(moved, plain, atol=1e-9)
    accelerations = [np.abs(motion.at(t).a - GAIT.at(t).a) for t in np.linspace(0.5, 0.9, 2001)]
    assert np.max(accelerations) == pytest.approx(24.0 * 0.3 / 0.4**2, rel=1e-6)


def test_a_tremor_has_its_amplitude_and_frequency():
    times = np.arange(1000) / 500.0
    added = np.array([MOTIONS["tremor"].at(t).q[:, 0] - GAIT.at(t).q[:, 0] for t in times])
    spectrum = np.abs(np.fft.rfft(added, axis=0)) / 500.0
    assert np.fft.rfftfreq(1000, 1 / 500.0)[spectrum.argmax(axis=0)] == pytest.approx([8.0, 8.0])
    np.testing.assert_allclose(spectrum.max(axis=0), [0.02, 0.01], rtol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("motion", MOTIONS.values(), ids=MOTIONS)
def test_a_wearer_moves_so(motion):
    """Muscles with feedforward, no cuff: the limb does what is intended."""
    wearer = Wearer.build(LEG, intention=motion, cuff_stiffness=0.0, cuff_damping=0.0)
    plant = Plant.build(LEG, end_stops=False)
    run = simulate(
        plant,
        motion,
        ProportionalDerivative(50.0, 5.0),
        IdealTorque(),
        1.2,
        wearer=wearer,
        rates=Rates(500.0, 100.0, 5e-4),
    )
    aim = np.array([motion.at(t).q for t in run.time])
    np.testing.assert_allclose(run.limb_q, aim, atol=1e-4)


def test_a_motion_without_accelerations_stays_without():
    class Line:
        def at(self, time):
            return exoid.rig.Target(np.full((2, 1), time), np.ones((2, 1)))

    assert Tremor(Line(), 0.1).at(0.3).a is None
    assert Stumble(Line(), 0.1, 0.1).at(0.3).a is None


@pytest.mark.parametrize(
    "make",
    [
        lambda: Tremor(GAIT, -0.1),
        lambda: Tremor(GAIT, np.nan),
        lambda: Tremor(GAIT, 0.1, 62.8),
        lambda: Tremor(GAIT, np.ones((2, 2))),
        lambda: Stumble(GAIT, np.inf, 0.1),
        lambda: Stumble(GAIT, 0.1, np.nan),
        lambda: Stumble(GAIT, 0.1, 0.1, 0.0),
    ],
)
def test_impossible_numbers_are_refused(make):
    with pytest.raises(ExoidError, match=r"tremor|stumble"):
        make()


def test_a_stumble_beyond_the_end_stops_is_refused():
    plant, motion = Plant.build(LEG), Stumble(Hold(np.array([[0.5], [0.5]])), (0.0, 3.0), 0.2)
    with pytest.raises(ExoidError, match="the wearer intends"):
        simulate(plant, Hold(np.array([[0.5], [0.5]])), ProportionalDerivative(50.0, 5.0), IdealTorque(), 1.0,
                 wearer=Wearer.build(LEG, intention=motion))  # fmt: skip
