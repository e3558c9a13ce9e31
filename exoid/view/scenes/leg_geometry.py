"""Geometry of a leg in a scene: its bodies, their visuals, and the commands that draw them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray
from exoid.errors import NotIdentifiableError
from exoid.estimate import Estimate
from exoid.leg.leg import Leg
from exoid.leg.lift import lift
from exoid.leg.lift.lift import PULL
from exoid.leg.lift.lumping import MASS_FACTOR, MassChange, distribute_bodies, refuse_mass_changes
from exoid.leg.reduction.planar_machine import SIDES
from exoid.leg.rewriting import read_inertials
from exoid.view.colours import CAD, IDENTIFIED, joint_colour

from .commands import ROOT, Command, child_path, set_object, set_transform
from .placeholders import FRAME, body_placeholder
from .skeleton import Skeleton
from .transforms import align_z, homogeneous
from .urdf_visuals import read_visuals
from .visual import Material, Visual, cylinder, ellipsoid, torus

STEEL = 7850.0
"""Density of the balls that represent masses [kg/m³]."""


class Inertias(NamedTuple):
    """Inertias of the moving bodies from one source."""

    label: str  # name of the source
    colour: str  # colour of their visuals
    bodies: tuple[pin.Inertia, ...]  # inertias about the frames of the joints, n of them


@dataclass(frozen=True, eq=False)
class LegGeometry:
    """A leg in a scene."""

    skeleton: Skeleton  # bodies and joints
    root: str  # path of the torso
    visuals: tuple[tuple[Visual, ...], ...]  # visuals of each body in its frame, the torso first
    inertias: tuple[Inertias, ...]  # inertias from one or two sources
    notes: tuple[str, ...]  # one sentence for each visual that could not be drawn

    @classmethod
    def of(cls, source: Leg | Estimate, identified: Sequence[Leg], folder: Path | None) -> LegGeometry:
        """Make the geometry of a leg, or of an estimate with the physically consistent links nearest to it."""
        leg = source if isinstance(source, Leg) else source.model.leg
        skeleton = Skeleton(leg)
        visuals, notes = _visuals(skeleton, folder)
        inertias = [Inertias("CAD", CAD, tuple(leg.model.inertias)[1:])]
        if isinstance(source, Estimate):
            bodies, refused = _lifted(source)
            inertias.append(Inertias("identified", IDENTIFIED, bodies))
            notes += refused
        else:
            others = [other for other in identified if other.joint_names == leg.joint_names]
            inertias += [Inertias("identified", IDENTIFIED, tuple(other.model.inertias)[1:]) for other in others[:1]]
        sides = [side for side in SIDES if all(name.startswith(side) for name in leg.joint_names)]
        name = f"{sides[0].removesuffix('_')} leg" if sides else Path(leg.description.name).stem
        return cls(skeleton, child_path(ROOT, name), visuals, tuple(inertias), notes)

    @property
    def leg(self) -> Leg:
        """The leg."""
        return self.skeleton.leg

    @property
    def joint_colours(self) -> list[str]:
        """Colour of each joint."""
        return [joint_colour(joint) for joint in range(len(self.leg.tree_joint_names))]

    @property
    def joint_paths(self) -> tuple[str, ...]:
        """Path of each joint's frame; its body is the child "body"."""
        paths = [self.root]
        for name, parent in zip(self.leg.tree_joint_names, self.skeleton.parents, strict=True):
            paths.append(child_path(paths[parent] if parent == 0 else f"{paths[parent]}/body", name))
        return tuple(paths[1:])

    @property
    def body_paths(self) -> tuple[str, ...]:
        """Path of each body, the torso first."""
        return (self.root, *(f"{joint}/body" for joint in self.joint_paths))

    def pose(self, q: FloatArray) -> Iterator[Command]:
        """Commands that place the frames of the joints on their parent bodies, and move them to angles [rad], (n,)."""
        placed = zip(self.joint_paths, self.skeleton.placements, strict=True)
        moved = zip(self.body_paths[1:], self.skeleton.joint_transforms(q)[0], strict=True)
        for path, transform in (*placed, *moved):
            yield set_transform(path, transform)

    def draw_bodies(self) -> Iterator[Command]:
        """Commands that draw the bodies."""
        for path, visuals in zip(self.body_paths, self.visuals, strict=True):
            if visuals:
                yield set_object(f"{path}/shape", visuals)

    def draw_axes(self) -> Iterator[Command]:
        """Commands that draw the axes of the joints as rods."""
        reach = self.skeleton.reach
        for path, axis, colour in zip(self.joint_paths, self.skeleton.axes, self.joint_colours, strict=True):
            rod = cylinder(0.004 * reach, 0.3 * reach, Material(colour, finish="flat"))
            yield set_object(f"{path}/axis", [rod.placed(homogeneous(np.zeros(3), align_z(axis)))], shadows=False)

    def draw_loops(self) -> Iterator[Command]:
        """Commands that draw the ends of closed loops as balls, one for each of the two bodies."""
        ball = ellipsoid(0.02 * self.skeleton.reach, FRAME)
        for body, path in enumerate(self.body_paths):
            if points := self.skeleton.loop_points(body):
                yield set_object(f"{path}/loops", [ball.placed(homogeneous(point)) for point in points], shadows=False)

    def draw_masses(self) -> Iterator[Command]:
        """Commands that draw the centres of mass from all sources as balls."""
        for inertias in self.inertias:
            for path, inertia in zip(self.body_paths[1:], inertias.bodies, strict=True):
                radius = (3.0 * inertia.mass / (4.0 * np.pi * STEEL)) ** (1.0 / 3.0)
                ball = ellipsoid(radius, Material(inertias.colour)).placed(homogeneous(inertia.lever))
                yield set_object(f"{path}/mass {inertias.label}", [ball], shadows=False)

    def draw_inertias(self, inertias: Inertias) -> Iterator[Command]:
        """Commands that draw the inertias from one source as ellipsoids with three rings."""
        # Fillings mix their colours where ellipsoids overlap; rings keep theirs.
        ring = torus(1.0, 0.012, 2.0 * np.pi, Material(inertias.colour, finish="flat"))
        turns = [homogeneous(np.zeros(3), np.roll(np.eye(3), axis, axis=0)) for axis in range(3)]
        for path, inertia in zip(self.body_paths[1:], inertias.bodies, strict=True):
            body = inertia_ellipsoid(inertia, inertias.colour)
            rings = [ring.placed(body.transform @ turn) for turn in turns]
            yield set_object(f"{path}/inertia {inertias.label}", [body, *rings], shadows=False)

    def bounding_points(self, q: FloatArray, *, ellipsoids: bool = False) -> FloatArray:
        """Points of the torso's frame whose convex hull contains the leg at all angles (F, n) [rad], (k, 3)."""
        placements = self.skeleton.body_placements(q)
        corners = [[visual.bounding_points for visual in visuals] for visuals in self.visuals]
        for inertias in self.inertias if ellipsoids else ():
            for of_body, inertia in zip(corners[1:], inertias.bodies, strict=True):
                place = inertia_ellipsoid(inertia, inertias.colour).transform  # its columns are the semi-axes
                of_body.append(place[:3, 3] + np.vstack([place[:3, :3].T, -place[:3, :3].T]))
        placed = [
            np.einsum("fij,kj->fki", placements[:, body, :3, :3], each) + placements[:, body, np.newaxis, :3, 3]
            for body, of_body in enumerate(corners)
            if of_body
            for each in [np.vstack(of_body)]
        ]
        return np.vstack([each.reshape(-1, 3) for each in placed])


