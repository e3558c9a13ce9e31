"""Result of an identification: an estimate that prints, saves and exports itself."""

from __future__ import annotations

import os
from typing import Any

from exoid.codegen import CSource, write_c
from exoid.codegen.drives import with_form_in_c
from exoid.leg.lift.lift import PULL
from exoid.leg.lift.lumping import MASS_FACTOR
from exoid.tools.files import refuse_content, write_whole
from exoid.tools.tables import DataTable, Report

from .data import EstimateData
from .export import Export, export_urdf
from .file import estimate_text, estimate_to_json, read_estimate
from .mjcf import MjcfExport, export_mjcf
from .text import provenance, report


class Estimate(Report, EstimateData):
    """Identified parameters of a leg with their covariance; prints itself as a table.

    See :class:`EstimateData` for the attributes: :attr:`values`, :attr:`std`, :attr:`covariance`, :attr:`names` and
    the evidence behind them.

    Example:
        >>> data = exoid.datasets.bleex_swing()
        >>> estimate = exoid.identify(data.leg, data.train)
        >>> print(f"{estimate['X1'].value:.2f} {estimate['X1'].unit}")
        3.98 kg·m
    """

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the estimate as JSON, whole or not at all; see :meth:`load`.

        Args:
            path: File to write.

        Raises:
            ExoidError: The file cannot be written.
        """
        refuse_content(path, [each.sha256 for each in self.inputs if each.sha256])
        write_whole(path, [estimate_text(self)])

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Estimate:
        """Read an estimate that :meth:`save` wrote; it contains the URDF, so it needs no other file.

        Args:
            path: File that :meth:`save` wrote.

        Returns:
            The estimate, equal to the saved one to the last bit.

        Raises:
            ExoidError: The file is unreadable or not an estimate.
        """
        return read_estimate(path, cls)

    def to_json(self) -> dict[str, Any]:
        """Turn the estimate into what JSON can hold, values by name.

        Returns:
            All that a file of :meth:`save` has: what :meth:`load` needs, and figures for other programs.
        """
        return estimate_to_json(self)

    def to_urdf(self, path: str | os.PathLike[str], *, pull: float = PULL, mass_factor: float = MASS_FACTOR) -> Export:
        """Write the leg's URDF with identified inertias and friction.

        Inertias of the moving links are those that can exist, reproduce the estimate and are nearest to the URDF's own
        (:func:`exoid.leg.lift.lift`). Where none can exist with masses near the URDF's, the estimate moves: within its
        errors, and towards the URDF's links as the pull says. Coulomb and
        viscous friction go into ``<dynamics friction= damping=>`` where they were identified. A URDF has no place for
        rotor inertia, offset and stiffness: :meth:`save` has, and :meth:`to_mjcf` has rotors. A rotor inertia that is
        regrouped into an inertia (J1 at the hip) stays there, unless ``identify(known={"Ia_hip": …})`` took it out.
        Everything else in the URDF stays as it is; file names of
        meshes too, so a URDF with relative ones belongs into the same folder.

        Args:
            path: The URDF to write, whole or not at all.
            pull: Weight of the URDF's own links where the estimate is not that of possible links: χ²/2 + pull · D is
                least, with D the divergence of the links. At 1 their inertias count as known to 50 %.
            mass_factor: Largest factor by which the mass of a link may change, above 1; ``math.inf`` for any.

        Returns:
            What was written, which prints itself: where the parameters are, and by how much they had to move.

        Raises:
            ExoidError: A link would be heavier or lighter than in the URDF by more than the mass factor, the file
                cannot be written, or it is the URDF that was identified.
        """
        return export_urdf(self, path, pull=pull, mass_factor=mass_factor)

    def to_mjcf(
        self, path: str | os.PathLike[str], *, pull: float = PULL, mass_factor: float = MASS_FACTOR
    ) -> MjcfExport:
        """Write the leg as MuJoCo's model file (MJCF), by MuJoCo's own converter, on a base that does not move.

        MuJoCo reads the URDF of :meth:`to_urdf`, with ``damping`` and ``frictionloss``. Rotor inertia, which a URDF
        cannot hold, becomes ``armature``. Each identified joint has a motor of its name. Shapes are left out. MuJoCo
        writes six digits. Needs MuJoCo: ``pip install 'exoid[ground]'``.

        Args:
            path: The file to write, such as ``leg.xml``.
            pull: See :meth:`to_urdf`.
            mass_factor: See :meth:`to_urdf`.

        Returns:
            What was written, which prints itself: what MuJoCo's joints have no place for.

        Raises:
            ExoidError: MuJoCo is not installed or refuses the bodies, the base floats, a link would be heavier or
                lighter than in the URDF by more than the mass factor, or the file cannot be written.
        """
        return export_mjcf(self, path, pull=pull, mass_factor=mass_factor)

    def to_c(self, path: str | os.PathLike[str], *, precision: str = "double", name: str | None = None) -> CSource:
        """Write the torques of a leg as one C99 file that needs nothing but ``<math.h>``.

        Gravity, friction, springs and offsets, mass matrix, rigid bodies, and all together (:meth:`torque`) are
        functions ``<name>_gravity(q, tau)`` and so on, without state or allocation, for a microcontroller. With drives,
        ``<name>_command(q, v, tau, command)`` turns torques into currents or forces; where a drive has no form in C, a
        warning says why that function is missing. The comment at the top says where the numbers come from.

        Args:
            path: The file to write, whole or not at all.
            precision: "double" or "float".
            name: Prefix of every name in it; None for the file's.

        Returns:
            What was written, which prints itself.

        Raises:
            ExoidError: The base of the leg floats, a term has no form in C, or the file cannot be written.
        """
        actuators, warnings = with_form_in_c(self.actuators)
        return write_c(
            path,
            self.model,
            self.values,
            provenance=provenance(self),
            warnings=(*self.warnings, *warnings),
            precision=precision,
            name=name,
            actuators=actuators,
        )

    def __repr__(self) -> str:
        """Name the parameters."""
        return f"Estimate({', '.join(f'{n}={v:.4g}' for n, v in zip(self.names, self.values, strict=True))})"

    def _report(self) -> list[DataTable | str]:
        """Table of the parameters, followed by what the reader should know before trusting it."""
        return report(self)
