"""Writing an estimate as MuJoCo's own model file (MJCF): MuJoCo converts the exported URDF, and gets the rotors."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from lxml import etree

from exoid.errors import BadArgumentError, NotSupportedError
from exoid.leg.description import LARGEST_NUMBER
from exoid.leg.lift.lift import PULL
from exoid.leg.lift.lumping import MASS_FACTOR
from exoid.tools.extras import require_mujoco
from exoid.tools.files import refuse_unwritable, write_whole
from exoid.tools.tables import to_text
from exoid.torques import Armature, Coulomb, Term, Viscous

from .data import EstimateData
from .export import Export, export_urdf, places_of

PLACES: dict[tuple[type[Term], str], str] = {
    (Coulomb, "c0"): "frictionloss",
    (Viscous, "d"): "damping",
    (Armature, "Ia"): "armature",
}
"""Attribute of a joint in MJCF for a symbol of a type of term."""


STIFF = (0.004, 1.0), (0.9999, 0.9999, 1e-3, 0.5, 2.0)
"""Time constant [s] and damping ratio of closed loops, and their impedance: gaps below 0.1 mm."""


@dataclass(frozen=True, eq=False, repr=False)
class MjcfExport:
    """File that an export to MuJoCo wrote; prints itself.

    Attributes:
        path: The file.
        urdf: Export that MuJoCo converted, with the lift of the links.
        negative: Friction and rotor inertia below zero, which MuJoCo does not take: written as 0.
        left_out: Parameters that the file has no place for, such as the zeros of torque sensors.
    """

    path: Path
    urdf: Export
    negative: tuple[str, ...]
    left_out: tuple[str, ...]

    def to_json(self) -> dict[str, Any]:
        """Describe the export as JSON data.

        Returns:
            File, values, and what is not in the file as estimated.
        """
        return {
            "mjcf": str(self.path),
            "values": dict(zip(self.urdf.estimate.names, self.urdf.values.tolist(), strict=True)),
            "left_out": list(self.left_out),
            "raised_to_zero": list(self.negative),
            "feasible": self.urdf.lift.feasible,
        }

    def __repr__(self) -> str:
        """Name the file."""
        return f"MjcfExport({str(self.path)!r})"

    def __str__(self) -> str:
        """Print what is in the file, and what is not."""
        lines = [f"{self.path}: joints with a motor each, identified inertia, friction and rotors, on a fixed base"]
        lines += [f"note: {regrouped} (also in the file)" for regrouped in self.urdf.estimate.regrouped]
        if self.left_out:
            lines.append(f"note: MuJoCo's joints have no place for {', '.join(self.left_out)}: left out")
        if self.negative:
            lines.append(f"note: {', '.join(self.negative)} below zero: 0 in the file")
        if not self.urdf.lift.feasible:
            distance = self.urdf.lift.distance
            lines.append(f"note: no links have the estimated parameters; the nearest are {distance:.3g} std away")
        return to_text(*lines)


def export_mjcf(
    estimate: EstimateData, path: str | os.PathLike[str], *, pull: float = PULL, mass_factor: float = MASS_FACTOR
) -> MjcfExport:
    """Write an estimate as MJCF; see :meth:`Estimate.to_mjcf`."""
    mujoco, leg = require_mujoco(), estimate.model.leg
    if leg.base == "floating":
        raise NotSupportedError(
            "an MJCF of a floating base is not written",
            where=leg.description.name,
            remedy="write a URDF, and let MuJoCo's MjSpec add a free joint to its root",
            command="write a URDF with -o LEG.URDF",
        )
    refuse_unwritable(path)
    with TemporaryDirectory() as folder:
        export = export_urdf(estimate, Path(folder) / "leg.urdf", pull=pull, mass_factor=mass_factor)
        root = etree.parse(str(export.urdf)).getroot()
    for shape in [*root.iter("visual", "collision")]:  # meshes need not be where MuJoCo looks
        shape.getparent().remove(shape)
    value_of = dict(zip(estimate.names, export.values.tolist(), strict=True))
    places = {name: at for name, at in places_of(estimate.model, PLACES).items() if name in value_of}
    try:
        spec = mujoco.MjSpec.from_string(etree.tostring(root, encoding="unicode"))
        for joint, effort in zip(leg.joint_names, leg.limits.effort.tolist(), strict=True):
            motor = spec.add_actuator(name=joint, target=joint, trntype=mujoco.mjtTrn.mjTRN_JOINT)
            motor.set_to_motor()
            if 0.0 < effort < LARGEST_NUMBER:
                motor.ctrlrange, motor.ctrllimited = [-effort, effort], mujoco.mjtLimited.mjLIMITED_TRUE
        links = [leg.description.child_links[joint] for joint in leg.tree_joint_names]
        for k, pair in enumerate(leg.closure.pairs if leg.closure else ()):  # points that closed loops hold together
            name = f"{pair.loop.name} {k + 1}"
            for side, body, place in zip("12", pair.bodies, pair.places, strict=True):
                (spec.worldbody if body < 0 else spec.body(links[body])).add_site(name=f"{name} {side}", pos=place)
            connect, site = mujoco.mjtEq.mjEQ_CONNECT, mujoco.mjtObj.mjOBJ_SITE
            held = spec.add_equality(type=connect, objtype=site, name=name, name1=f"{name} 1", name2=f"{name} 2")
            held.solref, held.solimp = STIFF
        spec.compile()
    except ValueError as error:
        raise BadArgumentError(
            f"MuJoCo refuses these bodies ({error})",
            where=leg.description.name,
            remedy="check masses and moments of inertia: no link can have those given",
        ) from error
    root = etree.fromstring(spec.to_xml().encode())
    joints = {each.get("name"): each for each in root.iter("joint")}
    for joint in leg.joint_names:
        for attribute in set(PLACES.values()).intersection(joints[joint].attrib):
            del joints[joint].attrib[attribute]  # friction of the CAD goes, where none was identified
    for name, (k, attribute) in places.items():
        joints[leg.joint_names[k]].set(attribute, repr(max(0.0, value_of[name])))
    write_whole(path, [etree.tostring(root, encoding="unicode") + "\n"])
    left_out = tuple(name for name in estimate.names[len(leg.parameter_names) :] if name not in places)
    negative = tuple(name for name in places if value_of[name] < 0.0)
    return MjcfExport(Path(path), export, negative, left_out)
