"""Options of each verb that make no sense: one line with what is wrong, and no file is written or changed."""

import numpy as np
import pytest
from controlled_legs import LEG, exact_estimate
from log_writers import named_columns, write_columns
from swings import log_of
from walking import Walk

import exoid

RAIL = [f"wrench_rail_{part}" for part in ("fx", "fy", "fz", "mx", "my", "mz")]
SHORT = "--duration 8 --highest 0.6 --starts 1 --noise 0.3"

REFUSED = {
    "track": [
        ("cuhk", "exoid reproduce tracking"),
        ("bleex --kp 1,2", "--kp 1,2"),
        ("bleex --period 0", "--period 0"),
        ("bleex --scale 3", "the motion asks"),
        ("bleex --reference walk.csv --scale 1", "--scale has no effect"),
        ("est.json --law pd", "there is no --dry-run"),
        ("est.json -o x.csv", "there is no --dry-run"),
        ("cuhk.json --dry-run log.csv --law nonsense", "no controller 'nonsense'"),
        ("cuhk.json --dry-run log.csv --kp 10,10", "gravity_support has no gains"),
        ("cuhk.json --dry-run log.csv --law lqr --kp 10,10", "lqr has no gains"),
        ("cuhk.json --dry-run log.csv --rig-payload 1", "--rig-payload has no effect"),
        ("cuhk.json --dry-run log.csv --rate 1000", "1000 Hz"),
        ("cuhk.json --dry-run log.csv --limit 1,2,3", "--limit 1,2,3"),
    ],
    "plan": [
        ("cuhk --noise much", "write numbers"),
        ("cuhk --angles knee", "JOINT=LOW:HIGH"),
        ("cuhk --angles elbow=0:10", "no joint 'elbow'"),
        (f"cuhk --angles hip=40:50 --torque 5 {SHORT}", "no motion was found"),
        ("cuhk --assess slow.csv -o plan.csv", "-o has no effect"),
        (f"cuhk -o plan.txt {SHORT}", "name the file .csv"),
        (f"cuhk -o plan.csv --tilts 5,5 {SHORT}", "two are one"),
        ("cuhk --stance both", "one sole"),
        ("bleex --stance tail", "choose among both, left, right"),
        ("bleex --stance left --tilts 10", "--tilts has no effect"),
        ("bleex --stance left --starts 2", "--starts has no effect"),
        ("bleex --stance left --assess slow.csv", "--assess has no effect"),
        ("bleex --stance left --sole left_foot=1", "FOOT=HEEL,TOE,HEIGHT"),
        (f"bleex --friction 0.5 {SHORT}", "--friction has no effect"),
    ],
    "view": [
        ("bleex --side middle --html leg.html", "middle", "'left' or 'right'"),
        ("bleex --inertias guessed --html leg.html", "guessed", "identified"),
        ("est.json --side left --html leg.html", "--side has no effect"),
        ("leg.urdf --inertias cad --html leg.html", "--inertias has no effect"),
        ("bleex --pose left_knee --html leg.html", "--pose left_knee", "JOINT=DEGREES"),
        ("bleex --pose elbow=3 --html leg.html", "no joint elbow"),
        ("bleex --port 7000 --html leg.html", "--port has no effect"),
        ("cuhk --log bleex_swing:test --side right --html leg.html", "none of the logged joints"),
    ],
    "export": [
        ("est.json -o leg.urdf --c leg.c", "one file", "give one of -o LEG.URDF, --c LEG.C and --mjcf LEG.XML"),
        ("est.json -o leg.urdf --precision float", "--precision has no effect"),
        ("est.json --c leg.c --mass-factor 3", "--mass-factor and --pull have no effect"),
        ("est.json --c leg.c --precision half", "no precision 'half'", "double or float"),
        ("est.json --law fuzzy --c law.c", "--law fuzzy: no such controller"),
        ("est.json --law self_tuning --c law.c", "SelfTuning has no form in C"),
        ("est.json --law pd -o leg.urdf", "--law has no effect on a URDF"),
        ("est.json --safe zero --rate 50 --c leg.c", "--rate, --safe: only a control law"),
        ("est.json --ros2 leg", "--ros2 writes a control law"),
        ("est.json --law pd --c law.c --ros2 leg", "one file is written at a time"),
        ("est.json --law pd --ros2 .", "did not write, or that were changed"),
        ("est.json --law momentum_observer --ros2 leg", "which no drive must follow"),
        ("est.json --law pd --c law.txt", "name the source: LAW.c"),
        ("est.json --law gravity_support --kp 9 --c law.c", "--kp has no effect: gravity_support has none"),
        ("est.json --law lqr --kd 9 --c law.c", "--kd has no effect: lqr has none"),
        ("est.json --law pd --role hip --c law.c", "JOINT=ROLE"),
    ],
    "identify": [
        ("one.urdf log.csv", "one.urdf: no joint of the URDF moves"),
        ("bleex bleex_swing", "bleex_swing:train"),
        ("bleex bleex_swing:all", "bleex_swing:test"),
        ("bleex bleex_swing:train --side up", "no side 'up'"),
        ("bleex bleex_swing:train --inertias guessed", "no inertias 'guessed'", "cad, identified"),
        ("bleex bleex_swing:train --start nan", "a limit of nan s"),
        ("bleex bleex_swing:train --joints left_hip", "--joints has no effect"),
        ("bleex_swing bleex_swing:train --inertias cad", "--inertias has no effect"),
        ("bleex_swing bleex_swing:train --known X1", "--known X1"),
        ("bleex_swing bleex_swing:train --known X1=1 --known X1=2", "X1 twice"),
        ("bleex_swing bleex_swing:train --prior J3=0.05", "--prior J3=0.05"),
        ("bleex walk.csv --column tau_left_hip=tau_left_hip:mA", "is not a unit of torque"),
        ("bleex walk.csv --column q_left_hip=q_left_hip:furlong", "no column 'q_left_hip:furlong'"),
        ("bleex walk.csv --column i_left_hip=tau_left_hip:1e3", "looks like mA"),
        ("bleex walk.csv --actuators est.json", "est.json: remembers no drives"),
        ("bleex bleex_swing:train --passive left_hip", "has no effect"),
        ("bleex bleex_swing:train --unmeasured left_hip", "has no effect"),
        ("cuhk log.csv --payload other.csv=knee:3@0,0,0", "other.csv is not among the logs"),
        ("cuhk log.csv --payload knee:3", "is no payload"),
        ("cuhk rail.csv --wrench rail", "--wrench 'rail' does not say the axes"),
        ("cuhk rail.csv --wrench rail:floor", "--wrench 'floor' is no axes"),
        ("cuhk rail.csv --wrench rail:link --wrench rail:world", "rail is given twice"),
        ("cuhk rail.csv --wrench belt:link", "axes of the wrench on belt, which the log does not have"),
        ("cuhk log.csv --base-position 0,0,0", "no motion of the base"),
        ("bleex walk.csv --mask swing", "no column 'swing'", "name a column of 0 and 1"),
        ("bleex bleex_swing:train --mask swing", "--mask has no effect"),
        ("bleex walk.csv --own offset", "there is only one log"),
        ("bleex walk.csv walk.csv --own offset", "one log was given twice"),
        ("bleex walk.csv masked.csv --own offset --test walk.csv", "--test has no effect"),
        ("bleex walk.csv masked.csv --own offset --report r.html", "--report has no effect"),
    ],
    "validate": [("est.json bleex_swing:test --cutoff -1", "cutoff [Hz] is -1")],
    "interaction": [("est.json walk.csv --strides a,b", "--strides a,b")],
}
"""Arguments of each verb, and words of the line."""