def _visuals(skeleton: Skeleton, folder: Path | None) -> tuple[tuple[tuple[Visual, ...], ...], tuple[str, ...]]:
    """Visuals of every body from the URDF, else placeholders; and notes."""
    links = [name for links in skeleton.links for name in links]
    by_link, notes = read_visuals(skeleton.leg.description, links, folder)
    bodies = []
    for body, placements in enumerate(skeleton.links):
        visuals = [visual.placed(where) for name, where in placements.items() for visual in by_link.get(name, ())]
        if not visuals:
            visuals = body_placeholder(skeleton, body, joint_colour(body - 1)) if body else []
        bodies.append(tuple(visuals))
    return tuple(bodies), notes


def _lifted(estimate: Estimate) -> tuple[tuple[pin.Inertia, ...], tuple[str, ...]]:
    """Physically consistent inertias nearest to the estimate, and a note if no export writes them."""
    leg = estimate.model.leg
    p = len(leg.parameter_names)
    lifted = lift(leg, estimate.values[:p], estimate.covariance[:p, :p], pull=PULL, mass_factor=MASS_FACTOR)
    moving = lifted.link_parameters[-len(leg.tree_joint_names) :]
    links, before = distribute_bodies(leg, lifted.link_parameters, MASS_FACTOR), read_inertials(leg.description)
    masses = [MassChange(name, float(before[name][0]), float(pi[0])) for name, pi in links.items()]
    notes = tuple[str, ...]()
    try:
        refuse_mass_changes(masses, MASS_FACTOR, leg.description.name)
    except NotIdentifiableError as error:
        notes = (f"identified inertias are not exported: {error.what}",)
    return tuple(pin.Inertia.FromDynamicParameters(row) for row in moving), notes


def inertia_ellipsoid(inertia: pin.Inertia, colour: str) -> Visual:
    """Make the ellipsoid of uniform density that has the body's mass and inertia."""
    # About its principal axes I_x = m (b² + c²)/5, and likewise for y and z. Hence a² = 5 (I_y + I_z − I_x)/2m.
    moments, axes = np.linalg.eigh(inertia.inertia)
    squares = 2.5 * (moments.sum() - 2.0 * moments) / inertia.mass
    semi_axes = np.sqrt(np.maximum(squares, 0.0))
    axes[:, 2] *= np.sign(np.linalg.det(axes))  # right-handed
    # Bodies that cannot exist have semi-axes of zero.
    drawn = np.maximum(semi_axes, 0.03 * max(float(semi_axes.max()), 1e-3))
    return ellipsoid(drawn, Material(colour, opacity=0.14)).placed(homogeneous(inertia.lever, axes))
