"""Hostile and broken URDFs: each ends in one line that says what is wrong, where, and what to do."""

import hashlib
import math
import tracemalloc
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from planar_chains import random_chain

from exoid import ExoidError, Leg
from exoid.leg.catalog import urdf_folder
from exoid.leg.description import LARGEST_URDF, MOST_LINKS, Description, describe, read_description

BODY = (
    '<inertial><origin xyz="0 0 -0.2" rpy="0 0 0"/><mass value="2"/>'
    '<inertia ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.01"/></inertial>'
)
HIP = (
    '<joint name="hip" type="revolute"><origin xyz="0 0 1"/><parent link="torso"/><child link="thigh"/>'
    '<axis xyz="0 -1 0"/><limit lower="-1" upper="2" effort="9" velocity="8"/></joint>'
)
KNEE = (
    '<joint name="knee" type="revolute"><origin xyz="0 0 -0.4"/><parent link="thigh"/><child link="shank"/>'
    '<axis xyz="0 -1 0"/><limit lower="-2" upper="0" effort="9" velocity="8"/></joint>'
)
LINKS = f'<link name="torso"/><link name="thigh">{BODY}</link><link name="shank">{BODY}</link>'
URDF = f'<?xml version="1.0"?>\n<robot name="leg">{LINKS}{HIP}{KNEE}</robot>\n'


def replaced(old: str, new: str) -> str:
    """The good URDF with one piece changed, once."""
    assert old in URDF
    return URDF.replace(old, new, 1)


def refusal(action: Callable[[], object]) -> str:
    """The message of an ExoidError, which must be a single line with a place and a remedy."""
    with pytest.raises(ExoidError) as caught:
        action()
    message = str(caught.value)
    assert "\n" not in message
    assert ". To fix it: " in message
    return message


def test_the_urdf_that_the_others_spoil_is_good():
    leg = Leg.from_description(describe(URDF))
    assert leg.joint_names == ("hip", "knee")
    np.testing.assert_allclose(leg.parameters[[0, 3]], [2 * 0.2 + 2 * 0.4, 2 * 0.2])


def test_a_description_keeps_text_name_and_hash(tmp_path):
    path = tmp_path / "my leg.urdf"
    path.write_text(URDF, encoding="utf-8")
    description = read_description(path)
    assert (description.text, description.name) == (URDF, "my leg.urdf")
    assert description.sha256 == hashlib.sha256(URDF.encode()).hexdigest()
    assert description.child_links == {"hip": "thigh", "knee": "shank"}


# ------------------------------------------------------------------------------------------ the file


def test_a_missing_file_is_named(tmp_path):
    message = refusal(lambda: read_description(tmp_path / "gone.urdf"))
    assert message.startswith(f"{tmp_path / 'gone.urdf'}: the URDF cannot be read (No such file or directory)")
    assert "'bleex'" in message


def test_a_directory_is_not_a_urdf(tmp_path):
    assert "cannot be read (Is a directory)" in refusal(lambda: Leg.from_urdf(tmp_path))


def test_a_path_with_a_null_byte_is_refused():
    assert "the URDF cannot be read" in refusal(lambda: read_description("a\0b"))


def test_a_file_that_is_too_large_is_not_read_to_its_end(tmp_path):
    path = tmp_path / "huge.urdf"
    with path.open("wb") as file:
        file.truncate(50 * LARGEST_URDF)
    tracemalloc.start()
    try:
        assert "larger than 20 MB" in refusal(lambda: read_description(path))
        assert tracemalloc.get_traced_memory()[1] < 3 * LARGEST_URDF
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("encoding", ["utf-16", "latin-1"])
def test_a_file_that_is_not_utf_8_is_refused(tmp_path, encoding):
    path = tmp_path / "leg.urdf"
    path.write_bytes(URDF.replace('name="leg"', 'name="jambe pliée"').encode(encoding))
    assert "leg.urdf: not UTF-8 text (byte " in refusal(lambda: read_description(path))


def test_a_byte_order_mark_and_names_in_any_script_are_read(tmp_path):
    path = tmp_path / "leg.urdf"
    path.write_bytes(b"\xef\xbb\xbf" + URDF.replace("knee", "колено").encode())
    assert Leg.from_urdf(path).joint_names == ("hip", "колено")


