"""The example for an STM32 commands the currents of Python's law, and is safe when frames are late or missing."""

import re
import shutil

import numpy as np
import pytest
from cortex_m import needs_cortex_m
from doc_pages import Page
from stm32_firmware import EXAMPLE, RATE, SLEW, Firmware, InTheLoop, LawInPython, build, measured, motion

pytestmark = [
    needs_cortex_m,
    pytest.mark.nightly,
    pytest.mark.skipif(not EXAMPLE.is_dir(), reason="needs the source tree"),
    pytest.mark.skipif(shutil.which("make") is None, reason="needs make"),
]

QUANTUM = 0.0006  # of the frames to the drives, half of 1 mA, and what single precision adds [A]
PATIENCE = 3  # steps
Q, V = np.array([0.2, -0.3, 0.05]), np.array([0.4, -0.2, 0.1])


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    return build(tmp_path_factory.mktemp("example"))


@pytest.fixture
def firmware(built):
    return Firmware(built[0])


def started(firmware, steps=50):
    """Press the button and let the leg run; the currents of the last step."""
    firmware.step(Q, V)
    firmware.press(True)
    firmware.step(Q, V)
    firmware.press(False)
    return [firmware.step(Q, V) for _ in range(steps)][-1].current


def quiet(current):
    return np.abs(current).max() < QUANTUM


def test_a_simulated_leg_follows_the_motion_and_its_currents_are_those_of_python(built):
    elf, estimate = built
    steps, law = InTheLoop(Firmware(elf), estimate).run(3.0), LawInPython(estimate)
    begin = 11  # the step after the one with the button
    errors = []
    for k, step in enumerate(steps):
        target = motion(steps[begin - 1].q, max(k - begin, 0))
        expected = law.current("law" if k >= begin else "damping", step, target if k >= begin else motion(0 * Q, 0))
        np.testing.assert_allclose(step.current, expected, atol=QUANTUM)
        errors.append(np.abs(step.q - target.q))
    assert len(steps) == 3 * RATE + 1
    assert np.max(errors[begin:]) < np.deg2rad(2.0)  # the law has no inertia of the reference
    assert max(np.abs(step.current).max() for step in steps) > 1.5


@pytest.mark.parametrize("page", ["docs/microcontroller.md", "examples/stm32/README.md"])
def test_flash_stack_and_instructions_are_those_of_the_page(page, built):
    """Another version of the compiler may differ a little."""
    printed, number = "\n".join(measured(*built)), re.compile(r"\d+")
    shown = next(block for block in Page.read(page).shown if block.startswith("flash"))
    assert number.sub("", shown).split() == number.sub("", printed).split()
    assert list(map(int, number.findall(shown))) == pytest.approx(list(map(int, number.findall(printed))), rel=0.05)


def test_before_the_button_is_pressed_the_leg_is_damped_and_nothing_else(firmware):
    assert all(quiet(firmware.step(Q, 0 * V).current) for _ in range(50))
    assert firmware.fed == 50
    pushed = [firmware.step(Q, V).current for _ in range(50)][-1]
    assert (pushed * V < 0).all()
    assert not quiet(pushed)


def test_the_button_starts_nothing_while_an_encoder_is_missing(firmware):
    firmware.press(True)
    firmware.step(Q, V, reports=(0, 1))
    assert all(quiet(firmware.step(Q, V, reports=(0, 1)).current) for _ in range(50))
    for _ in range(2):
        assert all(quiet(firmware.step(Q, 0 * V).current) for _ in range(50))  # it reports: too late for the button
        firmware.press(False)
        firmware.step(Q, 0 * V)
        for _ in range(2 * PATIENCE):
            firmware.step(Q, 0 * V, reports=(0, 1))
        firmware.press(True)
        firmware.step(Q, 0 * V, reports=(0, 1))
    firmware.press(False)
    firmware.step(Q, 0 * V)
    firmware.press(True)
    firmware.step(Q, 0 * V)
    assert not quiet(firmware.step(Q, 0 * V).current)


@pytest.mark.parametrize("fault", [{"reports": ()}, {"reports": (0, 2)}, {"hangs": True}])
def test_a_missing_frame_ends_in_the_safe_command_until_the_button_is_pressed(built, fault):
    elf, estimate = built
    firmware, law = Firmware(elf), LawInPython(estimate)
    before = started(firmware)
    for _ in range(PATIENCE):
        last = firmware.step(Q, V, **fault)
    law.last = estimate.actuators.torque_of(last.current[None], last.q[None], last.v[None])[0]
    assert np.abs(before).max() > 0.5
    for _ in range(round(np.abs(law.last).max() / (SLEW / RATE)) + 2):  # to zero at the largest rate of change
        step = firmware.step(Q, V, **fault)
        np.testing.assert_allclose(step.current, law.current("zero", step, motion(0 * Q, 0)), atol=3 * QUANTUM)
    assert quiet(step.current)
    law.last = np.zeros(3)
    for _ in range(60):  # the frames are back: damping, but no motion
        step = firmware.step(Q, V)
        np.testing.assert_allclose(step.current, law.current("damping", step, motion(0 * Q, 0)), atol=QUANTUM)
    firmware.press(True)
    firmware.step(Q, V)
    firmware.press(False)
    assert np.abs([firmware.step(Q, V) for _ in range(50)][-1].current - step.current).max() > 0.5


def test_the_watchdog_is_fed_once_for_each_step_that_was_done(firmware):
    started(firmware, 20)
    assert firmware.fed == 22
    for fault in ("stub_full", "stub_overrun"):  # the drives accept no frame; a step takes longer than its period
        fed = firmware.fed
        firmware.set(fault, 1)
        for _ in range(6):
            firmware.step(Q, V)
        assert firmware.fed == fed
        firmware.set(fault, 0)
        firmware.step(Q, V)
        assert firmware.fed == fed + 1
