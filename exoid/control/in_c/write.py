"""Header and source of a law in C99."""

from __future__ import annotations

import os
from collections.abc import Sequence

from exoid.codegen import Dialect
from exoid.codegen.laws import LawSource, Safety, law_source, write_law
from exoid.control.observers import TorqueObserver
from exoid.control.stateful import AnyLaw

from .forms import law_in_c


def write_c(
    path: str | os.PathLike[str],
    law: AnyLaw | TorqueObserver,
    *,
    precision: str = "double",
    safety: Safety | None = None,
    provenance: Sequence[str] = (),
    warnings: Sequence[str] = (),
) -> LawSource:
    """Write a law as one C99 source and one header, for a microcontroller.

    Limits of torque and rate are those of :class:`exoid.control.Limited` around the law.

    Args:
        path: Source to write, such as ``law.c``; the header ``law.h`` is written beside it.
        law: A law with or without memory, or an observer, that has a form in C; see :func:`register_law_in_c`.
        precision: "double" or "float".
        safety: Watchdog and safe torque; None for damping and 50 ms.
        provenance: Lines on the origin of the model, for the comment.
        warnings: Warnings about the model, for the result.

    Returns:
        The texts that were written.

    Raises:
        ExoidError: The law, a term of its model or its leg has no form in C, or a file cannot be written.
    """
    dialect = Dialect(precision)
    form = law_in_c(law, dialect)
    return write_law(path, form, dialect, safety=safety, provenance=provenance, warnings=warnings)


def c_source(
    law: AnyLaw | TorqueObserver,
    *,
    precision: str = "double",
    name: str = "law",
    safety: Safety | None = None,
    provenance: Sequence[str] = (),
    warnings: Sequence[str] = (),
) -> LawSource:
    """Turn a law into C99, without writing files.

    Args:
        law: See :func:`write_c`.
        precision: "double" or "float".
        name: Prefix of every name in C.
        safety: Watchdog and safe torque; None for damping and 50 ms.
        provenance: Lines on the origin of the model, for the comment.
        warnings: Warnings about the model, for the result.

    Returns:
        Header and source.

    Raises:
        ExoidError: The law, a term of its model or its leg has no form in C.

    Example:
        >>> from exoid.control import pd
        >>> print(c_source(pd((22.0, 56.0), (2.2, 5.6))).functions)
        ('law_init', 'law_step')
    """
    dialect = Dialect(precision)
    form = law_in_c(law, dialect)
    return law_source(form, dialect, name=name, safety=safety, provenance=provenance, warnings=warnings)
