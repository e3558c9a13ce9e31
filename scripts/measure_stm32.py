"""Flash, RAM, stack and instructions of examples/stm32 on an emulated Cortex-M4F, as its README shows them.

Needs the test extra and make. The first run compiles the mathematical functions of Zig, which takes a minute.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

TESTS = Path(__file__).parents[1] / "tests"


def main() -> None:
    """Build the example, run it with a simulated leg, and print what it takes."""
    sys.path[:0] = [str(TESTS), str(TESTS / "codegen")]
    from stm32_firmware import build, measured  # noqa: PLC0415 - the tests' emulator

    with tempfile.TemporaryDirectory() as folder:
        print(*measured(*build(Path(folder))), sep="\n")


if __name__ == "__main__":
    main()