def test_a_wrong_encoding_declaration_does_not_change_the_names():
    """The text is UTF-8 whatever it says of itself."""
    text = URDF.replace('version="1.0"', 'version="1.0" encoding="iso-8859-1"').replace("shank", "jambe_pliée")
    assert describe(text).child_links["knee"] == "jambe_pliée"


# -------------------------------------------------------------------------------------------- the XML


def bomb() -> str:
    """A billion laughs."""
    entities = "".join(f'<!ENTITY l{k} "{f"&l{k - 1};" * 10}">' for k in range(1, 10))
    return f'<!DOCTYPE robot [<!ENTITY l0 "lol">{entities}]><robot name="&l9;">{LINKS}{HIP}{KNEE}</robot>'


@pytest.mark.parametrize(
    "text",
    [
        bomb(),
        f'<!DOCTYPE robot [<!ENTITY x SYSTEM "file:///etc/hostname">]><robot name="r">&x;{LINKS}{HIP}{KNEE}</robot>',
        URDF.replace("<robot", '<!DOCTYPE robot SYSTEM "http://localhost:9/robot.dtd"><robot'),
        URDF.replace("<robot", "<!DOCTYPE robot><robot"),
    ],
    ids=["billion laughs", "external entity", "external DTD", "empty DTD"],
)
def test_entities_and_document_types_are_refused(text):
    assert "declares a document type or entities" in refusal(lambda: describe(text))


def test_entities_hidden_in_another_encoding_are_not_expanded_either():
    """UTF-7 spells <!DOCTYPE without a less-than sign."""
    hidden = bomb().replace("<!", "+ADwAIQ-")
    assert "not well-formed XML" in refusal(lambda: describe(f'<?xml version="1.0" encoding="utf-7"?>{hidden}'))


@pytest.mark.parametrize(
    "text",
    ["", " ", "hello", "<robot>", "<robot></Robot>", "<robot name='a' name='b'/>", "<robot/><robot/>", "\x00",
     "<robot>\x01</robot>", "<robot name='\ud800'/>", "<robot>&amp</robot>", "<robot>&undefined;</robot>",
     "<xacro:robot/>", "{'robot': 1}"],
    ids=repr,
)  # fmt: skip
def test_what_is_not_xml_is_refused(text):
    assert refusal(lambda: describe(text, "bad.urdf")).startswith("bad.urdf: not well-formed XML (")


def test_xml_nested_without_end_is_refused():
    assert "not well-formed XML" in refusal(lambda: describe("<robot>" + "<a>" * 500_000))


@pytest.mark.parametrize("root", ["sdf", "mujoco", "Robot", "html"])
def test_another_root_element_is_named(root):
    assert f"the root element is <{root}>, not <robot>" in refusal(lambda: describe(f"<{root}/>"))


@pytest.mark.parametrize(
    "command", ['<xacro:macro name="leg"/>', '<xacro:property name="L" value="1"/>', '<xacro:include filename="a"/>']
)
def test_xacro_is_to_be_expanded_first(command):
    text = URDF.replace("<robot ", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" ').replace(
        "</robot>", f"{command}</robot>"
    )
    assert "xacro leg.xacro > leg.urdf" in refusal(lambda: describe(text))


