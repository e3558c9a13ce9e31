"""Time of a step of the law on the ground, in C and in Python, beside one call of pin.rnea: docs/stance-control.md.

Needs a C compiler (cc) that finds DAQP's C library (CPATH, LIBRARY_PATH, LD_LIBRARY_PATH).
"""

from __future__ import annotations

import re
import subprocess
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pinocchio as pin

import exoid
from exoid.codegen import write_c
from exoid.control.ground import GroundState, GroundTarget, stance

PAGE = Path(__file__).parents[1] / "docs" / "stance-control.md"
BENT = (0.2, -0.75, 0.55, 0.2, -0.75, 0.55)
STEPS = 20_000
MAIN = """
#include <stdio.h>
#include <time.h>
#include <math.h>
#include "stand.h"
%(solver)s
int main(void)
{
    static stand_input in = { .q = { %(bent)s }, .contact = { 1, %(right)d }, .share = { 1, 1 }, .q_d = { %(bent)s } };
    static stand_state state;
    double tau[STAND_JOINTS];
    int k, wrong = 0;
    clock_t start = clock();
    in.solve = by_daqp;
    stand_init(&state);
    for (k = 1; k <= %(steps)d; ++k) {
        in.reading = in.target = (uint32_t)k;
        in.q[k %% STAND_JOINTS] += 1e-3 * sin(k);
        wrong += stand_step(&state, &in, tau) != STAND_OK;
    }
    printf("%%g", wrong ? 0.0 : (double)(clock() - start) / CLOCKS_PER_SEC / %(steps)d);
    return 0;
}
"""


def seconds(work: Callable[[], object], count: int) -> float:
    """Processor time of a call, on average [s]."""
    start = time.process_time()
    for _ in range(count):
        work()
    return (time.process_time() - start) / count


def in_c(law: object, contacts: int) -> float:
    """Compile the law with the solver of the page, and time a step [s]; zero if one has failed."""
    solver = re.search(r"```c\n(#include <daqp/api.h>.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    values = {"solver": solver[1], "bent": ", ".join(map(str, BENT)), "right": contacts - 1, "steps": STEPS}
    with tempfile.TemporaryDirectory() as folder:
        write_c(Path(folder) / "stand.c", law)
        (Path(folder) / "main.c").write_text(MAIN % values, encoding="utf-8")
        command = ("cc", "-std=c99", "-O2", "main.c", "stand.c", "-ldaqp", "-lm", "-o", "main")
        subprocess.run(command, cwd=folder, check=True)
        return float(subprocess.run("./main", cwd=folder, check=True, capture_output=True, text=True).stdout)


def main() -> None:
    """Time both ways, with both feet on the ground and with one."""
    law = stance(exoid.load_exo("bleex", base="floating"))
    tree, feet = law.model.pinocchio, ("left_foot", "right_foot")
    data, q, v = tree.createData(), pin.neutral(tree), np.zeros(tree.nv)
    for count in (2, 1):
        still, bent = np.zeros(6), np.array(BENT)
        state, target = (
            GroundState(bent, still, 0.0, 0.0, dict.fromkeys(feet[:count], "flat")),
            GroundTarget(bent, still),
        )
        works = partial(pin.rnea, tree, data, q, v, v), partial(law.command, state, target)
        times = [(seconds(works[0], STEPS), in_c(law, count), seconds(works[1], 300)) for _ in range(3)]
        rnea, c, python = np.min(times, axis=0)
        print(f"{count} feet, pin.rnea {1e6 * rnea:.2f} µs: C {1e6 * c:.1f} µs, {c / rnea:.1f} ×", end="; ")
        print(f"Python {1e6 * python:.0f} µs, {python / rnea:.0f} ×")


if __name__ == "__main__":
    main()
