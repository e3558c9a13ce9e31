"""Identification of legs on a base that moves, from logs with an IMU."""

from dataclasses import replace

import numpy as np
import pytest
from public_robots import urdf_of
from swings import holds, with_payloads
from unchecked import identify
from walking import Walk

import exoid
from exoid import BaseMotion, ExoidError, Leg, Payload


def errors(estimate, leg, symbol):
    """Errors of the parameters of one kind [%], those of Y in shares of X."""
    truth = dict(zip(leg.parameter_names, leg.parameters, strict=True))
    scale = {name: abs(truth[name.replace("Y", "X")]) for name in truth}
    return [100.0 * abs(estimate[name].value - truth[name]) / scale[name] for name in truth if name.startswith(symbol)]


def fixed(recording):
    return replace(recording, base=None)


@pytest.mark.parametrize("name", ["bleex", "cuhk"])
def test_a_walk_with_an_imu_gives_the_parameters_of_the_leg(name):
    leg = exoid.load_leg(name)
    for seed in range(3):
        estimate = identify(leg, Walk(leg, seconds=60.0, seed=seed).recording(), terms=())
        assert max(errors(estimate, leg, "X")) < 0.5
        assert max(errors(estimate, leg, "J")) < 3.0
        assert max(errors(estimate, leg, "Y")) < 0.5


@pytest.mark.slow
@pytest.mark.parametrize("name", ["bleex", "cuhk"])
def test_a_model_with_a_fixed_torso_is_called_wrong(name):
    leg = exoid.load_leg(name)
    recording = Walk(leg).recording()
    found = exoid.check(leg, fixed(recording))
    assert {(finding.kind, finding.joint) for finding in found} >= {("large-residual", leg.joint_names[0])}
    assert any("BaseMotion" in finding.remedy for finding in found)
    assert exoid.check(leg, recording) == ()


def test_the_sensor_s_position_matters(leg):
    recording = Walk(leg, seconds=60.0, pitch=0.2).recording()
    base = recording.base
    elsewhere = replace(recording, base=BaseMotion(base.angular_velocity, base.specific_force))
    right, wrong = (identify(leg, log, terms=()) for log in (recording, elsewhere))
    assert max(errors(right, leg, "J")) < 1.0
    assert (wrong.residual_rms > 1.5 * right.residual_rms)[:2].all()


def test_motion_out_of_the_plane_is_found_by_its_share_of_the_torque(leg):
    kinds = []
    for sideways in (0.0, 0.1, 0.4):
        found = exoid.check(leg, Walk(leg, sideways=sideways).recording())
        kinds.append([(finding.kind, finding.severity) for finding in found if finding.kind == "out-of-plane-base"])
    assert kinds[0] == []
    assert ("out-of-plane-base", "warning") in kinds[1]
    assert ("out-of-plane-base", "error") in kinds[2]


def test_a_leg_in_space_is_identified_on_a_base_that_turns_every_way():
    leg = Leg.from_urdf(urdf_of("ur5"), base="moving")
    training = [Walk(leg, seconds=40.0, seed=seed, sideways=0.3, pitch=0.3).recording(0.1) for seed in (1, 2)]
    estimate = identify(leg, training, terms=())
    test = Walk(leg, seed=3, sideways=0.3, pitch=0.3).recording(0.1)
    assert (exoid.validate(estimate, test).nrmse < 0.02).all()
    with pytest.raises(ExoidError, match="moving base"):
        identify(Leg.from_urdf(urdf_of("ur5")), training, terms=())


def test_a_payload_on_the_leg_moves_with_the_base():
    leg = exoid.load_leg("cuhk")
    load = Payload("left_knee", 3.0, (0.0, 0.0, -0.3))
    heavy = with_payloads(leg, [load])
    recording = replace(Walk(heavy, seconds=60.0).recording(), payloads=(load,))
    estimate = identify(leg, recording, terms=())
    assert max(errors(estimate, leg, "X")) < 0.5


def test_validation_uses_the_base():
    leg = exoid.load_leg("cuhk")
    estimate = identify(leg, Walk(leg, seconds=40.0).recording(), terms=())
    test = Walk(leg, seconds=10.0, seed=5).recording()
    assert (exoid.validate(estimate, test).nrmse < 0.05).all()
    assert (exoid.validate(estimate, fixed(test)).nrmse > 0.1).all()


def test_a_rotor_at_the_hip_is_told_from_the_leg_by_the_pitch_of_the_torso():
    leg = exoid.load_leg("cuhk")
    walked = Walk(leg, seconds=60.0, pitch=0.2)
    recording = walked.recording()
    geared = replace(recording, tau=recording.tau + 0.8 * walked.joints[2])
    estimate = identify(leg, geared, terms=(exoid.Armature(),))
    assert {"Ia_hip", "Ia_knee"} <= set(estimate.names)
    for name in ("Ia_hip", "Ia_knee"):
        assert abs(estimate[name].value - 0.8) < 0.03, name
    assert max(errors(estimate, leg, "J")) < 3.0
    assert not exoid.check(leg, geared, terms=(exoid.Armature(),)), "the check tells the rotor from the leg as well"
    standing = identify(leg, replace(Walk(leg, pitch=0.0).recording(), base=None), terms=(exoid.Armature(),))
    assert "Ia_hip" not in standing.names


@pytest.mark.slow
def test_intervals_cover_the_truth(leg):
    inside = []
    for seed in range(16):
        estimate = identify(leg, Walk(leg, seconds=40.0, seed=seed).recording(), terms=())
        inside.append(holds(estimate, leg.parameters))
    assert 0.88 <= np.mean(inside) <= 1.0