def test_an_expanded_urdf_may_still_declare_xacro():
    text = URDF.replace("<robot ", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" ')
    assert Leg.from_description(describe(text)).joint_names == ("hip", "knee")


# -------------------------------------------------------------------------------------- the structure


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('<robot name="r"><link name="a"/></robot>', "has no joints"),
        (replaced('type="revolute"', 'type="hinge"'), "joint 'hip': unknown type 'hinge'. To fix it: use one of"),
        (replaced('type="revolute"', ""), "joint 'hip': unknown type None"),
        (replaced('<parent link="thigh"/>', '<parent link="thihg"/>'),
         "joint 'knee': its <parent> 'thihg' is not a link. To fix it: links are torso, thigh, shank"),
        (replaced('<child link="shank"/>', '<child link="foot"/>'), "joint 'knee': its <child> 'foot' is not a link"),
        (replaced('<parent link="thigh"/>', ""), "joint 'knee': its <parent> None is not a link"),
        (replaced('<child link="shank"/>', "<child/>"), "joint 'knee': its <child> None is not a link"),
        (replaced('<link name="torso"/>', '<link name="shank"/>'), "names occur twice: shank"),
        (replaced('name="knee"', 'name="hip"'), "names occur twice: hip"),
        (replaced('<child link="shank"/>', '<child link="thigh"/>'), "link 'thigh' is the child of 2 joints"),
        (replaced('<link name="torso"/>', '<link name="torso"/><link name="spare"/>'),
         "links torso, spare are children of no joint"),
        (replaced('<parent link="torso"/>', '<parent link="shank"/>').replace('<link name="torso"/>', ""),
         "no link is the root"),
    ],
)  # fmt: skip
def test_a_broken_structure_names_the_joint_and_the_link(text, message):
    assert refusal(lambda: describe(text, "leg.urdf")).startswith(("leg.urdf: " + message, "leg.urdf, " + message))


@pytest.mark.parametrize("joined", [True, False], ids=["chain", "loose links"])
def test_a_robot_of_endless_links_is_refused(joined):
    """Pinocchio's parser would overflow the stack, and take the process with it."""
    count = 100_000
    links = "".join(f'<link name="l{k}"/>' for k in range(count + 1))
    joints = "".join(
        f'<joint name="j{k}" type="fixed"><parent link="l{k}"/><child link="l{k + 1}"/></joint>'
        for k in range(count if joined else 1)
    )
    message = refusal(lambda: describe(f'<robot name="r">{links}{joints}</robot>'))
    assert f"100001 links and {count if joined else 1} joints: more than 1000" in message


def test_the_longest_chain_allowed_is_read():
    links = "".join(f'<link name="l{k}"/>' for k in range(1, MOST_LINKS - 2))
    joints = "".join(
        f'<joint name="j{k}" type="fixed"><parent link="l{k}"/><child link="l{k + 1}"/></joint>'
        for k in range(1, MOST_LINKS - 3)
    )
    start = '<joint name="j0" type="fixed"><parent link="shank"/><child link="l1"/></joint>'
    text = URDF.replace("</robot>", f"{links}{start}{joints}</robot>")
    assert Leg.from_description(describe(text)).joint_names == ("hip", "knee")


# ---------------------------------------------------------------------------------------- the numbers


@pytest.mark.parametrize("number", ["nan", "inf", "-inf", "1e999", "", "two", "1,5", "0x10", "1_000", "1 2"])
@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('<mass value="2"/>', '<mass value="{}"/>', "leg.urdf, link 'thigh': <mass value="),
        ('iyy="0.02"', 'iyy="{}"', "leg.urdf, link 'thigh': <inertia iyy="),
        ('xyz="0 0 -0.2"', 'xyz="0 0 {}"', "leg.urdf, link 'thigh': <origin xyz="),
        ('xyz="0 0 -0.4"', 'xyz="{} 0 0"', "leg.urdf, joint 'knee': <origin xyz="),
        ('<axis xyz="0 -1 0"/>', '<axis xyz="0 {} 0"/>', "leg.urdf, joint 'hip': <axis xyz="),
        ('upper="2"', 'upper="{}"', "leg.urdf, joint 'hip': <limit upper="),
    ],
)
def test_a_number_that_is_none_is_refused_and_not_dropped(number, old, new, message):
    """Pinocchio's parser would leave the whole <inertial> out and go on without it."""
    found = refusal(lambda: describe(replaced(old, new.format(number)), "leg.urdf"))
    assert found.startswith(message)
    assert "finite number" in found


@pytest.mark.parametrize(
    "piece",
    ['<mass value="2"/>', ' value="2"', ' izz="0.01"', BODY[BODY.index("<inertia ") : BODY.index("</inertial>")]],
)
def test_an_inertial_that_lacks_something_is_refused_and_not_dropped(piece):  # fmt: skip
    message = refusal(lambda: describe(replaced(piece, ""), "leg.urdf"))
    assert message.startswith("leg.urdf, link 'thigh': ")


