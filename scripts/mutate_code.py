"""Can the tests see? Change one operator or number of the core at a time, and run the tests of its room.

    python scripts/mutate_code.py                              # 60 mutations, a line each; then a table by rooms
    python scripts/mutate_code.py --room regression --count 8  # mutations of one room
    python scripts/mutate_code.py --jobs 2 --seconds 300       # two at once; longest processor time of each
    python scripts/mutate_code.py --count 200 --first 142      # the last 59 of 200

The seed chooses the mutations, as many in each room. Each is made in a copy of the repository. The tests of its room
run first, then those elsewhere that import the room, up to the first failure. The test that fails must pass without
the mutation. A mutation that survives is printed with its line: a test is missing, or the change has no effect, such
as a tolerance of 1e-9 that becomes 2e-9. Only a reader can tell. One that is left when the time is over counts apart.
"""

from __future__ import annotations

import argparse
import ast
import os
import queue
import random
import re
import resource
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[1]

CORE = ("leg", "regression", "torques", "signals/filters", "identification")
"""Rooms between a recording and its estimate."""

FIRST = 5
"""Number of files with tests that run before all others."""

NO_TEST = 5
"""Exit status of pytest where no test was selected."""

OPERATORS: dict[type[ast.AST], tuple[str, str]] = {
    **{ast.Add: ("+", "-"), ast.Sub: ("-", "+"), ast.Mult: ("*", "/"), ast.Div: ("/", "*"), ast.MatMult: ("@", "*")},
    **{ast.Lt: ("<", ">="), ast.Gt: (">", "<="), ast.LtE: ("<=", ">"), ast.GtE: (">=", "<")},
    **{ast.Eq: ("==", "!="), ast.NotEq: ("!=", "=="), ast.And: ("and", "or"), ast.Or: ("or", "and")},
}
NAMES = {"min": "max", "max": "min", "zeros": "ones", "ones": "zeros", "any": "all", "all": "any", "sin": "cos"}


class Mutation(NamedTuple):
    """One change of one line."""

    room: str
    path: Path  # in the repository
    line: int
    before: str
    after: str


class Outcome(NamedTuple):
    """What the tests said: "caught", "survived" or "not decided"."""

    verdict: str
    test: str = ""


def mutations(room: str, path: Path) -> Iterator[Mutation]:
    """All mutations of a file after which it is still Python."""
    text = path.read_text(encoding="utf-8")
    lines = text.splitlines()
    for node in ast.walk(ast.parse(text)):
        for number, start, end, new in _changes(node, lines):
            line = lines[number - 1].encode()
            changed = (line[:start] + new.encode() + line[end:]).decode()
            try:  # before Python 3.12 places within f-strings are wrong
                ast.parse("\n".join([*lines[: number - 1], changed, *lines[number:]]))
            except SyntaxError:
                continue
            yield Mutation(room, path.relative_to(ROOT), number, line.decode(), changed)


def _changes(node: ast.AST, lines: list[str]) -> Iterator[tuple[int, int, int, str]]:
    """Line of a change, its first and last byte, and what stands there instead."""
    if isinstance(node, ast.BinOp):
        yield from _between(node.left, node.right, node.op, lines)
    elif isinstance(node, ast.BoolOp):
        yield from _between(node.values[0], node.values[1], node.op, lines)
    elif isinstance(node, ast.Compare) and len(node.ops) == 1:
        yield from _between(node.left, node.comparators[0], node.ops[0], lines)
    elif isinstance(node, ast.Constant) and isinstance(node.value, int | float) and node.end_col_offset is not None:
        if not isinstance(node.value, bool):
            new = node.value + 1 if isinstance(node.value, int) else 2.0 * node.value + (node.value == 0.0)
            yield node.lineno, node.col_offset, node.end_col_offset, repr(new)
    elif isinstance(node, ast.Attribute | ast.Name) and node.end_col_offset is not None:
        name = node.attr if isinstance(node, ast.Attribute) else node.id
        if name in NAMES and node.end_lineno is not None:
            yield node.end_lineno, node.end_col_offset - len(name), node.end_col_offset, NAMES[name]


def _between(left: ast.expr, right: ast.expr, kind: ast.AST, lines: list[str]) -> Iterator[tuple[int, int, int, str]]:
    """Place of the operator between two operands of one line."""
    if type(kind) not in OPERATORS or left.end_lineno != right.lineno or left.end_col_offset is None:
        return
    gap = lines[right.lineno - 1].encode()[left.end_col_offset : right.col_offset].decode()
    old, new = OPERATORS[type(kind)]
    if old in gap:
        start = left.end_col_offset + gap.index(old)
        yield right.lineno, start, start + len(old), new


