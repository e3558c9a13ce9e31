"""Files that a verb writes: they can be written, differ from each other, and are no inputs."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping

from exoid.errors import ExoidError
from exoid.tools.files import refuse_input, refuse_unwritable


def check_outputs(
    outputs: Mapping[str, str | os.PathLike[str] | None], inputs: Iterable[str | os.PathLike[str] | None] = ()
) -> None:
    """Check files before the work for their content begins."""
    read = [each for each in inputs if each is not None]
    options: dict[str, str] = {}
    for option, path in outputs.items():
        if path is None:
            continue
        refuse_input(path, read)
        refuse_unwritable(path)
        rival = options.setdefault(os.path.realpath(path), option)
        if rival != option:
            raise ExoidError(f"{rival} and {option} name one file", where=str(path), remedy="give each its own name")