@pytest.mark.parametrize("gap", ["\n", "\t", "\n      ", "   ", "&#10;", "\u00a0"])
def test_numbers_may_be_parted_and_surrounded_by_any_blank(gap):
    """Pinocchio's own parser knows single spaces only, and would drop the <inertial>."""
    text = URDF.replace('xyz="0 0 -0.2"', f'xyz="0{gap}0{gap}-0.2"').replace('value="2"', f'value="{gap}2{gap}"')
    np.testing.assert_array_equal(
        Leg.from_description(describe(text)).parameters, Leg.from_description(describe(URDF)).parameters
    )


@pytest.mark.parametrize("axis", ["0 0 0", "0 1e-200 0"])
def test_an_axis_without_direction_is_refused_where_the_joint_moves(axis):
    spoilt = replaced('<axis xyz="0 -1 0"/>', f'<axis xyz="{axis}"/>')
    assert "joint 'hip': its <axis> is zero" in refusal(lambda: describe(spoilt))
    describe(spoilt.replace('type="revolute"', 'type="fixed"', 1))


def test_a_long_axis_is_as_good_as_a_unit_vector():
    long = Leg.from_description(describe(replaced('<axis xyz="0 -1 0"/>', '<axis xyz="0 -5 0"/>')))
    np.testing.assert_allclose(long.parameters, Leg.from_description(describe(URDF)).parameters, rtol=1e-15)


# ------------------------------------------------------------------------------- inertias of the model


def model_refusal(text: str, joints: tuple[str, ...] | None = ("hip", "knee"), **locked: float) -> str:
    return refusal(lambda: Leg.from_description(describe(text, "leg.urdf"), joints, locked=locked))


def test_a_moving_link_without_inertia_is_named_with_its_joint():
    without = URDF.replace(f'<link name="shank">{BODY}</link>', '<link name="shank"/>')
    message = model_refusal(without)
    assert message.startswith("leg.urdf, link 'shank': joint 'knee' moves a link of mass 0 kg: no <inertial>?")
    assert "an estimate from CAD" in message


def test_a_link_without_inertia_may_hang_on_a_fixed_joint():
    """And a locked one: what is lumped together needs a mass only as a whole."""
    without = URDF.replace(f'<link name="shank">{BODY}</link>', '<link name="shank"/>')
    assert Leg.from_description(describe(without), ("hip",)).parameter_names == ("X1", "Y1", "J1")


@pytest.mark.parametrize("mass", ["0", "-1", "0.0e5"])
def test_a_mass_that_is_not_positive_is_refused(mass):
    message = model_refusal(replaced('<mass value="2"/>', f'<mass value="{mass}"/>'))
    assert message.startswith("leg.urdf, link 'thigh': joint 'hip' moves a link of mass")


def test_an_inertia_that_overflows_is_refused():
    """Numbers up to the limit give finite inertias; larger ones are refused as text."""
    message = model_refusal(replaced('xyz="0 0 -0.2"', 'xyz="1e200 0 0"'))
    assert message.startswith("leg.urdf, link 'thigh': <origin xyz='1e200 0 0'> is not plausible")
    largest = replaced('xyz="0 0 -0.2"', 'xyz="1e9 0 0"')
    assert np.isfinite(Leg.from_description(describe(largest)).parameters).all()


def test_a_negative_principal_inertia_is_refused():
    for old, new in (('iyy="0.02"', 'iyy="-0.02"'), ('ixy="0"', 'ixy="0.05"')):
        message = model_refusal(replaced(old, new))
        assert message.startswith("leg.urdf, link 'thigh': a principal inertia is negative (-0.0")


def test_a_point_mass_is_allowed():
    point = URDF.replace('ixx="0.02"', 'ixx="0"').replace('iyy="0.02"', 'iyy="0"').replace('izz="0.01"', 'izz="0"')
    leg = Leg.from_description(describe(point))
    assert leg.parameters[5] == pytest.approx(2 * 0.2**2, rel=1e-15)


# ------------------------------------------------------------------------------------- choosing joints


def test_a_missing_joint_is_refused_with_the_closest_name():
    message = model_refusal(URDF, ("hip", "kne"))
    assert message == "leg.urdf: no moving joint 'kne'. To fix it: did you mean 'knee'? it has hip, knee"
    assert "did you mean" not in model_refusal(URDF, ("hip", "zzz"))
    assert "no moving joint 'elbow'" in model_refusal(URDF, ("hip",), elbow=0.3)


