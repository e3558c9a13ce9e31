"""Laws compiled together into one library or program, and called from Python over many samples."""

import ctypes
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from compiled import COMPILER, STRICT
from processes import run

from exoid.codegen import CSource
from exoid.control import State
from exoid.rig import Target

RUNNER = """
#include "{prefix}.c"

int {prefix}_size(void);
void {prefix}_begin_(void *state);
void {prefix}_run(void *state, int count, const {prefix}_input *in, {prefix}_real *tau, int *status);

int {prefix}_size(void)
{{
    return (int)sizeof({prefix}_state);
}}

void {prefix}_begin_(void *state)
{{
    {prefix}_init(({prefix}_state *)state);
}}

void {prefix}_run(void *state, int count, const {prefix}_input *in, {prefix}_real *tau, int *status)
{{
    int k;
    for (k = 0; k < count; ++k) {{
        status[k] = (int){prefix}_step(({prefix}_state *)state, in + k, tau + k * {P}_JOINTS);
    }}
}}
"""

MAIN = """
#include <stdio.h>
#include <stdlib.h>

int main(void)
{
    FILE *in, *out;
%s    return 0;
}
"""

ONE = """
    {{
        {prefix}_state state;
        {prefix}_input input;
        {prefix}_real tau[{P}_JOINTS];
        int status;
        {prefix}_init(&state);
        in = fopen("{prefix}.in", "rb");
        out = fopen("{prefix}.out", "wb");
        if (in == NULL || out == NULL) {{
            return 1;
        }}
        while (fread(&input, sizeof input, 1, in) == 1) {{
            {prefix}_run(&state, 1, &input, tau, &status);
            if (fwrite(tau, sizeof tau, 1, out) != 1) {{
                return 1;
            }}
        }}
        fclose(in);
        fclose(out);
    }}
"""


def write_all(sources: Sequence[CSource], folder: Path, *, main: bool = False) -> Path:
    """One file that includes every law, with a runner for each, and a program around them if asked for."""
    text = ""
    for source in sources:
        (folder / f"{source.prefix}.h").write_text(source.header)
        (folder / f"{source.prefix}.c").write_text(source.text)
        text += RUNNER.format(prefix=source.prefix, P=source.prefix.upper())
    if main:
        text += MAIN % "".join(ONE.format(prefix=source.prefix, P=source.prefix.upper()) for source in sources)
    path = folder / "all_laws.c"
    path.write_text(text)
    return path


def build(compiler: str, arguments: Sequence[str], source: Path, to: Path) -> Path:
    """Compile with every warning as an error."""
    flags = [flag for flag in STRICT if flag != "-Wpedantic"] + ["-pedantic"]
    run(compiler, *flags, *arguments, source, "-o", to, "-lm")
    return to


def record_type(source: CSource) -> np.dtype:
    """The struct of the inputs, as numpy lays it out like C."""
    real = np.float64 if source.dialect.real == "double" else np.float32
    n = (len(source.content.joints),)
    fields = [("q", real, n), ("v", real, n)]
    fields += [(each.name, real, n if each.size is None else (each.size,)) for each in source.content.inputs]
    fields += [("solve", np.uintp)] if source.content.solver else []
    counters = ["reading", *(["target"] if any(each.source == "target" for each in source.content.inputs) else [])]
    return np.dtype([*fields, *((name, np.uint32) for name in counters)], align=True)


def state_type(source: CSource) -> np.dtype:
    """The struct of the memory of a law that neither keeps angles nor settles."""
    kinds = {"i": np.intc, "f": np.float64}
    fields = [("last", np.float64, (len(source.content.joints),))]
    fields += [(each.name, kinds[each.values.dtype.kind], each.values.shape) for each in source.content.memory]
    fields += [("running", np.intc), ("reading", np.uint32), ("reading_age", np.intc)]
    fields += [("target", np.uint32), ("target_age", np.intc)] if "target" in record_type(source).names else []
    return np.dtype([*fields, ("faults", np.uint32)], align=True)


def records(source: CSource, count: int, values: Mapping[str, np.ndarray]) -> np.ndarray:
    """Inputs of some samples, with counters that begin at 1."""
    found = np.zeros(count, record_type(source))
    for name in found.dtype.names:
        found[name] = np.arange(1, count + 1) if name in ("reading", "target") else values[name]
    return found


@dataclass(frozen=True)
class CompiledLaw:
    """A law in a library; itself a law with memory, which is the struct of its state as bytes."""

    source: CSource
    library: ctypes.CDLL

    @property
    def rate(self) -> float:
        return self.source.content.rate

    def fresh(self) -> bytes:
        """State after init."""
        state = ctypes.create_string_buffer(getattr(self.library, f"{self.source.prefix}_size")())
        getattr(self.library, f"{self.source.prefix}_begin_")(state)
        return state.raw

    def run(self, inputs: np.ndarray, memory: bytes | None = None) -> tuple[np.ndarray, np.ndarray, bytes]:
        """Torques (N, n), statuses (N,) and the memory after some samples."""
        state = ctypes.create_string_buffer(memory or self.fresh())
        tau = np.full((len(inputs), len(self.source.content.joints)), np.nan, inputs.dtype["q"].base)
        status = np.full(len(inputs), -1, np.int32)
        pointers = (x.ctypes.data_as(ctypes.c_void_p) for x in (inputs, tau, status))
        getattr(self.library, f"{self.source.prefix}_run")(state, len(inputs), *pointers)
        return tau, status, state.raw[:-1]

    def begin(self, state: State) -> tuple[bytes, int]:
        return self.fresh(), 0

    def step(self, memory: tuple[bytes, int], state: State, target: Target) -> tuple[np.ndarray, tuple[bytes, int]]:
        values = {"q": state.q, "v": state.v, "q_d": target.q, "v_d": target.v, "a_d": target.a}
        inputs = records(self.source, 1, {**values, "interaction": state.interaction})
        for counter in ("reading", "target"):
            if counter in inputs.dtype.names:
                inputs[counter] = memory[1] + 1
        tau, status, after = self.run(inputs, memory[0])
        assert status[0] == 0
        return tau[0].astype(np.float64), (after, memory[1] + 1)


def compile_laws(sources: Sequence[CSource], folder: Path, flags: Sequence[str] = ()) -> dict[str, CompiledLaw]:
    """Laws by their prefix, compiled as one library."""
    path = build(COMPILER, ("-shared", "-fPIC", *flags), write_all(sources, folder), folder / f"{sources[0].prefix}.so")
    library = ctypes.CDLL(str(path))
    return {source.prefix: CompiledLaw(source, library) for source in sources}
