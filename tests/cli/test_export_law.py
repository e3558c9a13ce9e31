"""``exoid export --law`` writes what ``exoid.codegen.write_c`` writes, with the defaults of ``exoid track``."""

from dataclasses import replace

import numpy as np
import pytest
from made_estimates import made

import exoid
from exoid.actuators import Actuators, Motor
from exoid.codegen import Safety, c_source, write_ros2
from exoid.control import (
    LAWS,
    Limited,
    MomentumObserver,
    default_gains,
    gravity_support,
    impedance,
    mean_pose,
    sensitivity_amplification,
    standard_laws,
)
from exoid.estimate.text import provenance
from exoid.experiments import gait_for_leg, healthy_gait
from exoid.torques import TorqueModel

IN_C = [name for name in LAWS if name != "self_tuning"]


def gait_of(estimate):
    return gait_for_leg(estimate.leg, healthy_gait(0.8, 10.0))


@pytest.mark.slow
@pytest.mark.parametrize("name", IN_C)
def test_a_law_has_the_gains_of_track_and_the_limits_of_the_urdf(saved, exoid_, tmp_path, name):
    printed = exoid_("export", "est.json", "--law", name, "--c", "law.c").out
    gait = gait_of(saved)
    law = standard_laws(saved, *default_gains(saved, mean_pose(gait, 10.0)), gait, 10.0, names=[name])[name]
    expected = c_source(Limited(law, saved.leg.limits.effort), name="law", provenance=provenance(saved))
    assert (tmp_path / "law.c").read_text() == expected.text
    assert (tmp_path / "law.h").read_text() == expected.header
    for words in ("law.c and law.h", "law_init, law_step"):
        assert words in printed


def test_options_reach_the_law(saved, exoid_, tmp_path):
    given = "--kp 60 --kd 6,4,2 --rate 200 --limit 50,40,30 --slew 500 --safe gravity --patience 0.1 --precision float"
    data = exoid_("export", "est.json", "--law", "feedforward_pd", "--c", "law.c", *given.split(), "--json").data
    text = (tmp_path / "law.c").read_text()
    assert (data["rate"], data["safe"], data["patience"], data["precision"]) == (200.0, "gravity", 0.1, "float")
    assert "law_kp[3] = {60.0f, 60.0f, 60.0f}" in text
    assert "law_kd[3] = {6.0f, 4.0f, 2.0f}" in text
    assert "law_largest[3] = {50.0f, 40.0f, 30.0f}" in text
    assert "law_change[3] = {2.5f, 2.5f, 2.5f}" in text
    assert "#define LAW_PATIENCE 20" in text


def test_laws_for_a_wearer(saved, exoid_, tmp_path):
    laws = {
        ("gravity_support", "--share", "0.5", "--safe", "gravity"): gravity_support(saved, 0.5),
        ("sensitivity_amplification", "--amplification", "1.5,3,2"): sensitivity_amplification(saved, (1.5, 3.0, 2.0)),
        ("impedance", "--kp", "30"): impedance(saved, 30.0, 3.0),
    }
    for arguments, law in laws.items():
        exoid_("export", "est.json", "--law", *arguments, "--c", "law.c")
        safety = Safety("gravity" if "--safe" in arguments else "damping")
        limited = Limited(law, saved.leg.limits.effort)
        assert (tmp_path / "law.c").read_text() == c_source(limited, name="law", safety=safety).text


def test_the_observer(saved, exoid_, tmp_path):
    exoid_("export", "est.json", "--law", "momentum_observer", "--bandwidth", "5", "--rate", "200", "--c", "seen.c")
    observer = MomentumObserver(saved, 5.0, 200.0, torque_delay=0.0)
    expected = c_source(observer, name="seen", provenance=provenance(saved))
    assert (tmp_path / "seen.c").read_text() == expected.text
    assert (tmp_path / "seen.h").read_text() == expected.header
    assert "tau is the torque of the wearer on the leg" in expected.header
    assert "safe_damping" not in expected.text


def test_an_observer_of_torques_that_lag_is_refused_by_name(estimate, exoid_, tmp_path):
    replace(estimate, torque_delays=np.array([0.0, 0.012, 0.0])).save("late.json")
    line = exoid_("export", "late.json", "--law", "momentum_observer", "--c", "seen.c").refusal
    for words in ("the measured torques lag", "knee 12 ms", "torque_delay=0.0"):
        assert words in line
    assert [path.name for path in tmp_path.iterdir()] == ["late.json"]
    exoid_("export", "late.json", "--law", "pd", "--c", "law.c")  # a law without torques is not concerned
    assert (tmp_path / "law.c").is_file()


def test_a_package_for_ros_2_is_that_of_python(saved, exoid_, tmp_path):
    printed = exoid_("export", "est.json", "--law", "gravity_friction_pd", "--ros2", "leg", "--limit", "60").out
    assert "package leg for ROS 2 Jazzy" in printed
    assert "was not built with ROS 2" in printed
    gait = gait_of(saved)
    law = standard_laws(saved, *default_gains(saved, mean_pose(gait, 10.0)), gait, 10.0, names=["gravity_friction_pd"])
    limited = Limited(law["gravity_friction_pd"], np.full(3, 60.0))
    (tmp_path / "again").mkdir()
    expected = write_ros2(tmp_path / "again" / "leg", limited, provenance=provenance(saved))
    written = {path.relative_to(tmp_path / "leg").as_posix() for path in (tmp_path / "leg").rglob("*.*")}
    assert written == {*expected.files, "exoid.json"}
    for name, text in expected.files.items():
        assert (tmp_path / "leg" / name).read_text() == text
    described = exoid_("export", "est.json", "--law", "lqr", "--ros2", "leg", "--json").data
    assert (described["package"], described["law"]["inputs"][-1]) == ("leg", "a_d")


def test_a_law_of_an_estimate_with_drives_gives_their_commands(estimate, exoid_, tmp_path):
    drives = Actuators.of(estimate.leg, {"hip": Motor(0.07, 50.0)})
    replace(estimate, actuators=drives).save("driven.json")
    exoid_("export", "driven.json", "--law", "impedance", "--kp", "30", "--c", "law.c")
    law = Limited(impedance(estimate, 30.0, 3.0), estimate.leg.limits.effort)
    assert (tmp_path / "law.c").read_text() == c_source(law, name="law", actuators=drives).text
    assert "at the joints: A, N m, N m" in (tmp_path / "law.h").read_text()


def test_a_leg_without_a_gait_gets_the_gains_of_its_zero_pose(exoid_, tmp_path):
    text = exoid.load_leg("cuhk").description.text
    (tmp_path / "leg.urdf").write_text(
        text.replace('"left_hip"', '"left_upper"').replace('"left_knee"', '"left_lower"')
    )
    leg = exoid.Leg.from_urdf(tmp_path / "leg.urdf", joints=("left_upper", "left_lower"))
    made(TorqueModel(leg, ()), leg.parameters, 1e-4 * np.eye(len(leg.parameters))).save("est.json")
    for law in ("gravity_friction_pd", "lqr"):
        assert exoid_("export", "est.json", "--law", law, "--c", "law.c").printed
