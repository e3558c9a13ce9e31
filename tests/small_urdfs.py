"""Small URDFs as text: a good leg to spoil, two joints on a torso, and an arm."""

from collections.abc import Sequence

from exoid import Leg
from exoid.leg.description import describe

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

OFFSET_BODY = BODY.replace("0 0 -0.2", "0.01 0.02 -0.1").replace('value="2"', 'value="1"')
"""A body whose centre of mass is beside every axis."""


def replaced(old: str, new: str) -> str:
    """The good URDF with one piece changed, once."""
    assert old in URDF
    return URDF.replace(old, new, 1)


def bomb() -> str:
    """A billion laughs."""
    entities = "".join(f'<!ENTITY l{k} "{f"&l{k - 1};" * 10}">' for k in range(1, 10))
    return f'<!DOCTYPE robot [<!ENTITY l0 "lol">{entities}]><robot name="&l9;">{LINKS}{HIP}{KNEE}</robot>'


def endless(joined: bool, count: int = 100_000) -> str:
    """A chain so long, or as many loose links."""
    links = "".join(f'<link name="l{k}"/>' for k in range(count + 1))
    joints = "".join(
        f'<joint name="j{k}" type="fixed"><parent link="l{k}"/><child link="l{k + 1}"/></joint>'
        for k in range(count if joined else 1)
    )
    return f'<robot name="r">{links}{joints}</robot>'


def nearly_coaxial(offset: float, *, last: bool) -> Leg:
    """Two vertical joints a tiny offset apart, and where wanted a third that is turned."""
    third = (
        f'<link name="d">{OFFSET_BODY}</link><joint name="three" type="continuous">'
        '<origin xyz="0.1 0.2 0.3" rpy="0.3 0.4 0.5"/><parent link="c"/><child link="d"/><axis xyz="0 0 1"/></joint>'
    )
    return Leg.from_description(
        describe(
            f'<robot name="r"><link name="a"/><link name="b">{OFFSET_BODY}</link><link name="c">{OFFSET_BODY}</link>'
            '<joint name="one" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>'
            f'<joint name="two" type="continuous"><origin xyz="{offset!r} 0 -0.3"/><parent link="b"/><child link="c"/>'
            f'<axis xyz="0 0 1"/></joint>{third if last else ""}</robot>',
            name="coaxial.urdf",
        )
    )


def spatial_arm(names: Sequence[str]) -> Leg:
    """Joints about z, y and x, one behind the other, whose links lie beside every axis."""
    links = "".join(f'<link name="{name}_link">{OFFSET_BODY}</link>' for name in names)
    joints = "".join(
        f'<joint name="{name}" type="continuous"><origin xyz="0.1 0.05 0.3"/><parent link="{before}"/>'
        f'<child link="{name}_link"/><axis xyz="{axis}"/></joint>'
        for name, before, axis in zip(
            names, ["base", *(f"{name}_link" for name in names)], ("0 0 1", "0 1 0", "1 0 0"), strict=False
        )
    )
    return Leg.from_description(describe(f'<robot name="arm"><link name="base"/>{links}{joints}</robot>'))