def tests_of(mutation: Mutation, copy: Path) -> list[str]:
    """Files with tests of a room and those elsewhere that import it; those with a name of the changed module first."""
    room, top = mutation.room.replace("/", "."), mutation.room.split("/")[0]
    body = ast.parse((ROOT / mutation.path).read_text(encoding="utf-8")).body
    defined = [node.name for node in body if isinstance(node, ast.FunctionDef | ast.ClassDef)]
    names = re.compile(rf"\b({'|'.join([mutation.path.stem, *defined])})\b")
    found: list[tuple[int, Path]] = []
    for path in sorted((copy / "tests").rglob("test_*.py")):
        text, place = path.read_text(encoding="utf-8"), path.relative_to(copy)
        if place.parts[1] == "benchmarks":  # speed is no behaviour, and fails on a busy machine
            continue
        own = place.parts[1] == top
        if own or re.search(rf"exoid\.{re.escape(room)}\b", text):
            found.append((not own, place))
        if names.search(text):
            found.append((-len(set(names.findall(text))) - own, place))
    return list(dict.fromkeys(str(place) for _, place in sorted(found)))


def run_tests(copy: Path, tests: list[str], seconds: int) -> Outcome:
    """Run tests in a copy of the repository up to the first failure, the first files alone, slow ones at the end."""
    environment = {**os.environ, "PYTHONPATH": str(copy), "PYTHONDONTWRITEBYTECODE": "1"}
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-n", "0", "-p", "no:cacheprovider"]
    slow = ["-m", "slow", *tests[: 2 * FIRST]]
    for batch in filter(None, (tests[:FIRST], tests[FIRST:], slow)):
        done = subprocess.run(
            [*command, *batch],
            cwd=copy,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds)),
        )
        if done.returncode < 0:  # killed by the limit
            return Outcome("not decided", f"{seconds} s are over")
        if done.returncode not in (0, NO_TEST):
            failed = re.findall(r"^(?:FAILED|ERROR) (.+?)(?: - .*)?$", done.stdout, flags=re.MULTILINE)
            return Outcome("caught", failed[0] if failed else "")
    return Outcome("survived")


def try_mutation(mutation: Mutation, copy: Path, seconds: int) -> Outcome:
    """Make a mutation in a copy, test it, and take it back."""
    target = copy / mutation.path
    original = target.read_text(encoding="utf-8")
    lines = original.splitlines(keepends=True)
    lines[mutation.line - 1] = mutation.after + "\n"
    target.write_text("".join(lines), encoding="utf-8")
    outcome = run_tests(copy, tests_of(mutation, copy), seconds)
    target.write_text(original, encoding="utf-8")
    if outcome.verdict == "caught":
        test = outcome.test or tests_of(mutation, copy)[0]
        if run_tests(copy, [test], seconds).verdict != "survived":
            return Outcome("not decided", f"{test} fails without the mutation")
    return outcome


def choose(rooms: list[str], count: int, seed: int) -> list[Mutation]:
    """Draw as many mutations in each room."""
    rng, chosen = random.Random(seed), []
    for k, room in enumerate(rooms):
        share = count // len(rooms) + (k < count % len(rooms))
        found = [each for path in sorted((ROOT / "exoid" / room).rglob("*.py")) for each in mutations(room, path)]
        chosen += rng.sample(found, min(share, len(found)))
    rng.shuffle(chosen)
    return chosen


def main() -> None:
    """Run the mutations, and print what was caught."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=60, help="number of mutations")
    parser.add_argument("--first", type=int, default=1, help="the first of them to try, counted from 1")
    parser.add_argument("--seed", type=int, default=1, help="seed of their choice")
    parser.add_argument("--room", action="append", help=f"rooms to mutate; default {', '.join(CORE)}")
    parser.add_argument("--seconds", type=int, default=120, help="longest processor time of the tests of a mutation")
    parser.add_argument("--jobs", type=int, default=1, help="mutations at once")
    options = parser.parse_args()
    rooms = options.room or list(CORE)
    chosen = choose(rooms, options.count, options.seed)
    table: Counter[tuple[str, str]] = Counter()
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(options.jobs) as pool:
        copies: queue.Queue[Path] = queue.Queue()
        for k in range(options.jobs):
            ignored = shutil.ignore_patterns(".git", "*.pyc", "artefacts", "site")
            copies.put(Path(shutil.copytree(ROOT, Path(folder) / str(k), ignore=ignored)))

        def work(mutation: Mutation) -> None:
            copy = copies.get()
            outcome = try_mutation(mutation, copy, options.seconds)
            copies.put(copy)
            table[mutation.room, outcome.verdict] += 1
            text = f"{outcome.verdict:12} {mutation.path}:{mutation.line} {outcome.test}"
            print(f"{text}\n    - {mutation.before.strip()}\n    + {mutation.after.strip()}", flush=True)

        for done in [pool.submit(work, mutation) for mutation in chosen[options.first - 1 :]]:
            done.result()
    verdicts = ("caught", "survived", "not decided")
    print(f"\n{'seed ' + str(options.seed):18}" + "".join(f"{verdict:>13}" for verdict in verdicts))
    for room in rooms:
        print(f"{room:18}" + "".join(f"{table[room, verdict]:13}" for verdict in verdicts))
    print(f"{'all':18}" + "".join(f"{sum(table[room, v] for room in rooms):13}" for v in verdicts))


if __name__ == "__main__":
    main()
