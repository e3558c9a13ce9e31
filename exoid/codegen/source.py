"""From an estimate to one C99 file: the template, the numbers of the leg, and where they come from."""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from importlib import resources
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

from exoid.errors import ExoidError
from exoid.files import write_whole
from exoid.reduction import PlanarChain
from exoid.reduction.planar import GRAVITY
from exoid.tables import to_text

from .dialect import Dialect, comment, identifier
from .provenance import provenance
from .terms import Place, express, joint_terms

if TYPE_CHECKING:
    from exoid.estimate import Estimate

SCHEMA = "exoid-c-1"

TEMPLATE = "planar_leg.c.in"

FUNCTIONS = ("gravity", "friction", "stiffness", "mass_matrix", "rigid_bodies", "inverse_dynamics")
"""What every file has, after the prefix."""


@dataclass(frozen=True, eq=False, repr=False)
class CSource:
    """A leg written in C; prints itself.

    Attributes:
        text: The file.
        prefix: Of every name in it.
        dialect: Its precision.
        estimate: What it computes.
        path: Where it was written; None where it was not.
    """

    text: str
    prefix: str
    dialect: Dialect
    estimate: Estimate
    path: Path | None = None

    @property
    def functions(self) -> tuple[str, ...]:
        """Names of its functions."""
        return tuple(f"{self.prefix}_{name}" for name in FUNCTIONS)

    @cached_property
    def sha256(self) -> str:
        """Hash of the file."""
        return hashlib.sha256(self.text.encode()).hexdigest()

    def __repr__(self) -> str:
        """Name the file and the precision."""
        return f"CSource({str(self.path or self.prefix)!r}, {self.dialect.real!r})"

    def __str__(self) -> str:
        """Say what is in it and how to use it."""
        where = self.path or f"{self.prefix}.c"
        joints = ", ".join(self.estimate.joint_names)
        return to_text(
            f"{where}: {self.dialect.real} precision, C99, needs <math.h> only; joints in the order {joints}",
            f"functions: {', '.join(self.functions)}",
            f"to call them from another file: #define {self.prefix.upper()}_DECLARATIONS_ONLY, then #include it",
            *(f"warning: {warning}" for warning in self.estimate.warnings),
            *(f"note: {regrouped}" for regrouped in self.estimate.regrouped),
        )


def write_c(
    estimate: Estimate, path: str | os.PathLike[str], *, precision: str = "double", name: str | None = None
) -> CSource:
    """Write a leg as C; see :meth:`exoid.Estimate.to_c`."""
    source = c_source(estimate, name or str(Path(path).name), precision=precision)
    write_whole(path, [source.text])
    return CSource(source.text, source.prefix, source.dialect, source.estimate, Path(path))


def c_source(estimate: Estimate, name: str = "leg", *, precision: str = "double") -> CSource:
    """Turn an estimate of a planar leg into C, without writing it.

    Args:
        estimate: The leg and its terms.
        name: Prefix of every name in C; what no identifier can have is replaced.
        precision: "double" or "float".

    Raises:
        ExoidError: The leg is not a planar chain, a term has no form in C, or a name or number cannot be written.

    Example:
        >>> data = exoid.datasets.bleex_swing()
        >>> c_source(exoid.identify(data.leg, data.train), precision="float").functions[:2]
        ('leg_gravity', 'leg_friction')
    """
    dialect, prefix, leg = Dialect(precision), identifier(name), estimate.model.leg
    if leg.chain is None:
        raise ExoidError(
            "only a planar chain of revolute joints under gravity of 9.81 m/s² has closed equations to write in C",
            where=leg.description.name,
            remedy="choose joints whose axes are horizontal and parallel (joints=...), or use Pinocchio's own code "
            "generation on the URDF that exoid export -o writes",
        )
    places = _places(estimate, prefix, dialect)
    last = f"{prefix}_J[j]"
    own = f"(j + 1 < {prefix.upper()}_JOINTS ? {last} - {prefix}_J[j + 1] : {last})" if leg.cumulative else last
    pieces = {
        "header": provenance(estimate, prefix, dialect),
        "P": prefix.upper(),
        "p": prefix,
        "n": str(leg.chain.n),
        "real": dialect.real,
        "zero": dialect.number(0.0),
        "cos": dialect.function("cos"),
        "sin": dialect.function("sin"),
        "tables": "\n\n".join(_tables(estimate, leg.chain, prefix, places["rotor"], dialect)),
        "friction": _body(places["friction"], "v", dialect),
        "stiffness": _body(places["stiffness"], "q", dialect),
        "own_inertia": own,
        "inertia_below": f"{prefix}_sign[j] * a[j]" if leg.cumulative else "alpha[j]",
    }
    template = resources.files(__package__).joinpath(TEMPLATE).read_text(encoding="utf-8")
    text = re.sub(r"@(\w+)@", lambda found: pieces[found[1]], template)
    return CSource(text, prefix, dialect, estimate)


