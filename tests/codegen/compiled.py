"""Estimates with known values, and the C of a leg compiled and called from Python."""

import ctypes
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from made_estimates import made
from processes import run

from exoid import Armature, Coulomb, Estimate, Leg, Stiffness, Viscous
from exoid.codegen import CSource, c_source
from exoid.estimate.data import Input
from exoid.estimate.text import provenance
from exoid.signals import ZeroPhase
from exoid.torques import TorqueModel

COMPILER = shutil.which("cc")

needs_compiler = pytest.mark.skipif(COMPILER is None, reason="needs a C compiler (cc)")

STRICT = (
    *("-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror"),
    *("-Wconversion", "-Wdouble-promotion", "-Wshadow", "-Wmissing-prototypes", "-Wstrict-prototypes", "-Wundef"),
)

EVERY_TERM = (Coulomb(), Viscous(), Armature(), Stiffness(degree=3))


def made_up(leg: Leg, terms=EVERY_TERM, seed: int = 0, **changes) -> Estimate:
    """An estimate of the leg's own parameters with random values for the terms."""
    model = TorqueModel(leg, tuple(terms))
    rng = np.random.default_rng(seed)
    own = len(leg.parameter_names)
    values = np.concatenate([leg.parameters, rng.uniform(-1.0, 2.0, len(model.names) - own)])
    given = {"preparation": ZeroPhase(), "inputs": (Input("log.csv", "ab" * 32, 1000, 100.0),)}
    return replace(made(model, values, np.diag((0.01 * values) ** 2), **given), **changes)


def compile_c(arguments, *sources: Path, to: Path) -> Path:
    """Compile with every warning as an error."""
    run(COMPILER, *STRICT, *arguments, *sources, "-o", to, "-lm")
    return to


def source_of(estimate: Estimate, name: str = "leg", precision: str = "double") -> CSource:
    """What ``Estimate.to_c`` writes, without a file."""
    return c_source(
        estimate.model,
        estimate.values,
        provenance=provenance(estimate),
        warnings=estimate.warnings,
        precision=precision,
        name=name,
    )


class CompiledLeg:
    """The functions of a C file, whose prefix is ``leg``, each over samples (N, n)."""

    def __init__(self, source: CSource, folder: Path) -> None:
        self.n = len(source.content.leg.joint_names)
        self.real = ctypes.c_double if source.dialect.real == "double" else ctypes.c_float
        self.type = np.float64 if source.dialect.real == "double" else np.float32
        file = folder / "leg.c"
        file.write_text(source.text)
        self.library = ctypes.CDLL(str(compile_c(("-O2", "-shared", "-fPIC"), file, to=folder / "leg.so")))

    def __call__(self, function: str, *inputs, shape=None) -> np.ndarray:
        call, pointer = getattr(self.library, f"leg_{function}"), ctypes.POINTER(self.real)
        call.restype = None
        columns = [np.ascontiguousarray(np.atleast_2d(x), dtype=self.type) for x in inputs]
        out = np.full((len(columns[0]), *(shape or (self.n,))), np.nan, dtype=self.type)
        for *row, result in zip(*columns, out, strict=True):
            call(*(x.ctypes.data_as(pointer) for x in (*row, result)))
        return out.astype(np.float64)

    def mass_matrix(self, q) -> np.ndarray:
        return self("mass_matrix", q, shape=(self.n, self.n))
