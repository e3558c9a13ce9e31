"""Programs for a Cortex-M that QEMU emulates: they print through semihosting and count instructions.

With -icount shift=3 the emulated machine takes 8 ns for each instruction, whatever the instruction. SysTick of the
MPS2 boards runs at 25 MHz, so that a tick is 5 instructions. A loop of known length checks that.
"""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from exoid.codegen import CSource

GCC, QEMU = shutil.which("arm-none-eabi-gcc"), shutil.which("qemu-system-arm")

needs_cortex_m = pytest.mark.skipif(
    GCC is None or QEMU is None, reason="needs arm-none-eabi-gcc with newlib, and qemu-system-arm"
)


class Board(NamedTuple):
    """A board of QEMU and the options of the compiler for its processor."""

    machine: str
    flags: tuple[str, ...]


BOARDS = {
    "Cortex-M3, software floating point": Board("mps2-an385", ("-mcpu=cortex-m3", "-mthumb", "-mfloat-abi=soft")),
    "Cortex-M4F, hardware floating point": Board(
        "mps2-an386", ("-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16")
    ),
}

LINKER = """
ENTRY(reset)
SECTIONS
{
    .text 0x0 : { KEEP(*(.vectors)) *(.text*) *(.rodata*) *(.ARM.ex*) }
    .data 0x20000000 : { *(.data*) *(.bss*) *(COMMON) }
    end = .;
}
"""

PROGRAM = """
#include "{prefix}.h"

#define ROWS {rows}
#define REGISTER(address) (*(volatile uint32_t *)(address))

void reset(void);
void run(void);

__attribute__((section(".vectors"), used)) static const uintptr_t vectors[] = {{0x20300000u, (uintptr_t)reset}};

static const {prefix}_input inputs[ROWS] = {{
{inputs}
}};

static uintptr_t call(uintptr_t operation, const void *argument)
{{
    register uintptr_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}}

static void show(const char *name, long value)
{{
    char text[16], *end = text + 15;
    unsigned long rest = value < 0 ? 0ul - (unsigned long)value : (unsigned long)value;
    *end = 0;
    do {{
        *--end = (char)('0' + rest % 10);
        rest /= 10;
    }} while (rest);
    if (value < 0) {{
        *--end = '-';
    }}
    call(4, name);
    call(4, " ");
    call(4, end);
    call(4, "\\n");
}}

static uint32_t ticks(void)
{{
    return REGISTER(0xE000E018);
}}

__attribute__((naked)) void reset(void)
{{
    /* Floating point unit on, before any function saves its registers. */
    __asm__ volatile("ldr r0, =0xE000ED88\\nldr r1, =0xF00000\\nstr r1, [r0]\\ndsb\\nisb\\nb run");
}}

void run(void)
{{
    static {prefix}_state state;
    {prefix}_real tau[{P}_JOINTS];
    uint32_t start, most = 0, all = 0, loop = 100000;
    int k, j;
    REGISTER(0xE000E014) = 0xFFFFFF; /* SysTick from the processor's clock */
    REGISTER(0xE000E018) = 0;
    REGISTER(0xE000E010) = 5;
    start = ticks();
    __asm__ volatile("1: subs %0, #1\\nbne 1b" : "+r"(loop));
    show("loop", (long)((start - ticks()) & 0xFFFFFF));
    {prefix}_init(&state);
    for (k = 0; k < ROWS; ++k) {{
        uint32_t taken;
        int status;
        start = ticks();
        status = (int){prefix}_step(&state, inputs + k, tau);
        taken = (start - ticks()) & 0xFFFFFF;
        most = taken > most ? taken : most;
        all += taken;
        show("status", status);
        for (j = 0; j < {P}_JOINTS; ++j) {{
            show("torque", (long)(tau[j] * 1000000));
        }}
    }}
    show("most", (long)most);
    show("all", (long)all);
    call(0x18, (const void *)0x20026); /* the end, without an error */
    for (;;) {{
    }}
}}
"""


class Emulated(NamedTuple):
    """What a program printed.

    Attributes:
        torque: Torques, rounded down to 1e-6 N·m, (N, n).
        status: Results of the steps, (N,).
        per_tick: Instructions of one tick, measured with the loop.
        most: Instructions of the longest step.
        mean: Instructions of a step on average.
        code: Bytes of code and constants of the whole program.
    """

    torque: np.ndarray
    status: np.ndarray
    per_tick: float
    most: float
    mean: float
    code: int


def emulate(source: CSource, rows: np.ndarray, board: Board, folder: Path) -> Emulated:
    """Compile a law for a board and run it there on some inputs."""
    (folder / f"{source.prefix}.h").write_text(source.header)
    (folder / f"{source.prefix}.c").write_text(source.text)
    (folder / "link.ld").write_text(LINKER)
    inputs = ",\n".join("    {" + ", ".join(_in_c(row[name]) for name in rows.dtype.names) + "}" for row in rows)
    program = PROGRAM.format(prefix=source.prefix, P=source.prefix.upper(), rows=len(rows), inputs=inputs)
    (folder / "main.c").write_text(program)
    command = [
        *(str(GCC), *board.flags, "-std=gnu99", "-O2", "-Wall", "-Wextra", "-Werror", "-nostartfiles"),
        *("--specs=nosys.specs", "-Wl,--no-warn-rwx-segments", f"-T{folder / 'link.ld'}"),
        *(str(folder / "main.c"), str(folder / f"{source.prefix}.c"), "-o", str(folder / "law.elf"), "-lm"),
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    run = [
        *(str(QEMU), "-M", board.machine, "-nographic", "-monitor", "none", "-serial", "none"),
        *("-semihosting-config", "enable=on,target=native", "-icount", "shift=3"),
        *("-kernel", str(folder / "law.elf")),
    ]
    done = subprocess.run(run, capture_output=True, text=True, check=False, timeout=60, stdin=subprocess.DEVNULL)
    printed = f"{done.stdout}{done.stderr}"
    found = {name: [int(x) for x in re.findall(rf"^{name} (-?\d+)$", printed, re.MULTILINE)]
             for name in ("loop", "status", "torque", "most", "all")}  # fmt: skip
    assert found["all"], printed
    per_tick = 200_000 / found["loop"][0]
    size = subprocess.run(
        [str(GCC).replace("gcc", "size"), str(folder / "law.elf")], capture_output=True, text=True, check=True
    )
    return Emulated(
        1e-6 * np.array(found["torque"]).reshape(len(rows), -1),
        np.array(found["status"]),
        per_tick,
        per_tick * found["most"][0],
        per_tick * found["all"][0] / len(rows),
        int(size.stdout.splitlines()[1].split()[0]),
    )


def _in_c(value: np.ndarray) -> str:
    if np.ndim(value):
        return "{" + ", ".join(_in_c(x) for x in value) + "}"
    return str(int(value)) if isinstance(value, np.integer) else f"{float(value)!r}" + "f" * (value.dtype.itemsize == 4)