ALL = [
    pytest.param(f"{verb} {words}", said, id=f"{verb} {words}")
    for verb, rows in REFUSED.items()
    for words, *said in rows
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory, data, estimate):
    """Estimates of both legs, and logs."""
    path = tmp_path_factory.mktemp("files")
    estimate.save(path / "est.json")
    exact_estimate().save(path / "cuhk.json")
    (path / "leg.urdf").write_text(data.leg.description.text, encoding="utf-8")
    (path / "one.urdf").write_text(data.leg.description.text.replace("revolute", "fixed"), encoding="utf-8")
    spans = [(4.0 + k, 4.6 + k) for k in range(10)]
    data.train.to_csv(path / "walk.csv")
    data.train.segments(spans).to_csv(path / "masked.csv")
    motion = Walk(LEG, seconds=20.0)
    exoid.Recording(motion.time, motion.joints[0], joint_names=LEG.joint_names).to_csv(path / "slow.csv")
    log = log_of(LEG, motion.time, motion.joints)
    log.to_csv(path / "log.csv")
    rail = dict.fromkeys(RAIL, np.ones(len(log)))
    write_columns(path / "rail.csv", **named_columns(log), **rail)
    (path / "empty").mkdir()
    return path


@pytest.mark.parametrize(("command", "said"), ALL)
def test_options_that_make_no_sense_are_one_line_and_write_nothing(exoid_, folder, monkeypatch, command, said):
    monkeypatch.chdir(folder)
    before = {path: path.stat().st_mtime_ns for path in folder.rglob("*")}
    line = exoid_(*command.split(" ")).refusal
    for words in said:
        assert words in line
    assert {path: path.stat().st_mtime_ns for path in folder.rglob("*")} == before
