"""Links and joints as URDF text, with every digit of their numbers."""

import numpy as np
import pinocchio as pin


def row(values) -> str:
    return " ".join(repr(float(value)) for value in values)


def link_text(name, body) -> str:
    """A link with a mass, a centre of mass, and an inertia about it in the axes of the link."""
    entries = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
    inertia = " ".join(f'{key}="{float(body.inertia[index])!r}"' for key, index in entries.items())
    return (
        f'<link name="{name}"><inertial><origin xyz="{row(body.centre)}"/>'
        f'<mass value="{float(body.mass)!r}"/><inertia {inertia}/></inertial></link>'
    )


def joint_text(name, kind, parent, child, place, axis=None, limits=(3.0, 100.0, 10.0)) -> str:
    """A joint at a point or placement; limits are those of position, either way, of effort and of speed."""
    place = place if isinstance(place, pin.SE3) else pin.SE3(np.eye(3), np.asarray(place))
    position, effort, speed = limits
    limit = f'<limit lower="{-position}" upper="{position}" effort="{effort}" velocity="{speed}"/>'
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{row(place.translation)}" rpy="{row(pin.rpy.matrixToRpy(place.rotation))}"/>'
        + ("" if axis is None else f'<axis xyz="{row(axis)}"/>')
        + (limit if kind in ("revolute", "prismatic") else "")
        + "</joint>"
    )
