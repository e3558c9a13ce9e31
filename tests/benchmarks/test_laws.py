"""What one step of every law costs from Python, against one bare call of Pinocchio's RNEA.

``pytest tests/benchmarks/test_laws.py -s`` prints the times.
"""

from __future__ import annotations

import gc
import time

import numpy as np
import pinocchio as pin
import pytest

import exoid
from exoid import published
from exoid.control import AHEAD, SHARP, Limited, State, gravity_friction_pd, p
from exoid.control.standard_laws import standard_laws
from exoid.experiments import healthy_gait
from exoid.rig import Plant, Target

CALLS, TURNS = 50, 80
RATIO = 8.0
KP, KD = (22.1, 55.6), (2.21, 5.56)
PD_G_F = "pd_gravity_friction"


def cuhk():
    """Every law on the CUHK-EXO of the documents' assumptions, friction, spring and rotors included."""
    plant = Plant.build(exoid.load_leg("cuhk"), {**published.cuhk_resistances(), "Ia_hip": 0.8, "Ia_knee": 0.8})
    laws = {"p": p(KP), **standard_laws(plant, KP, KD, healthy_gait(), 10.0)}
    laws["pd_gravity_friction, sharp sign"] = gravity_friction_pd(plant, KP, KD, friction=SHARP)
    laws["pd_gravity_friction, desired velocity"] = gravity_friction_pd(plant, KP, KD, friction=AHEAD)
    laws["lqr within limits"] = Limited(laws["lqr"], limit=80.0, slew=2000.0)
    return plant.leg, laws


def bleex():
    """The law of document 2 on the three joints of a BLEEX identified from data."""
    data = exoid.datasets.bleex_swing()
    return data.leg, {PD_G_F: gravity_friction_pd(exoid.identify(data.leg, data.train), 50.0, 5.0)}


@pytest.mark.parametrize("make", [cuhk, bleex], ids=["CUHK-EXO", "BLEEX"])
def test_a_step_of_pd_with_gravity_and_friction_costs_at_most_eight_bare_rneas(make):
    """Medians of batches measured in turns, so that other work on the machine meets all alike."""
    leg, laws = make()
    model, data, n = leg.model, leg.model.createData(), len(leg.joint_names)
    rng = np.random.default_rng(0)
    q, v, a = rng.uniform(-0.5, 0.5, (3, n))
    state, target = State(q, v, 1.23, np.zeros(n)), Target(*rng.uniform(-0.5, 0.5, (3, n)))

    def bare():
        for _ in range(CALLS):
            pin.rnea(model, data, q, v, a)

    def stepping(law):
        def steps():
            for _ in range(CALLS):
                law.torque(state, target)

        return steps

    works = {"pin.rnea": bare, **{name: stepping(law) for name, law in laws.items()}}
    times = {name: [] for name in works}
    gc.disable()
    try:
        for _ in range(TURNS):
            for name, work in works.items():
                start = time.perf_counter()
                work()
                times[name].append((time.perf_counter() - start) / CALLS)
    finally:
        gc.enable()
    median = {name: float(np.median(every)) for name, every in times.items()}
    print()
    for name, seconds in median.items():
        print(f"{name}: {1e6 * seconds:.2f} µs, {seconds / median['pin.rnea']:.1f} × pin.rnea")
    assert median[PD_G_F] <= RATIO * median["pin.rnea"]
