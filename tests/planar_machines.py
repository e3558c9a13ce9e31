"""Random planar machines as URDF text: a torso with mass and several random chains, whose hips are anywhere."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from planar_chains import PLANES, Body, PlanarURDF, random_chain
from urdf_text import link_text

from exoid import Leg
from exoid.leg.description import describe

Array = NDArray[np.float64]

SEGMENTS = ("hip", "knee", "ankle")


@dataclass(frozen=True)
class PlanarMachineURDF:
    """Chains on one torso.

    Attributes:
        torso: What the root link weighs, in its axes.
        chains: The chains, with distinct names of joints.
    """

    torso: Body
    chains: tuple[PlanarURDF, ...]

    @property
    def plane(self) -> Array:
        return self.chains[0].plane

    @property
    def hip(self) -> Array:
        return self.plane.T @ self.chains[0].segments[0].offset

    @cached_property
    def text(self) -> str:
        inner = [chain.text.split('<link name="torso"/>\n')[1].removesuffix("\n</robot>") for chain in self.chains]
        return "\n".join(['<robot name="machine">', link_text("torso", self.torso), *inner, "</robot>"])

    def leg(self, *, base: str = "floating", cumulative: bool = True) -> Leg:
        return Leg.from_description(describe(self.text, name="machine.urdf"), cumulative=cumulative, base=base)

    def parameters(self, *, cumulative: bool = True) -> Array:
        """M, X0, Y0, J0 and those of the chains, summed over point masses: the definition without matrices."""
        chains = [chain.parameters(cumulative=cumulative) for chain in self.chains]
        torso = np.zeros(4)
        hanging = [(sum(_mass(segment) for segment in chain.segments), chain.segments[0]) for chain in self.chains]
        points = [(m, p - self.hip) for m, p in zip(self.torso.masses, self.torso.points, strict=True)]
        points += [(m, self.plane.T @ segment.offset - self.hip) for m, segment in hanging]
        for mass, point in points:
            x, _, z = self.plane @ point
            torso += mass * np.array([1.0, -z, x, x**2 + z**2])
        if cumulative:
            torso[3] += sum(values[2] for values in chains)
        return np.concatenate([torso, *chains])


def _mass(segment) -> float:
    return segment.body.mass + (segment.attached[1].mass if segment.attached else 0.0)


def random_machine(rng: np.random.Generator, lengths=(3, 2), names=("left_", "right_"), axis=None) -> PlanarMachineURDF:
    """Draw a machine with chains of the given lengths, hips up to half a metre apart each way."""
    axis = axis or str(rng.choice(list(PLANES)))
    chains = (
        PlanarURDF(
            random_chain(rng, length, axis=axis, continuous=True).segments,
            axis,
            tuple(name + segment for segment in SEGMENTS),
        )
        for length, name in zip(lengths, names, strict=True)
    )
    return PlanarMachineURDF(Body.random(rng), tuple(chains))
