"""C for a Cortex-M4F, compiled by Zig's clang and run by Unicorn, which counts instructions.

Both are Python packages (``pip install 'exoid[embedded]'``). The mathematical functions are those that come with Zig.
Its first program takes a minute, because they are compiled; later ones take a second.
"""

from __future__ import annotations

import importlib.util
import struct
import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from processes import run

HERE = all(importlib.util.find_spec(name) for name in ("ziglang", "unicorn"))

needs_cortex_m = pytest.mark.skipif(not HERE, reason="needs ziglang and unicorn: pip install 'exoid[embedded]'")

COMPILER = (sys.executable, "-m", "ziglang", "cc", "-target", "thumb-linux-musleabihf", "-mcpu=cortex_m4+vfp4d16sp")

FLASH, FLASH_BYTES = 0x08000000, 512 * 1024
RAM, RAM_BYTES = 0x20000000, 128 * 1024
RETURN = FLASH + FLASH_BYTES - 16  # where functions return to: no program reaches so far
PAINT = 0xA5
EXCEPTION_FRAME = 104  # bytes that the processor stacks before an interrupt, with the registers of the FPU

LINKER = """
SECTIONS
{
    .text 0x08000000 : { *(.text*) *(.rodata*) }
    .data 0x20000000 : { *(.data*) *(.bss*) *(COMMON) }
    /DISCARD/ : { *(.ARM.ex*) }
}
"""


class Elf(NamedTuple):
    """A linked program.

    Attributes:
        segments: Address and bytes of what is in flash.
        symbols: Address and size of functions and variables.
        flash: Bytes of code, constants and initial values.
        ram: Bytes of variables.
    """

    segments: tuple[tuple[int, bytes], ...]
    symbols: dict[str, tuple[int, int]]
    flash: int
    ram: int

    @staticmethod
    def read(path: Path) -> Elf:
        """Read a file of 32 bits."""
        data = path.read_bytes()
        (segments_at, sections_at), (entry, count, row, rows) = (
            struct.unpack_from("<2I", data, 28),
            struct.unpack_from("<4H", data, 42),
        )
        segments, symbols, sizes = [], {}, {"flash": 0, "ram": 0}
        for k in range(count):
            kind, offset, _, address, size, memory, flags, _ = struct.unpack_from("<8I", data, segments_at + entry * k)
            if kind == 1 and size:
                segments.append((address, data[offset : offset + size]))
                sizes["flash"] += size
            if kind == 1 and flags & 2:  # writable
                sizes["ram"] += memory
        sections = [struct.unpack_from("<10I", data, sections_at + row * k) for k in range(rows)]
        for _, kind, _, _, offset, size, link, *_ in sections:
            if kind == 2:  # the table of symbols
                for at in range(offset, offset + size, 16):
                    name, value, length, _, place = struct.unpack_from("<3I2H", data, at)
                    start = sections[link][4] + name
                    if place:
                        symbols[data[start : data.index(b"\0", start)].decode()] = (value, length)
        return Elf(tuple(segments), symbols, **sizes)


