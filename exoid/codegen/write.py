"""Writers of C: a leg with its terms, or a control law."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, TypedDict

from exoid._typing import ArrayLike
from exoid.actuators import Actuators
from exoid.errors import BadArgumentError
from exoid.tools.files import write_whole
from exoid.torques import TorqueModel

from .dialect import Dialect
from .law_in_c import law_in_c
from .law_source import law_source
from .leg_source import leg_source
from .safety import Safety
from .source import CSource

if TYPE_CHECKING:
    from typing_extensions import Unpack


class SourceOptions(TypedDict, total=False):
    """Options of :func:`c_source` and :func:`write_c`."""

    provenance: Sequence[str]
    warnings: Sequence[str]
    precision: str
    name: str | None
    safety: Safety | None
    actuators: Actuators | None


def c_source(
    source: TorqueModel | object,
    values: ArrayLike | None = None,
    *,
    provenance: Sequence[str] = (),
    warnings: Sequence[str] = (),
    precision: str = "double",
    name: str | None = None,
    safety: Safety | None = None,
    actuators: Actuators | None = None,
) -> CSource:
    """Turn the torques of a leg, or a control law, into C99, without writing files.

    The functions of a leg compute τ = W(q, v, a) β of :class:`exoid.torques.TorqueModel`, whole and in parts. A law has
    one function for its step, with limits, a watchdog and a safe torque.

    Args:
        source: Leg and terms that have a form in C (:func:`register_c_form`); or a law or observer
            that has a form in C: one with a method ``in_c``, which takes a :class:`Dialect` and returns a
            :class:`LawInC`.
        values: Parameters β of a leg in SI units, in the order of ``source.names``, (P,).
        provenance: Lines on the origin of the values, for the comment at the top: an estimate's estimator, data,
            warnings and standard deviations. No line can end the comment.
        warnings: Warnings about the values. The result prints them; the file has only the provenance.
        precision: "double" or "float".
        name: Prefix of every name in C, "leg" or "law" by default; characters that no identifier can have are replaced.
        safety: Watchdog and safe torque of a law; None for damping and 50 ms.
        actuators: Drives of the leg; the function ``command`` then turns torques into currents, forces or motor angles.

    Returns:
        Text of the files, with model or law.

    Raises:
        ExoidError: The base of the leg floats; the law, a term or a drive has no form in C; the
            values are not P finite numbers; the safe torque does not fit; or a name or number cannot be written.

    Example:
        >>> leg = exoid.load_leg("cuhk")
        >>> c_source(TorqueModel(leg, ()), leg.parameters, precision="float").functions[:2]
        ('leg_gravity', 'leg_friction')
        >>> from exoid.control import pd
        >>> c_source(pd((22.0, 56.0), (2.2, 5.6))).functions
        ('law_init', 'law_step')
    """
    dialect = Dialect(precision)
    if isinstance(source, TorqueModel):
        return leg_source(
            source, values, dialect, "leg" if name is None else name, actuators, provenance, tuple(warnings)
        )
    law = law_in_c(source, dialect)
    prefix = "law" if name is None else name
    return law_source(law, dialect, prefix, safety or Safety(), provenance, tuple(warnings), actuators)


def write_c(
    path: str | os.PathLike[str],
    source: TorqueModel | object,
    values: ArrayLike | None = None,
    **options: Unpack[SourceOptions],
) -> CSource:
    """Write the torques of a leg as one C99 file, or a control law as one and a header beside it.

    Limits of torque and rate are those of :class:`exoid.control.Limited` around the law.

    Args:
        path: File to write, such as ``law.c``; the header of a law is ``law.h``.
        source: Leg and terms, or a law; see :func:`c_source`.
        values: Parameters of a leg, (P,).
        **options: Those of :func:`c_source`; ``name`` is that of the file if it is None.

    Returns:
        The text that was written, with its file.

    Raises:
        ExoidError: As for :func:`c_source`, the file of a law does not end in ``.c``, or it cannot be written.
    """
    if not isinstance(source, TorqueModel) and Path(path).suffix != ".c":
        raise BadArgumentError("a law is a source and a header", where=str(path), remedy="name the source: LAW.c")
    options["name"] = options.get("name") or Path(path).name
    written = c_source(source, values, **options)
    _, *headers = written.files.items()  # the source may have another name than the prefix, as my-law.c
    files = {Path(path).name: written.text, **dict(headers)}
    for file, text in files.items():
        write_whole(path if file == Path(path).name else Path(path).with_name(file), [text])
    return replace(written, files=files, path=Path(path))
