"""Can the tests see? Change one operator or number of the code at a time, and run the tests of its room.

    python scripts/mutate_code.py --count 60 --seed 1     # a line for each mutation, then how many were caught
    python scripts/mutate_code.py --room regression -v    # mutations of one room, with the failing test

Each mutation is made in a copy of the repository. It is caught if a test of the same room fails, or runs three times as
long as without it. A mutation that survives is printed with its line: either a test is missing, or the change has no
effect (such as a tolerance of 1e-9 that becomes 2e-9); only a reader can tell.
"""

from __future__ import annotations

import argparse
import ast
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[1]

CORE = (
    "regression",
    "identification",
    "estimate",
    "leg",
    "torques",
    "signals",
    "actuators",
    "control",
    "online",
    "rig",
)
"""Rooms whose numbers a user relies on."""

SWAPS: dict[type[ast.AST], str] = {
    **{ast.Add: "-", ast.Sub: "+", ast.Mult: "/", ast.Div: "*", ast.MatMult: "*"},
    **{ast.Lt: ">=", ast.Gt: "<=", ast.LtE: ">", ast.GtE: "<", ast.Eq: "!=", ast.NotEq: "=="},
    **{ast.And: "or", ast.Or: "and"},
}
NAMES = {"min": "max", "max": "min", "zeros": "ones", "ones": "zeros", "any": "all", "all": "any", "sin": "cos"}
SIGNS = ("+", "-", "*", "/", "@", "<=", ">=", "==", "!=", "<", ">", "and", "or")


class Mutation(NamedTuple):
    """One change of one line."""

    path: Path
    line: int
    before: str
    after: str


def mutations(path: Path) -> Iterator[Mutation]:
    """All mutations of a file."""
    text = path.read_text(encoding="utf-8")
    lines = text.splitlines()
    for node in ast.walk(ast.parse(text)):
        for start, end, new in _changes(node, text):
            line = lines[start[0] - 1].encode()
            if start[0] == end[0]:
                changed = (line[: start[1]] + new.encode() + line[end[1] :]).decode()
                yield Mutation(path, start[0], line.decode(), changed)


def _changes(node: ast.AST, text: str) -> Iterator[tuple[tuple[int, int], tuple[int, int], str]]:
    """Places of a node, from and to, and what stands there instead."""
    if isinstance(node, ast.BinOp) and type(node.op) in SWAPS:
        yield from _between(node.left, node.right, SWAPS[type(node.op)], text)
    elif isinstance(node, ast.BoolOp):
        yield from _between(node.values[0], node.values[1], SWAPS[type(node.op)], text)
    elif isinstance(node, ast.Compare) and len(node.ops) == 1 and type(node.ops[0]) in SWAPS:
        yield from _between(node.left, node.comparators[0], SWAPS[type(node.ops[0])], text)
    elif isinstance(node, ast.Constant) and type(node.value) in (int, float) and node.end_lineno is not None:
        start, end = (node.lineno, node.col_offset), (node.end_lineno, node.end_col_offset or 0)
        yield start, end, repr(node.value + 1 if type(node.value) is int else 2.0 * node.value + (node.value == 0.0))
    elif isinstance(node, ast.Attribute | ast.Name) and node.end_col_offset is not None:
        name = node.attr if isinstance(node, ast.Attribute) else node.id
        if name in NAMES and node.end_lineno is not None:
            end = (node.end_lineno, node.end_col_offset)
            yield (end[0], end[1] - len(name)), end, NAMES[name]


def _between(
    left: ast.expr, right: ast.expr, new: str, text: str
) -> Iterator[tuple[tuple[int, int], tuple[int, int], str]]:
    """Place of the operator between two operands of one line."""
    if left.end_lineno != right.lineno or left.end_col_offset is None:
        return
    gap = text.splitlines()[right.lineno - 1].encode()[left.end_col_offset : right.col_offset].decode()
    for sign in SIGNS:
        if sign in gap:
            at = left.end_col_offset + gap.index(sign)
            yield (right.lineno, at), (right.lineno, at + len(sign)), new
            return


def failing_test(copy: Path, room: str, seconds: float) -> str:
    """First test of a room that fails in a copy of the repository; empty if none does."""
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", f"tests/{room}"]
    environment = {**os.environ, "PYTHONPATH": str(copy), "PYTHONDONTWRITEBYTECODE": "1"}
    try:
        done = subprocess.run(
            command, cwd=copy, env=environment, capture_output=True, text=True, check=False, timeout=seconds
        )
    except subprocess.TimeoutExpired:
        return "runs for ever"
    failed = [line.split(" - ")[0] for line in done.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))]
    return "" if done.returncode == 0 else (failed or ["cannot be imported"])[0]


def main() -> None:
    """Run the mutations, and print what was caught."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=60, help="number of mutations")
    parser.add_argument("--seed", type=int, default=1, help="seed of their choice")
    parser.add_argument("--room", action="append", help=f"rooms to mutate; default {', '.join(CORE)}")
    parser.add_argument("-v", "--verbose", action="store_true", help="print the test that catches each mutation")
    options = parser.parse_args()
    rooms = options.room or list(CORE)
    found = [
        each for room in rooms for path in sorted((ROOT / "exoid" / room).rglob("*.py")) for each in mutations(path)
    ]
    chosen = random.Random(options.seed).sample(found, min(options.count, len(found)))
    caught, longest = 0, dict[str, float]()
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "exoid"
        shutil.copytree(ROOT, copy, ignore=shutil.ignore_patterns(".git", "*.pyc", "artefacts", "site"))
        for number, (path, line, before, after) in enumerate(chosen, 1):
            room = path.relative_to(ROOT / "exoid").parts[0]
            if room not in longest:
                start = time.monotonic()
                if fault := failing_test(copy, room, 3600.0):
                    sys.exit(f"tests of {room} fail without any mutation: {fault}")
                longest[room] = 3.0 * (time.monotonic() - start) + 10.0
            target = copy / path.relative_to(ROOT)
            lines = target.read_text(encoding="utf-8").splitlines(keepends=True)
            original, lines[line - 1] = lines[line - 1], after + "\n"
            target.write_text("".join(lines), encoding="utf-8")
            test = failing_test(copy, room, longest[room])
            lines[line - 1] = original
            target.write_text("".join(lines), encoding="utf-8")
            caught += bool(test)
            if options.verbose or not test:
                where = f"{path.relative_to(ROOT)}:{line}"
                print(f"{number:4} {'caught' if test else 'SURVIVED'} {where} {test}")
                print(f"     - {before.strip()}\n     + {after.strip()}", flush=True)
    print(f"{caught} of {len(chosen)} mutations caught (seed {options.seed}, rooms {', '.join(rooms)})")


if __name__ == "__main__":
    main()