class Machine:
    """A Cortex-M4F with a program in its flash; functions are called, interrupts taken, variables read and written."""

    def __init__(self, elf: Elf, *, count: bool = False) -> None:
        from unicorn import UC_ARCH_ARM, UC_HOOK_CODE, UC_MODE_MCLASS, UC_MODE_THUMB, Uc, arm_const  # noqa: PLC0415

        self.elf, self.registers = elf, arm_const
        self.visits: Counter[int] = Counter()  # how often the instruction at each address ran, if it is to count
        self.uc = Uc(UC_ARCH_ARM, UC_MODE_THUMB | UC_MODE_MCLASS)
        self.uc.ctl_set_cpu_model(arm_const.UC_CPU_ARM_CORTEX_M4)
        self.uc.mem_map(FLASH, FLASH_BYTES)
        self.uc.mem_map(RAM, RAM_BYTES)
        self.uc.mem_map(0xE000E000, 0x1000)  # system control
        self.uc.mem_write(RAM, bytes([PAINT]) * RAM_BYTES)
        for address, content in elf.segments:
            self.uc.mem_write(address, content)
        self._set("SP", RAM + RAM_BYTES)
        self._set("C1_C0_2", 0xF << 20)  # both halves of the FPU
        self._set("FPEXC", 1 << 30)
        if count:
            self.uc.hook_add(UC_HOOK_CODE, self._count)

    def call(self, function: str | int, *arguments: int) -> int:
        """Call a function by its name or address, with integers or pointers; return what it returns."""
        address = self.elf.symbols[function][0] if isinstance(function, str) else function
        for register, value in zip(("R0", "R1", "R2", "R3"), arguments, strict=False):
            self._set(register, value)
        self._set("LR", RETURN | 1)
        self.uc.emu_start(address | 1, RETURN)
        assert self._get("PC") == RETURN, f"stopped at {self._get('PC'):#x}"
        return self._get("R0")

    def boot(self) -> None:
        """Start as after a reset, and run until the program sleeps."""
        stack, start = struct.unpack("<2I", self.uc.mem_read(FLASH, 8))
        self._set("SP", stack)
        self._sleep(start)

    def interrupt(self, number: int) -> int:
        """Take an interrupt while the program sleeps, then run until it sleeps again; instructions of the handler."""
        asleep, stack, before = self._get("PC"), self._get("SP"), self.instructions()
        self._set("SP", stack - EXCEPTION_FRAME)
        self.call(struct.unpack("<I", self.uc.mem_read(FLASH + 4 * (16 + number), 4))[0])
        taken = self.instructions() - before
        self._set("SP", stack)
        self._sleep(asleep | 1)
        return taken

    def read(self, variable: str, kind: np.dtype | type) -> np.ndarray:
        """Read a variable, as so many numbers of a type as it has."""
        return np.frombuffer(bytes(self.uc.mem_read(*self.elf.symbols[variable])), kind)

    def write(self, variable: str, value: np.ndarray) -> None:
        """Write a variable from its beginning on."""
        self.uc.mem_write(self.elf.symbols[variable][0], value.tobytes())

    def instructions(self, prefix: str = "") -> int:
        """Instructions so far, of all functions or of those whose names begin so."""
        if not prefix:
            return sum(self.visits.values())
        places = [place for name, place in self.elf.symbols.items() if name.startswith(prefix)]
        inside = {at for start, size in places for at in range(start & ~1, (start & ~1) + size, 2)}
        return sum(count for at, count in self.visits.items() if at in inside)

    @property
    def stack(self) -> int:
        """Largest stack so far [bytes]."""
        memory = np.frombuffer(bytes(self.uc.mem_read(RAM + self.elf.ram, RAM_BYTES - self.elf.ram)), np.uint8)
        used = np.flatnonzero(memory != PAINT)
        return len(memory) - int(used[0]) if used.size else 0

    def _sleep(self, address: int) -> None:
        """Run until WFI, at which Unicorn returns."""
        self.uc.emu_start(address, RETURN)
        assert bytes(self.uc.mem_read(self._get("PC") - 2, 2)) == b"\x30\xbf", f"stopped at {self._get('PC'):#x}"

    def _count(self, _: object, address: int, *__: object) -> None:
        self.visits[address] += 1

    def _get(self, register: str) -> int:
        return self.uc.reg_read(getattr(self.registers, f"UC_ARM_REG_{register}"))

    def _set(self, register: str, value: int) -> None:
        self.uc.reg_write(getattr(self.registers, f"UC_ARM_REG_{register}"), value)


def compile_for_cortex_m(sources: Sequence[Path], functions: Sequence[str], folder: Path) -> Elf:
    """Compile files with every warning as an error, and link them so that these functions can be called."""
    (folder / "link.ld").write_text(LINKER)
    # The start-up code, which --gc-sections removes again, calls main().
    (folder / "unused.c").write_text("int main(void) { return 0; }\n")
    flags = ("-std=c99", "-O2", "-g0", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-ffunction-sections", "-static")
    keep = (f"-Wl,--gc-sections,-T,{folder / 'link.ld'}", *(f"-Wl,-u,{name}" for name in functions))
    entry = f"-Wl,--entry={functions[0]}"
    files = (*map(str, sources), str(folder / "unused.c"), "-lm", "-o", str(folder / "law.elf"))
    run(*COMPILER, *flags, *keep, entry, *files)
    return Elf.read(folder / "law.elf")