def c_source_to_json(source: CSource) -> dict[str, Any]:
    """Describe a C file: its hash, its functions and what it computes."""
    estimate = source.estimate
    return {
        "schema": SCHEMA,
        "c": {"name": source.path.name if source.path else f"{source.prefix}.c", "sha256": source.sha256},
        "precision": source.dialect.real,
        "functions": list(source.functions),
        "joints": list(estimate.joint_names),
        "values": dict(zip(estimate.names, estimate.values.tolist(), strict=True)),
        "units": dict(zip(estimate.names, estimate.units, strict=True)),
        "merged": {regrouped.name: regrouped.into for regrouped in estimate.regrouped},
        "warnings": list(estimate.warnings),
    }


def _places(estimate: Estimate, prefix: str, dialect: Dialect) -> dict[Place, list[list[str]]]:
    """Summands of each joint, in each place they belong to."""
    n = len(estimate.joint_names)
    places: dict[Place, list[list[str]]] = {
        "friction": [[] for _ in range(n)],
        "stiffness": [[] for _ in range(n)],
        "rotor": [[] for _ in range(n)],
    }
    index = {name: k for k, name in enumerate(_term_names(estimate))}
    for term, joint, names in joint_terms(estimate.model):
        constants = {
            symbol: dialect.number(estimate.value(name)) if symbol == "Ia" else f"{prefix}_term[{index[name]}]"
            for symbol, name in names.items()
        }
        place, text = express(term, joint, constants, dialect)
        places[place][joint].append(text)
    return places


def _term_names(estimate: Estimate) -> list[str]:
    """Parameters of friction, springs and offsets, in the order of the estimate; rotors have a table of their own."""
    every = {name: symbol for _, _, names in joint_terms(estimate.model) for symbol, name in names.items()}
    return [name for name in estimate.names if every.get(name, "Ia") != "Ia"]


def _tables(
    estimate: Estimate, chain: PlanarChain, prefix: str, rotors: Sequence[Sequence[str]], dialect: Dialect
) -> Iterator[str]:
    """Constants of the leg, each number with its name."""
    n, joints = chain.n, estimate.joint_names
    yield f"static const {prefix}_real {prefix}_g = {dialect.number(GRAVITY)}; /* m/s^2 */"
    signs = {f"axis of {joint}": dialect.number(sign) for joint, sign in zip(joints, chain.signs, strict=True)}
    yield _table(f"{prefix}_sign", prefix, signs, "+1 where positive q turns x towards z")
    ends = [*pairwise(joints), (joints[-1], "the end, not needed")]
    for axis, column in (("dx", 0), ("dz", 1)):
        reach = [*chain.offsets[:, column], 0.0]
        lengths = {f"{a} to {b}": dialect.number(x) for (a, b), x in zip(ends, reach, strict=True)}
        yield _table(f"{prefix}_{axis}", prefix, lengths, f"to the next joint, along {axis[1]} at the zero pose [m]")
    for offset, (symbol, unit) in enumerate((("X", "kg m"), ("Y", "kg m"), ("J", "kg m^2"))):
        names = estimate.names[offset : 3 * n : 3]
        values = {name: dialect.number(estimate.value(name)) for name in names}
        yield _table(f"{prefix}_{symbol}", prefix, values, f"[{unit}]")
    zero = dialect.number(0.0)
    inertias = {f"rotor of {joint}": " + ".join(own) or zero for joint, own in zip(joints, rotors, strict=True)}
    yield _table(f"{prefix}_rotor", prefix, inertias, "where it is a parameter of its own [kg m^2]")
    others = _term_names(estimate)
    if others:
        units = dict(zip(estimate.names, estimate.units, strict=True))
        values = {f"{name} [{units[name]}]": dialect.number(estimate.value(name)) for name in others}
        yield _table(f"{prefix}_term", prefix, values, "friction, springs and offsets")


def _table(name: str, prefix: str, values: dict[str, str], what: str) -> str:
    lines = [f"    {value}, /* {k}: {comment(label)} */" for k, (label, value) in enumerate(values.items())]
    head = f"/* {what} */\nstatic const {prefix}_real {name}[{len(values)}] = {{"
    return "\n".join([head, *lines, "};"])


def _body(joints: Sequence[Sequence[str]], argument: str, dialect: Dialect) -> str:
    """Assign the torque of each joint."""
    lines = [f"    tau[{j}] = {' + '.join(terms) or dialect.number(0.0)};" for j, terms in enumerate(joints)]
    unused = [f"    (void){argument};"] if not any(f"{argument}[" in line for line in lines) else []
    return "\n".join([*unused, *lines])