def test_a_fixed_joint_is_not_a_moving_one():
    fixed = replaced('type="revolute"', 'type="fixed"')
    assert model_refusal(fixed) == "leg.urdf: no moving joint 'hip'. To fix it: it has knee"


@pytest.mark.parametrize(("kind", "count"), [("floating", 6), ("planar", 3)])
def test_a_joint_of_several_degrees_of_freedom_is_refused(kind, count):
    text = replaced('type="revolute"', f'type="{kind}"')
    message = model_refusal(text)
    assert message.startswith(f"leg.urdf: joint 'hip' has {count} degrees of freedom")
    assert Leg.from_description(describe(text)).joint_names == ("knee",)


@pytest.mark.parametrize(("kind", "count"), [("floating", 6), ("planar", 3)])
@pytest.mark.parametrize("joints", [None, ("hip",)])
def test_a_joint_of_several_degrees_of_freedom_below_a_moving_one_is_not_taken_for_fixed(kind, count, joints):
    message = model_refusal(URDF.replace(KNEE, KNEE.replace('type="revolute"', f'type="{kind}"')), joints)
    assert message.startswith(f"leg.urdf: joint 'knee' has {count} degrees of freedom and is below the moving joint")
    assert "'hip'" in message
    assert "make it fixed" in message


def test_a_joint_of_several_degrees_of_freedom_on_another_branch_does_not_matter():
    ball = f'<link name="ball">{BODY}</link>' + KNEE.replace("knee", "loose").replace("thigh", "torso").replace(
        "shank", "ball"
    ).replace('type="revolute"', 'type="floating"')
    leg = Leg.from_description(describe(URDF.replace("</robot>", f"{ball}</robot>")))
    assert leg.joint_names == ("hip", "knee")
    assert leg.parameters == pytest.approx(Leg.from_description(describe(URDF)).parameters, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "exact"),
    [
        ("1.5708", math.pi / 2),
        ("-1.5707", -math.pi / 2),
        ("1.57", math.pi / 2),
        ("1.571", math.pi / 2),
        ("3.1416", math.pi),
        ("-3.14", -math.pi),
        ("0.7854", math.pi / 4),
        ("1.0472", math.pi / 3),
        ("157.08e-2", math.pi / 2),
        ("6.2832", 2 * math.pi),
        *(
            (text, float(text))
            for text in ("1.56", "1.58", "1.6", "3", "0.79", "0.785", "0.0001", "0", "-0.01", "15.71")
        ),
    ],
)
def test_angles_of_few_digits_that_stand_for_parts_of_pi_are_exact_in_the_model(text, exact):
    turned = describe(replaced('<origin xyz="0 0 1"/>', f'<origin xyz="0 0 1" rpy="0 {text} 0"/>'))
    placement = Leg.from_description(turned).model.jointPlacements[1]
    np.testing.assert_allclose(placement.rotation[0, 2], math.sin(exact), rtol=0, atol=1e-15)


def test_a_leg_whose_joints_are_turned_by_rounded_right_angles_is_planar():
    """Hip about y turned to x by 1.5708 and back: X, Y and J as of the leg with exact axes."""
    turned = URDF.replace('<origin xyz="0 0 -0.4"/>', '<origin xyz="0 0 -0.4" rpy="0 0 1.5708"/>').replace(
        '<child link="shank"/><axis xyz="0 -1 0"/>', '<child link="shank"/><axis xyz="-1 0 0"/>'
    )
    leg = Leg.from_description(describe(turned))
    assert leg.parameter_names == ("X1", "Y1", "J1", "X2", "Y2", "J2")


@pytest.mark.parametrize("joints", [("knee", "hip"), ("hip", "hip"), ("hip", "knee", "hip")])
def test_joints_in_another_order_or_repeated_are_refused(joints):
    message = model_refusal(URDF, joints)
    assert "are not in the order of the chain" in message
    right = tuple(name for name in ("hip", "knee") if name in joints)
    assert message.endswith(f"name each once, from the torso outwards: {right}")


