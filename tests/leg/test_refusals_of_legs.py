"""What no leg can be or do is refused in one line, by its kind of error, with the place or name and a remedy."""

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from outcomes import refused
from small_urdfs import BODY, HIP, KNEE, LINKS, URDF, bomb, endless, nearly_coaxial, replaced

import exoid
from exoid import Leg, Payload, TorsoMotion, published
from exoid.control.model import ControlModel
from exoid.errors import BadArgumentError, NotIdentifiableError, NotSupportedError, UnreadableInputError
from exoid.experiments.excitation import plan_excitation
from exoid.leg.base_kinematics import BaseKinematics
from exoid.leg.description import describe, read_description
from exoid.leg.lift import check_physical, lift
from exoid.leg.reduction.tree import Tree
from exoid.torques import Motion
from exoid.torques.payloads import payload_torque

BLEEX, EXO, FLOATING = exoid.load_leg("bleex"), exoid.load_exo("bleex"), exoid.load_exo("bleex", base="floating")
SAMPLES, STILL = np.zeros((4, 3)), np.zeros((1, 6))
XACRO = URDF.replace("<robot ", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" ')
INERTIA = BODY[BODY.index("<inertia ") : BODY.index("</inertial>")]

NOT_XML = [
    "", " ", "hello", "<robot>", "<robot></Robot>", "<robot name='a' name='b'/>", "<robot/><robot/>", "\x00",
    "<robot>\x01</robot>", "<robot name='\ud800'/>", "<robot>&amp</robot>", "<robot>&undefined;</robot>",
    "<xacro:robot/>", "{'robot': 1}", "<robot>" + "<a>" * 500_000,
    f'<?xml version="1.0" encoding="utf-7"?>{bomb().replace("<!", "+ADwAIQ-")}',  # <!DOCTYPE without a less-than sign
]  # fmt: skip
NO_LEG = [
    bomb(),
    f'<!DOCTYPE robot [<!ENTITY x SYSTEM "file:///etc/hostname">]><robot name="r">&x;{LINKS}{HIP}{KNEE}</robot>',
    URDF.replace("<robot", '<!DOCTYPE robot SYSTEM "http://localhost:9/robot.dtd"><robot'),
    URDF.replace("<robot", "<!DOCTYPE robot><robot"),
    *(f"<{root}/>" for root in ("sdf", "mujoco", "Robot", "html")),
    *(XACRO.replace("</robot>", f"<xacro:{x}/></robot>") for x in ('macro name="leg"', 'include filename="a"')),
    endless(joined=True),  # Pinocchio's parser would overflow the stack, and take the process with it
    endless(joined=False),
    '<robot name="r"><link name="a"/></robot>',
]
BROKEN = [  # the evidence, and the URDF
    ("'hip'", replaced('type="revolute"', 'type="hinge"')),
    ("'hip'", replaced('type="revolute"', "")),
    ("'thihg'", replaced('<parent link="thigh"/>', '<parent link="thihg"/>')),
    ("'foot'", replaced('<child link="shank"/>', '<child link="foot"/>')),
    ("'knee'", replaced('<parent link="thigh"/>', "")),
    ("'knee'", replaced('<child link="shank"/>', "<child/>")),
    ("shank", replaced('<link name="torso"/>', '<link name="shank"/>')),
    ("hip", replaced('name="knee"', 'name="hip"')),
    ("'thigh'", replaced('<child link="shank"/>', '<child link="thigh"/>')),
    ("torso, spare", replaced('<link name="torso"/>', '<link name="torso"/><link name="spare"/>')),
    ("root", replaced('<parent link="torso"/>', '<parent link="shank"/>').replace('<link name="torso"/>', "")),
    *(("'thigh'", replaced(piece, "")) for piece in ('<mass value="2"/>', ' value="2"', ' izz="0.01"', INERTIA)),
    *(("'hip'", replaced('<axis xyz="0 -1 0"/>', f'<axis xyz="{axis}"/>')) for axis in ("0 0 0", "0 1e-200 0")),
    ("1e200", replaced('xyz="0 0 -0.2"', 'xyz="1e200 0 0"')),
    *(("lengths in m", replaced(f'"{x}"', f'"{y}"')) for x, y in (("0 0 -0.4", "0 0 -400"), ("0.02", "2e7"))),
    *(("'thigh'", replaced('<mass value="2"/>', f'<mass value="{mass}"/>')) for mass in ("0", "-1", "0.0e5")),
    *(("'thigh'", replaced(*pair)) for pair in (('iyy="0.02"', 'iyy="-0.02"'), ('ixy="0"', 'ixy="0.05"'))),
    ("'shank'", URDF.replace(f'<link name="shank">{BODY}</link>', '<link name="shank"/>')),
]
NUMBERS = [  # Pinocchio's parser would leave the whole <inertial> out and go on without it
    (place, replaced(old, new.format(number)))
    for number in ("nan", "inf", "-inf", "1e999", "", "two", "1,5", "0x10", "1_000", "1 2")
    for old, new, place in (
        ('<mass value="2"/>', '<mass value="{}"/>', "link 'thigh'"),
        ('iyy="0.02"', 'iyy="{}"', "link 'thigh'"),
        ('xyz="0 0 -0.2"', 'xyz="0 0 {}"', "link 'thigh'"),
        ('xyz="0 0 -0.4"', 'xyz="{} 0 0"', "joint 'knee'"),
        ('<axis xyz="0 -1 0"/>', '<axis xyz="0 {} 0"/>', "joint 'hip'"),
        ('upper="2"', 'upper="{}"', "joint 'hip'"),
    )
]


def leg(text=URDF, joints=("hip", "knee"), **locked):
    return Leg.from_description(describe(text, "leg.urdf"), joints, locked=locked)


def free(kind, below=""):
    """The hip, or the knee below it, with several degrees of freedom."""
    return URDF.replace(KNEE, KNEE.replace('"revolute"', kind)) if below else replaced('"revolute"', kind)


def weightless():
    """A floating machine whose torso has no inertia."""
    text = exoid.load_leg("cuhk").description.text
    start, end = text.index("<inertial>"), text.index("</inertial>") + len("</inertial>")
    return Leg.from_description(
        describe(text[:start] + text[end:]), exoid.load_exo("cuhk").joint_names, base="floating"
    )


def screw(joint):
    model = pin.Model()
    model.addJoint(0, joint, pin.SE3.Identity(), "screw")
    return Tree.from_model(model)


def torso(**motion):
    return BLEEX.regressor(SAMPLES, SAMPLES, SAMPLES, TorsoMotion(**motion))


def base(*shapes, value=0.0):
    return BaseKinematics(*(np.full(shape, value) for shape in shapes))


def lifted(values=None, covariance=None, **options):
    return lift(BLEEX, BLEEX.parameters if values is None else values, covariance, **options)


def absurd(size):
    values = BLEEX.parameters.copy()
    values[4] = size
    return lift(BLEEX, values)


REFUSED = {
    UnreadableInputError: [
        ("gone.urdf", lambda: read_description("gone.urdf")),
        (str(Path(__file__).parent), lambda: Leg.from_urdf(Path(__file__).parent)),
        ("null", lambda: read_description("a\0b")),
        *(("leg.urdf", lambda text=text: leg(text)) for text in (*NOT_XML, *NO_LEG)),
        *((word, lambda text=text: leg(text)) for word, text in (*BROKEN, *NUMBERS)),
        ("'torso'", weightless),
    ],
    BadArgumentError: [
        ("did you mean 'knee'", lambda: leg(joints=("hip", "kne"))),
        ("'zzz'", lambda: leg(joints=("hip", "zzz"))),
        ("'elbow'", lambda: leg(joints=("hip",), elbow=0.3)),
        ("it has knee", lambda: leg(replaced('type="revolute"', 'type="fixed"'))),
        *((f"{n} degrees", lambda x=x: leg(free(x))) for x, n in (('"floating"', 6), ('"planar"', 3))),
        *(("order", lambda x=x: leg(joints=x)) for x in (("knee", "hip"), ("hip", "hip"), ("hip", "knee", "hip"))),
        *(("names", lambda x=x: leg(joints=x)) for x in ("hip", "", (), [], (0, 1), ("hip", None))),
        ("'knee'", lambda: leg(knee=0.1)),
        *(("finite", lambda x=x: leg(joints=("hip",), knee=x)) for x in (np.nan, np.inf)),
        ("moves", lambda: leg(URDF.replace('"revolute"', '"fixed"'), None)),
        ("moves", lambda: leg(joints=None, hip=0.0, knee=0.0)),
        *(("'hal'", lambda x=x: x("hal")) for x in (exoid.load_leg, exoid.load_exo)),
        *(("bleex, cuhk", lambda x=x: exoid.load_leg(x)) for x in ("", "BLEEX")),
        *((repr(x), lambda x=x: exoid.load_leg("bleex", side=x)) for x in ("both", "Left", None)),
        ("cad, identified", lambda: exoid.load_leg("bleex", inertias="nominal")),
        ("nominal", lambda: exoid.load_exo("cuhk", "cad")),
        ("'flying'", lambda: exoid.load_exo("bleex", base="flying")),
        *(
            ("9 finite", lambda x=x: BLEEX.with_parameters(x))
            for x in ([1.0] * 8, [1.0] * 10, [[1.0] * 9], 1.0, [], [np.nan, *[1.0] * 8], [np.inf] * 9)
        ),
        *(
            ("(N, 3)", lambda x=x, k=k, f=f: f(*(np.zeros(x) if j == k else SAMPLES for j in range(3))))
            for x in ((4, 2), (4, 4), (3, 4), (5, 3), (4, 3, 1), (4,), (0,), ())
            for k in range(3)
            for f in (BLEEX.regressor, BLEEX.inverse_dynamics)
        ),
        *(("(N, 3)", lambda x=x: BLEEX.regressor(*np.zeros((3, *x)))) for x in ((4, 3, 1), (4, 2), (3,) * 4, (2,))),
        *(
            ("(N, 3)", lambda f=f: f(SAMPLES[:, :2]))
            for f in (BLEEX.mass_matrix, BLEEX.gravity, BLEEX.forward_kinematics)
        ),
        *(
            ("numbers", lambda x=x: BLEEX.regressor(x, x, x))
            for x in ("a", [[1, 2, 3], [3]], [["x"] * 3], [[object()] * 3], {"hip": 1.0})
        ),
        ("did you mean 'left_foot'", lambda: EXO.frame_jacobian(np.zeros(6), "left_fot")),
        *(
            ("the point is", lambda x=x: EXO.frame_jacobian(np.zeros(6), "left_foot", x))
            for x in ((1.0, 2.0), (1.0, 2.0, np.nan))
        ),
        *(("4 samples", lambda x=x: torso(hip_acceleration=np.zeros(x))) for x in ((3, 2), (4, 3))),
        *(("finite", lambda x=x: torso(**{x: np.nan})) for x in ("pitch", "pitch_rate", "pitch_acceleration")),
        ("(5, 2)", lambda: base(*[(5, 2)] * 3)),
        ("(4, 3)", lambda: base((5, 3), (4, 3), (5, 3))),
        *(
            ("5 samples", lambda f=f: f(SAMPLES, SAMPLES, SAMPLES, base(*[(5, 3)] * 3)))
            for f in (BLEEX.regressor, BLEEX.inverse_dynamics)
        ),
        ("'torso'", lambda: payload_torque(EXO, (Payload("torso", 1.0),), Motion(STILL, STILL, STILL, None))),
        *(("values", lambda x=x: lifted(x)) for x in (np.ones(8), np.full(9, np.inf), "hello")),
        *(("covariance", lambda x=x: lifted(-np.ones(9), x)) for x in (np.eye(8), np.full((9, 9), np.nan), -np.eye(9))),
        *(("pull", lambda x=x: lifted(pull=x)) for x in (-1.0, np.nan)),
        *(("mass factor", lambda x=x: lifted(mass_factor=x)) for x in (1.0, np.nan, -5.0)),
        *(
            ("values", lambda x=x: check_physical(BLEEX, x))
            for x in (np.ones(8), np.full(9, np.nan), "hello", np.ones((9, 9)))
        ),
        ("left, right", lambda: published.bleex().tables["II"].column("middle")),
        ("left, right", lambda: published.bleex_parameters("identified")),
    ],
    NotSupportedError: [
        *(
            ("'hip'", lambda x=x, joints=joints: leg(free(x, below="hip"), joints))
            for x in ('"floating"', '"planar"')
            for joints in (None, ("hip",))
        ),
        ("rig", lambda: exoid.rig.Plant.build(FLOATING)),
        ("control", lambda: ControlModel.of(FLOATING)),
        ("excitation", lambda: plan_excitation(FLOATING)),
        *(("'screw'", lambda x=x: screw(x)) for x in (pin.JointModelSpherical(), pin.JointModelHX(0.1))),
    ],
    NotIdentifiableError: [
        *(("Y2", lambda x=x: absurd(x)) for x in (1e14, 1e200, 1e308)),
        ("rounding", lambda: nearly_coaxial(3e-4, last=True)),
    ],
}


@pytest.mark.parametrize(("kind", "word", "call"), [(kind, *row) for kind, rows in REFUSED.items() for row in rows])
def test_it_is_refused_by_its_kind_and_named(kind, word, call):
    assert word in str(refused(kind, call))


def test_refusals_know_their_file_and_their_joints():
    for call, attribute, value in (
        (lambda: describe("", "bad.urdf"), "file", "bad.urdf"),
        (lambda: leg(joints=("hip", "kne")), "joints", ("kne",)),
    ):
        error = refused(exoid.ExoidError, call)
        assert (getattr(error, attribute), bool(error.remedy)) == (value, True)
