"""Time of a step of the law on the ground, in C and in Python, beside one call of pin.rnea: docs/stance-control.md.

The last line is the same for readings that become contacts, function, shares and torque: docs/coordination.md.

Needs a C compiler (cc) that finds DAQP's C library (CPATH, LIBRARY_PATH, LD_LIBRARY_PATH).
"""

from __future__ import annotations

import re
import subprocess
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pinocchio as pin

import exoid
from exoid.codegen import write_c
from exoid.control.functions import FUNCTIONS, Body
from exoid.control.ground import ContactFilter, CoordinatedLoop, Coordinator, GroundState, GroundTarget, stance
from exoid.control.ground.hypotheses import BLOCK
from exoid.experiments.ground import bleex_machine
from exoid.lab.coordination.study import TERMS
from exoid.rig.ground.plant import SEAT
from exoid.torques.model import TorqueModel

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


ALL = """
#define _POSIX_C_SOURCE 199309L
#include <stdio.h>
#include <time.h>
#include "walk.h"
%(solver)s
static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

int main(void)
{
    static walk_input in = { .q = { %(bent)s }, .q_d = { %(bent)s }, .force = { 0.0, 9.81 }, .closed = { -1, -1, -1 },
                             .interaction = { %(held)s } }; /* until contacts are known, the wearer holds it */
    static walk_state state;
    double tau[WALK_JOINTS], spent[2] = { 0.0 }, empty;
    int k, counted[2] = { 0 }, stood = 0;
    in.solve = by_daqp;
    walk_init(&state);
    for (empty = now(), k = 1; k < 1000; ++k) { /* the clock itself */
        now();
    }
    empty = (now() - empty) / 1000;
    for (k = 1; k <= %(steps)d; ++k) {
        double start = now();
        int block;
        in.reading = in.target = (uint32_t)k;
        walk_step(&state, &in, tau);
        block = state.samples == 0;
        spent[block] += now() - start - empty;
        ++counted[block];
        stood += state.level == 2 && state.share[0] == 1.0 && state.share[1] == 1.0;
    }
    printf("%%g %%g %%g", spent[0] / counted[0], spent[1] / counted[1], (double)stood / %(steps)d);
    return 0;
}
"""


def seconds(work: Callable[[], object], count: int) -> float:
    """Processor time of a call, on average [s]."""
    start = time.process_time()
    for _ in range(count):
        work()
    return (time.process_time() - start) / count


def in_c(law: object, contacts: int, name: str = "stand", program: str = MAIN, held: str = "") -> list[float]:
    """Compile the law with the solver of the page, and time a step [s]; zero if one has failed."""
    solver = re.search(r"```c\n(#include <daqp/api.h>.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    values = {
        "solver": solver[1],
        "bent": ", ".join(map(str, BENT)),
        "right": contacts - 1,
        "steps": STEPS,
        "held": held,
    }
    values["held"] = held
    with tempfile.TemporaryDirectory() as folder:
        write_c(Path(folder) / f"{name}.c", law)
        (Path(folder) / "main.c").write_text(program % values, encoding="utf-8")
        command = ("cc", "-std=c99", "-O2", "main.c", f"{name}.c", "-ldaqp", "-lm", "-o", "main")
        subprocess.run(command, cwd=folder, check=True)
        done = subprocess.run("./main", cwd=folder, check=True, capture_output=True, text=True)
        return [float(number) for number in done.stdout.split()]


def coordinated() -> CoordinatedLoop:
    """Loop of BLEEX with a seat, whose parameters are known to 1 %."""
    plant = bleex_machine()
    plant = replace(plant, soles={**plant.soles, plant.root_link: SEAT})
    model = TorqueModel(plant.leg, TERMS)
    values = np.array([plant.values[name] for name in model.names])
    told = ContactFilter(model, values, np.diag((0.01 * values) ** 2), plant.soles, np.zeros(3), 500.0)
    functions = {name: make(Body.of(plant.leg, plant.soles)) for name, make in FUNCTIONS.items()}
    law = stance(plant, rate=500.0)
    return CoordinatedLoop(law, told, Coordinator(functions, plant.leg.limits.effort, rate=500.0))


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
        times = [(seconds(works[0], STEPS), *in_c(law, count), seconds(works[1], 300)) for _ in range(3)]
        rnea, c, python = np.min(times, axis=0)
        print(f"{count} feet, pin.rnea {1e6 * rnea:.2f} µs: C {1e6 * c:.1f} µs, {c / rnea:.1f} ×", end="; ")
        print(f"Python {1e6 * python:.0f} µs, {python / rnea:.0f} ×")
    loop, still = coordinated(), np.zeros(6)
    state = GroundState(bent, still, 0.0, 0.0, dict.fromkeys(feet, "flat"))
    held = ", ".join(map(str, loop.law.command(state, GroundTarget(bent, still)).torque))
    timed = [
        (seconds(partial(pin.rnea, tree, data, q, v, v), STEPS), *in_c(loop, 2, "walk", ALL, held)) for _ in range(3)
    ]
    rnea, step, block, stood = np.min(timed, axis=0)
    print(f"coordinated, on both feet in {100.0 * stood:.0f} % of the steps, C {1e6 * step:.1f} µs", end=", ")
    print(
        f"{step / rnea:.1f} ×; where a block of {loop.contacts.rate * BLOCK:.0f} samples ends {1e6 * block:.1f} µs",
        end=", ",
    )
    print(f"{block / rnea:.1f} ×")


if __name__ == "__main__":
    main()