@pytest.mark.parametrize("joints", ["hip", "", (), [], (0, 1), ("hip", None)])
def test_joints_must_be_several_names(joints):
    assert "joints must be names" in model_refusal(URDF, joints)


def test_a_joint_cannot_both_move_and_be_locked():
    with pytest.raises(ExoidError, match=r"leg\.urdf: \['knee'\] both move and are locked"):
        Leg.from_description(describe(URDF, "leg.urdf"), ("hip", "knee"), locked={"knee": 0.1})


@pytest.mark.parametrize("position", [np.nan, np.inf])
def test_a_locked_position_must_be_finite(position):
    with pytest.raises(ExoidError, match=r"leg\.urdf: a locked position is not finite"):
        Leg.from_description(describe(URDF, "leg.urdf"), ("hip",), locked={"knee": position})


def test_a_urdf_in_which_nothing_moves_is_refused():
    assert "no joint moves" in model_refusal(URDF.replace('"revolute"', '"fixed"'), None)
    assert "no joint moves" in model_refusal(URDF, None, hip=0.0, knee=0.0)


def test_a_joint_may_be_named_like_a_link_or_like_pinocchios_root():
    renamed = Leg.from_description(
        describe(URDF.replace('name="knee"', 'name="shank"')), ("shank",), locked={"hip": 0.1}
    )
    assert renamed.joint_names == ("shank",)


# --------------------------------------------------------------------------------------- anything else


def outcome(action: Callable[[], object]) -> object:
    """What an action returns, or the ExoidError that it ends in, whose message is one line; all else is raised."""
    try:
        return action()
    except ExoidError as error:
        lines = str(error).splitlines()
        return error if len(lines) == 1 else lines


@given(st.text())
@example("<robot><joint/></robot>")
@example("<robot><joint name='j' type='fixed'><parent/><child/></joint></robot>")
@example("<robot xmlns='x'/>")
@example("<?xml version='1.0' encoding='nonsense'?><robot/>")
def test_any_text_is_a_description_or_an_exoid_error(text):
    assert isinstance(outcome(lambda: describe(text)), Description | ExoidError)


@given(st.binary())
@example(b"\xff\xfe<\x00r\x00")
@example(b"<robot/>")
def test_any_file_is_a_description_or_an_exoid_error(tmp_path_factory, content):
    path = Path(tmp_path_factory.getbasetemp()) / "any.urdf"
    path.write_bytes(content)
    assert isinstance(outcome(lambda: read_description(path)), Description | ExoidError)


WORDS = st.sampled_from(
    ["<link ", "<joint ", "/>", "</joint>", "<parent ", "<child ", 'name="a"', 'name="b"', 'link="a"', 'link="b"', ">",
     'type="revolute"', 'type="fixed"', "<axis ", 'xyz="0 1 0"', 'xyz="0 0"', "<inertial>", "</inertial>", "<mass ",
     'value="1"', "<inertia ", "</link>", "<origin "]
)  # fmt: skip


@given(st.lists(WORDS, max_size=40).map("".join))
@example('<link name="a"/><link name="b"/><joint name="a" type="fixed"><parent link="a"/><child link="b"/></joint>')
def test_anything_made_of_urdfs_own_words_is_a_leg_or_an_exoid_error(words):
    text = f'<robot name="r">{words}</robot>'
    assert isinstance(outcome(lambda: Leg.from_description(describe(text))), Leg | ExoidError)


@given(seed=st.integers(0, 2**32 - 1), data=st.data())
def test_a_good_urdf_with_a_piece_missing_or_repeated_is_a_leg_or_an_exoid_error(seed, data):
    text = random_chain(np.random.default_rng(seed), 2).text
    start = data.draw(st.integers(0, len(text)))
    stop = data.draw(st.integers(start, min(len(text), start + 200)))
    cut, doubled = text[:start] + text[stop:], text[:stop] + text[start:]
    assert isinstance(outcome(lambda: Leg.from_description(describe(cut))), Leg | ExoidError)
    assert isinstance(outcome(lambda: Leg.from_description(describe(doubled))), Leg | ExoidError)


def test_built_in_urdfs_pass_every_check():
    for path in sorted(urdf_folder().glob("*.urdf")):
        assert Leg.from_urdf(path).description.name == path.name
