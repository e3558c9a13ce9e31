"""Golden journeys: numbers of seeded runs through the public API and the command line, stored and compared.

    python scripts/golden.py --store scripts/golden.json      # after a change of numbers that is meant
    python scripts/golden.py --compare scripts/golden.json    # after a change of shape: nothing may move
    python scripts/golden.py --list                         # names of the journeys; -k TEXT chooses some

A journey is a function that returns whatever it computed. Arrays are reduced to a fingerprint: some entries, sum and
norm. Words of texts that are written, such as C, are compared to the letter, and their numbers as others. A journey
that raises stores the kind of its error.
"""

from __future__ import annotations

import argparse
import contextlib
import ctypes
import hashlib
import io
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from typing import Any

os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")  # before numpy: sums in one order

import numpy as np

import exoid
from exoid import codegen, control, experiments, rig, signals, torques
from exoid.actuators import Actuators, Coupling, LinearActuator, MomentArmTable, Motor, SeriesElastic, read_actuators
from exoid.errors import ExoidError
from exoid.experiments import ground, healthy_gait
from exoid.online import RecursiveEstimator

sys.path.insert(0, str(Path(__file__).resolve().parent))

import fault_lists
import faulty_logs

JOURNEYS: dict[str, Callable[[], Any]] = {}
KEPT = 40
"""Entries of an array that are stored, evenly spread."""

FLOOR = 1e-12
"""Differences below this, relative to the largest entry of a list, are rounding of zeros."""


def journey(name: str) -> Callable[[Callable[[], Any]], Callable[[], Any]]:
    """Add a function to the journeys."""
    return lambda function: JOURNEYS.setdefault(name, function)


def command(*words: str, files: Sequence[str] = ()) -> Any:  # noqa: ANN401 - JSON
    """Run ``exoid WORDS`` in this process, in a folder with the logs that words name; JSON and texts that it wrote."""
    prepare_folder()
    out = io.StringIO()
    from exoid.cli import main  # noqa: PLC0415 - only commands need it

    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(io.StringIO()) as said:
        sys.argv = ["exoid", *words]
        try:
            main()
        except SystemExit as stop:
            code = int(stop.code or 0)
    if code == 2:
        return {"code": code, "error": said.getvalue().strip().splitlines()[-1][:60]}
    text = out.getvalue()
    found: dict[str, Any] = {"code": code}
    found["json"] = json.loads(text) if "--json" in words else None
    return found | {file: written(Path(file)) for file in files}


def written(path: Path) -> dict[str, Any]:
    """Words of a text to the letter, and its decimal numbers, whose last digits differ from processor to processor."""
    number, text = (
        re.compile(r"(?<![\w.])-?(?:\d+\.\d*|\.\d+|\d+(?=[eE][-+]?\d))(?:[eE][-+]?\d+)?"),
        path.read_text("utf-8"),
    )
    words = hashlib.sha256(number.sub("#", text).encode()).hexdigest()
    return {"words": words, "numbers": np.array([float(x) for x in number.findall(text)])}


@cache
def prepare_folder() -> None:
    """Go to an empty folder that has an estimate and some logs."""
    os.chdir(tempfile.mkdtemp())
    estimate().save("est.json")
    right = exoid.load_leg("bleex", side="right")
    right_log(right).to_csv("right.csv")
    exoid.identify(right, exoid.Recording.from_csv("right.csv"), check=False).save("right.json")
    data = exoid.datasets.bleex_swing()
    push = 3.0 * np.sin(2.0 * np.pi * 0.7 * data.test.time)[:, None]
    replace(data.test, tau=data.test.tau - push).to_csv("worn.csv")
    cylinders().readings(data.train).to_csv("forces.csv")


@cache
def estimate(name: str = "bleex") -> exoid.Estimate:
    """An estimate of a leg from a simulated log."""
    leg, log = logged(name)
    return exoid.identify(leg, log, check=False)


@cache
def logged(name: str, seed: int = 0) -> tuple[exoid.Leg, exoid.Recording]:
    """A leg, and a log of it."""
    if name == "bleex":
        data = exoid.datasets.bleex_swing()
        return data.leg, data.train
    log = faulty_logs.clean_log(name, seed)
    return log.leg, log.recordings[0]


def right_log(leg: exoid.Leg) -> exoid.Recording:
    """A log of the right leg of BLEEX."""
    time = np.arange(0.0, 20.0, 0.01)
    wave = np.multiply.outer(time, 2.0 * np.pi * 0.15 * np.arange(1, 6))[:, None, :]
    wave = wave + np.random.default_rng(0).uniform(0.0, 2.0 * np.pi, (3, 5))
    w = 2.0 * np.pi * 0.15 * np.arange(1, 6)
    q, v, a = (0.2 * x.sum(-1) for x in (np.sin(wave), w * np.cos(wave), -(w**2) * np.sin(wave)))
    tau = leg.inverse_dynamics(q, v, a) + 0.8 * np.tanh(v / 0.02) + 0.3 * v
    tau += np.random.default_rng(1).normal(scale=(0.5, 0.3, 0.2), size=tau.shape)
    return exoid.Recording(time=time, q=q, tau=tau, joint_names=leg.joint_names)


def cylinders() -> Actuators:
    """The assumed cylinders of BLEEX."""
    return read_actuators("bleex", exoid.load_leg("bleex"))


def of(found: exoid.Estimate) -> dict[str, Any]:
    """What an estimate says."""
    findings = [(each.kind, each.joint, each.severity) for each in found.findings]
    return {"values": dict(zip(found.names, found.values, strict=True)), "std": found.std, "findings": findings}


IN_C = (
    *("pd", "gravity_friction_pd", "feedforward_pd", "computed_torque", "lqr", "self_tuning", "gravity_support"),
    *("sensitivity_amplification", "impedance", "momentum_observer"),
)
"""Laws and observers that are written as C."""

# Commands: every verb, with its numbers as JSON.
for words in (
    *("identify bleex bleex_swing:train", "identify bleex bleex_swing:train --no-check --cutoff 5"),
    *("check bleex bleex_swing:train", "validate est.json bleex_swing:test", "interaction est.json worn.csv"),
    *("identify bleex forces.csv --actuators bleex --no-check", "compare est.json right.json"),
    *("identify bleex bleex_swing:train --terms coulomb,viscous,stiffness --no-check",),
    *("validate right.json right.csv --cutoff 6", "select bleex bleex_swing:train"),
    *("plan cuhk --noise 0.3 --velocity 2 --duration 10 --starts 1 --seed 3 -o plan.csv",),
    *("plan bleex --assess bleex_swing:train --noise 0.5", "track est.json --period 2", "reproduce cuhk"),
    *("track est.json --dry-run bleex_swing:test", "wear cuhk --period 2.5"),
    "reproduce bleex",
):
    JOURNEYS[f"exoid {words}"] = partial(command, *words.split(), "--json")
for words, file in (
    ("export est.json -o leg.urdf", "leg.urdf"),
    *((f"export est.json --c leg_{kind}.c --precision {kind}", f"leg_{kind}.c") for kind in ("double", "float")),
    *((f"export est.json --law {law} --c {law}.c", f"{law}.c") for law in IN_C),
    ("view bleex --pose left_hip=30 --html leg.html", ""),
):
    JOURNEYS[f"exoid {words}"] = partial(command, *words.split(), files=(file,) if file else ())


# Estimators, terms, drives.
for name in ("wls", "ols", "huber", "ml"):
    JOURNEYS[f"estimator {name}"] = lambda name=name: of(exoid.identify(*logged("cuhk"), estimator=name, check=False))

TERMS: Mapping[str, tuple[Any, ...]] = {
    "presliding": (exoid.Coulomb(presliding=1e-3), exoid.Viscous()),
    "stribeck": (exoid.Coulomb(), torques.Stribeck(), exoid.Viscous()),
    "load": (exoid.Coulomb(), torques.LoadFriction(), exoid.Viscous()),
    "load split": (torques.LoadFriction(split=True), exoid.Viscous()),
    "stiffness": (exoid.Coulomb(), exoid.Viscous(), exoid.Stiffness(degree=3)),
    "armature, offset": (exoid.Armature(), exoid.Offset()),
    "spring of two joints": (torques.CouplingSpring(joints=("hip", "knee"), ratios=(1.0, -0.6)), exoid.Coulomb()),
    "friction of two joints": (torques.CouplingFriction(joints=("hip", "knee"), ratios=(1.0, 0.5)), exoid.Viscous()),
    "rotor of two joints": (torques.CouplingInertia(joints=("hip", "knee"), ratios=(1.0, 0.5)), exoid.Viscous()),
}
for name, terms in TERMS.items():
    JOURNEYS[f"terms {name}"] = lambda terms=terms: of(exoid.identify(*logged("cuhk"), terms, check=False))

DRIVES: Mapping[str, Mapping[str, Any]] = {
    "motor": {"hip": Motor(0.07, ratio=50.0, efficiency=0.85), "knee": Motor(0.05, ratio=-30.0, max_current=40.0)},
    "arm table": {"knee": LinearActuator(MomentArmTable((-2.2, -1.5, -0.8, 0.1, 1.2), (0.04, 0.05, 0.05, 0.04, 0.03)))},
    "series elastic": {"hip": SeriesElastic(900.0, ratio=50.0)},
    "coupling": {"wrist": Coupling(("hip", "knee"), ((0.5, 0.5), (0.5, -0.5)))},
}
for name, drives in DRIVES.items():

    @journey(f"drive {name}")
    def drive(drives: Mapping[str, Any] = drives) -> Any:  # noqa: ANN401
        """Commands, torques of these commands, and an estimate from what the drive measures."""
        leg, log = logged("cuhk")
        actuators = Actuators.of(leg, drives)
        v = np.gradient(log.q, log.time, axis=0)
        there = actuators.command(0.2 * log.tau, log.q, v)
        measured = actuators.readings(replace(log, tau=0.2 * log.tau, v=v))
        return (
            there,
            actuators.torque_of(there, log.q, v),
            of(exoid.identify(leg, measured, actuators=actuators, check=False)),
        )


@journey("drive cylinders of bleex")
def _() -> Any:  # noqa: ANN401
    leg, log = logged("bleex")
    return of(exoid.identify(leg, cylinders().readings(log), actuators=cylinders(), check=False))


# Laws and observers, sample by sample and in a closed loop.
PD = {"kp": (200.0, 80.0), "kd": (20.0, 8.0)}
LAWS: Mapping[str, Callable[[Any], Any]] = {
    "pd": lambda known: control.pd(**PD),
    "gravity_friction_pd": lambda known: control.gravity_friction_pd(known, **PD),
    "computed_torque": lambda known: control.computed_torque(known, (100.0, 100.0), (20.0, 20.0)),
    "feedforward_pd": lambda known: control.feedforward_pd(known, **PD),
    "impedance": lambda known: control.impedance(known, **{"stiffness": PD["kp"], "damping": PD["kd"]}),
    "gravity_support": control.gravity_support,
    "lqr": lambda known: control.lqr(known, control.mean_pose(healthy_gait(period=2.0), 2.0)),
    "sensitivity_amplification": lambda known: control.sensitivity_amplification(known, 2.0),
    "self_tuning": lambda known: control.self_tuning(known, **PD),
}
for name, make in LAWS.items():

    @journey(f"law {name}")
    def law(make: Callable[[Any], Any] = make) -> Any:  # noqa: ANN401
        """Two seconds of a gait with noise, under a law that knows the leg from a log."""
        plant = rig.Plant.build(exoid.load_leg("cuhk"), exoid.published.cuhk_resistances())
        found = make(estimate("cuhk"))
        run = control.simulate_law(
            plant, found, healthy_gait(period=2.0), 2.0, sensors=rig.Sensors(velocity_noise=0.01)
        )
        return run.recording.q, run.recording.tau


@journey("observer momentum")
def _() -> Any:  # noqa: ANN401
    data = exoid.datasets.bleex_swing()
    observer = control.MomentumObserver(
        estimate(), bandwidth=16.0, rate=100.0, noise=control.SensorNoise.of(data.train)
    )
    found = observer.run(data.test)
    memory = observer.begin(data.test.q[0], tau=data.test.tau[0])
    steps = []
    for q, tau in zip(data.test.q[:200], data.test.tau[:200], strict=True):
        reading, memory = observer.step(memory, q, None, tau)
        steps.append(reading.torque)
    return found.torque, found.std, np.array(steps)


# Findings: every planted fault on three legs.
for fault in fault_lists.CORRUPTIONS:

    @journey(f"fault {fault.name}")
    def planted(fault: fault_lists.Corruption = fault) -> Any:  # noqa: ANN401
        """Findings in a log with the largest fault of its list."""
        log = fault.apply(faulty_logs.clean_log("cuhk", 7), fault.sizes[-1], np.random.default_rng(7))
        found = exoid.check(log.leg, log.recordings)
        return [(each.kind, each.joint, each.severity, each.value) for each in found]


# Bases, ground, wearer, payloads, groups, other robots.
@journey("moving base")
def _() -> Any:  # noqa: ANN401
    leg, log = logged("bleex")
    zero, time = np.zeros(len(log.time)), log.time
    pitch = 0.15 * np.sin(4.0 * time)
    gyro = np.column_stack([zero, np.gradient(pitch, time), zero])
    force = np.column_stack([-9.81 * np.sin(pitch), zero, 9.81 * np.cos(pitch)])
    base = exoid.BaseMotion.from_imu(gyro, force, position=(0.05, 0.0, 0.25))
    return of(exoid.identify(leg, replace(log, base=base), check=False))


@cache
def standing() -> tuple[Any, list[exoid.Recording]]:
    """Logs of a machine that swings, squats and stands on one foot."""
    machine = ground.bleex_machine()
    runs = [ground.swing(machine, 6.0, seed=3), ground.squats_and_shifts(machine, 6.0, seed=0)]
    runs.append(ground.single_support(machine, 6.0, standing=0, seed=1))
    return machine, [run.recording(seed=k, wrenches=("torso",) if k > 1 else ()) for k, run in enumerate(runs)]


@journey("stance")
def _() -> Any:  # noqa: ANN401
    exo, terms = (
        exoid.load_exo("bleex", base="floating"),
        (exoid.Coulomb(smoothing=0.02, reversal_speed=0.0), exoid.Viscous(), exoid.Armature()),
    )
    _, logs = standing()
    found = exoid.identify(exo, logs, terms=terms)
    forces = exoid.ground_forces(found, logs[1])
    checked = exoid.validate(found, logs[1])
    return of(found), [each.force for each in forces.values()], checked.rmse


@journey("walk of the rig")
def _() -> Any:  # noqa: ANN401
    run = ground.walking(ground.bleex_machine(), duration=3.0)
    return run.q, run.tau


@journey("interaction")
def _() -> Any:  # noqa: ANN401
    data = exoid.datasets.bleex_swing()
    push = 3.0 * np.sin(2.0 * np.pi * 0.7 * data.test.time)[:, None]
    found = exoid.interaction(estimate(), replace(data.test, tau=data.test.tau - push))
    return found.torque, found.band, found.rms, found.worn


@journey("groups")
def _() -> Any:  # noqa: ANN401
    legs = {side: exoid.load_leg("bleex", side=side) for side in ("left", "right")}
    logs = {"left": exoid.datasets.bleex_swing().train, "right": right_log(legs["right"])}
    found = exoid.identify(legs, logs, (exoid.Coulomb(), exoid.Viscous(), exoid.Offset()), check=False)
    return {side: of(found[side]) for side in legs}


@journey("payload")
def _() -> Any:  # noqa: ANN401
    leg, log = logged("cuhk")
    payload = exoid.Payload("shank", 2.0, (0.0, 0.0, -0.2))
    return of(exoid.identify(leg, [log, replace(log, payloads=(payload,))], check=False))


@journey("on line")
def _() -> Any:  # noqa: ANN401
    leg, log = logged("bleex")
    online = RecursiveEstimator(leg, rate=log.sample_rate, cutoff=8.0)
    for q, tau in zip(log.q, log.tau, strict=True):
        online.update(q, None, None, tau)
    return of(online.estimate)


@journey("law within limits")
def _() -> Any:  # noqa: ANN401
    law = control.Limited(control.gravity_friction_pd(estimate("cuhk"), **PD), limit=(30.0, 12.0), slew=400.0)
    gait, rng, torques = healthy_gait(period=2.0), np.random.default_rng(4), [np.zeros(2)]
    for t in np.arange(0.0, 1.0, 1.0 / law.rate):
        target = rig.Target(*(x[:, 0] for x in gait.at(t)))
        q, v = target.q + 0.02 * rng.standard_normal(2), target.v + 0.1 * rng.standard_normal(2)
        state = control.State(q, v, t, torques[-1])
        torques.append(law.step(law.begin(state), state, target)[0])
    return np.array(torques[1:])


@journey("own offsets of two logs")
def _() -> Any:  # noqa: ANN401
    leg, log = logged("cuhk")
    other = replace(logged("cuhk", 1)[1], tau=logged("cuhk", 1)[1].tau + np.array([0.8, -0.4]))
    terms = (exoid.Coulomb(), exoid.Viscous(), exoid.Offset())
    found = exoid.identify(leg, {"Monday": log, "Tuesday": other}, terms, own=("offset",), check=False)
    return {key: of(found[key]) for key in ("Monday", "Tuesday")}


@journey("on line with a payload half way")
def _() -> Any:  # noqa: ANN401
    leg, log = logged("bleex")
    v = np.gradient(log.q, log.time, axis=0)
    a = np.gradient(v, log.time, axis=0)
    half = len(log.time) // 2
    heavier = np.array([0.8 * (name == "X2") + 0.2 * (name == "J2") for name in leg.parameter_names])
    more = leg.regressor(log.q, v, a) @ heavier
    tau = log.tau + more * (np.arange(len(log.time)) >= half)[:, None]
    online = RecursiveEstimator(leg, rate=log.sample_rate, cutoff=8.0)
    for q, torque in zip(log.q, tau, strict=True):
        online.update(q, None, None, torque)
    return of(online.estimate)


@journey("log as mat and mot")
def _() -> Any:  # noqa: ANN401
    from scipy.io import savemat  # noqa: PLC0415 - only this journey

    prepare_folder()
    _, log = logged("cuhk")
    names = [f"{key}_{joint}" for key in ("q", "tau") for joint in log.joint_names]
    table = np.column_stack([log.q, log.tau])
    savemat("log.mat", {"time": log.time, **dict(zip(names, table.T, strict=True))})
    head = f"log\nversion=1\nnRows={len(table)}\nnColumns={len(names) + 1}\ninDegrees=no\nendheader\n"
    lines = ["\t".join(map(repr, map(float, (t, *row)))) for t, row in zip(log.time, table, strict=True)]
    Path("log.mot").write_text(head + "\t".join(["time", *names]) + "\n" + "\n".join(lines) + "\n", encoding="utf-8")
    read = [exoid.Recording.from_file(f"log.{ending}", joint_names=log.joint_names) for ending in ("mat", "mot")]
    return [(each.time, each.q, each.tau) for each in read]


@journey("numeric base parameters of a leg whose base moves in space")
def _() -> Any:  # noqa: ANN401
    leg = exoid.load_leg("bleex", base="moving")
    q, v, a = np.random.default_rng(3).standard_normal((3, 50, 3))
    return leg.parameter_names, leg.parameters, leg.regressor(q, v, a), leg.inverse_dynamics(q, v, a)


class NoCompilerError(Exception):
    """This machine has no C compiler."""


def compiled(files: Mapping[str, str]) -> ctypes.CDLL:
    """Compile C into a library; the first file is the source, others are its headers."""
    if shutil.which("cc") is None:
        raise NoCompilerError("no C compiler (cc)")
    folder = Path(tempfile.mkdtemp())
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
    build = ["cc", "-std=c99", "-O2", "-shared", "-fPIC", "-ffp-contract=off", next(iter(files)), "-o", "it.so", "-lm"]
    subprocess.run(build, cwd=folder, check=True)
    return ctypes.CDLL(str(folder / "it.so"))


@journey("C of a leg, compiled and run")
def _() -> Any:  # noqa: ANN401
    path = Path(tempfile.mkdtemp()) / "leg.c"
    library = compiled(estimate().to_c(str(path)).files)
    torque, pointer = library.leg_inverse_dynamics, ctypes.POINTER(ctypes.c_double)
    torque.restype = None
    q, v, a = np.random.default_rng(3).standard_normal((3, 50, 3))
    out = np.zeros((50, 3))
    for rows in zip(q, v, a, out, strict=True):
        torque(*(row.ctypes.data_as(pointer) for row in rows))
    return out


LAWS_IN_C: Mapping[str, Callable[[Any], Any]] = {
    **{name: make for name, make in LAWS.items() if name != "self_tuning"},  # it has no C
    "limited": lambda known: control.Limited(control.gravity_friction_pd(known, **PD), (30.0, 12.0), 400.0),
    "momentum observer": lambda known: control.MomentumObserver(known, 8.0, 100.0, noise=SENSED, torque_delay=0.0),
}
SENSED = control.SensorNoise(0.05, 0.05)


def noisy_gait(rate: float) -> dict[str, Any]:
    """Readings and targets of a second of a gait, with noise by seed; what the C of a law reads."""
    rng, gait, time = np.random.default_rng(4), healthy_gait(period=2.0), np.arange(0.0, 1.0, 1.0 / rate)
    aims = [gait.at(t) for t in time]
    q_d, v_d, a_d = (np.array([np.ravel(getattr(aim, key)) for aim in aims]) for key in ("q", "v", "a"))
    q, v = (x + scale * rng.standard_normal(x.shape) for x, scale in ((q_d, 0.02), (v_d, 0.1)))
    tau = 5.0 * np.column_stack([np.sin(7.0 * time), np.cos(5.0 * time)])
    counts = np.arange(1, len(time) + 1)
    return {"q": q, "v": v, "q_d": q_d, "v_d": v_d, "a_d": a_d, "time": time, "interaction": tau, "tau_m": tau} | {
        "reading": counts,
        "target": counts,
    }


def run_in_python(law: Any, gait: Mapping[str, Any]) -> np.ndarray:  # noqa: ANN401
    """Torques of a law or an observer, sample by sample."""
    found, last = [], np.zeros(2)
    if isinstance(law, control.MomentumObserver):
        memory = law.begin(gait["q"][0], gait["v"][0], gait["tau_m"][0])
        for readings in zip(gait["q"], gait["v"], gait["tau_m"], strict=True):
            reading, memory = law.step(memory, *readings)
            found.append(reading.torque)
        return np.array(found)
    steps = control.stateful(law)
    memory = steps.begin(control.State(gait["q"][0], gait["v"][0]))
    for k, t in enumerate(gait["time"].tolist()):
        state = control.State(gait["q"][k], gait["v"][k], t, last, gait["interaction"][k])
        last, memory = steps.step(memory, state, rig.Target(gait["q_d"][k], gait["v_d"][k], gait["a_d"][k]))
        found.append(last)
    return np.array(found)


def run_in_c(law: Any, gait: Mapping[str, Any]) -> tuple[np.ndarray, np.ndarray]:  # noqa: ANN401
    """Torques and statuses of the C of a law or an observer."""
    source = codegen.c_source(law)
    library, others = compiled(source.files), source.content.inputs
    counters = ["reading", *(["target"] if any(each.source == "target" for each in others) else [])]
    fields = [("q", "f8", 2), ("v", "f8", 2), *((x.name, "f8", 2) for x in others)]
    rows = np.zeros(len(gait["time"]), np.dtype([*fields, *((name, "u4") for name in counters)], align=True))
    for name in rows.dtype.names:
        rows[name] = gait[name]
    state = ctypes.create_string_buffer(1 << 20)  # larger than the memory of any law
    tau, status = np.zeros((len(rows), 2)), np.zeros(len(rows), np.int32)
    library.law_init(state)
    for k in range(len(rows)):
        at = (each[k : k + 1].ctypes.data_as(ctypes.c_void_p) for each in (rows, tau))
        status[k] = library.law_step(state, *at)
    return tau, status


for name, make in LAWS_IN_C.items():

    @journey(f"C of {name}, compiled and run")
    def law_in_c(make: Callable[[Any], Any] = make) -> Any:  # noqa: ANN401
        """Torques of the C, which are those of Python but for rounding."""
        law = make(estimate("cuhk"))
        gait = noisy_gait(law.rate)
        expected, (found, status) = run_in_python(law, gait), run_in_c(law, gait)
        return found, bool(status.any()), bool(np.abs(found - expected).max() <= 1e-10 * np.abs(expected).max())


@journey("lift and prediction")
def _() -> Any:  # noqa: ANN401
    found, data = estimate(), exoid.datasets.bleex_swing()
    checked = exoid.validate(found, data.test)
    q, v, a = np.random.default_rng(3).standard_normal((3, 50, 3))
    return (
        found.leg.link_parameters,
        found.torque(q, v, a),
        checked.rmse,
        checked.nrmse,
        checked.r2,
        found.interval(0.95),
    )


# Rig, protocols and references; filters and readers.
@journey("rig with stick and slip")
def _() -> Any:  # noqa: ANN401
    plant = rig.Plant.build(exoid.load_leg("cuhk"), {"c0_hip": 1.4, "c0_knee": 0.6, "d_knee": 0.2})
    law = rig.ProportionalDerivative(stiffness=(200.0, 80.0), damping=(20.0, 8.0))
    sensors = rig.Sensors(torque_noise=0.3)
    run = rig.simulate(plant, healthy_gait(), law, rig.IdealTorque(), duration=2.0, sensors=sensors, seed=1)
    return run.q, run.tau_measured, run.energy.work


@journey("rig with a wearer")
def _() -> Any:  # noqa: ANN401
    plant = rig.Plant.build(exoid.load_leg("cuhk"), exoid.published.cuhk_resistances())
    wearer = rig.Wearer.build(plant.leg, 1.75, 75.0)
    law = rig.ProportionalDerivative(stiffness=(200.0, 80.0), damping=(20.0, 8.0))
    run = rig.simulate(plant, healthy_gait(), law, rig.IdealTorque(), duration=2.0, wearer=wearer)
    return run.q, run.interaction


@journey("gait reference")
def _() -> Any:  # noqa: ANN401
    gait = healthy_gait(period=2.0)
    return [gait.at(t).q for t in np.linspace(0.0, 2.0, 20)], [experiments.cuhk.swing(experiments.cuhk.HIP).at(0.3).q]


@journey("filters")
def _() -> Any:  # noqa: ANN401
    signal = np.random.default_rng(5).standard_normal((500, 2))
    return signals.zero_phase(signal, 100.0, 8.0)


for ending in ("csv", "npz", "parquet"):

    @journey(f"log as {ending}")
    def log_as(ending: str = ending) -> Any:  # noqa: ANN401
        """A log that is written and read again."""
        prepare_folder()
        _, log = logged("bleex")
        if ending == "csv":
            log.to_csv("log.csv")
        elif ending == "npz":
            channels = {
                f"{sign}_{name}": getattr(log, key)[:, k]
                for k, name in enumerate(log.joint_names)
                for sign, key in (("q", "q"), ("tau", "tau"))
            }
            np.savez("log.npz", time=log.time, **channels)
        else:
            import polars  # noqa: PLC0415 - optional

            polars.read_csv("forces.csv").write_parquet("log.parquet")
        found = exoid.Recording.from_file(f"log.{ending}", joint_names=log.joint_names)
        return found.time, found.q, found.tau, found.force


def fingerprint(value: Any) -> Any:  # noqa: ANN401 - any result
    """Reduce a result to JSON: numbers, words, and some entries, sum and norm of arrays."""
    if isinstance(value, Mapping):
        return {str(key): fingerprint(item) for key, item in value.items()}
    if isinstance(value, np.ndarray) and value.size > 1 and value.dtype.kind in "fiub":
        flat = np.asarray(value, dtype=np.float64).ravel()
        kept = flat[np.unique(np.linspace(0, flat.size - 1, min(KEPT, flat.size)).astype(int))]
        good = flat[np.isfinite(flat)]
        return {
            "shape": list(value.shape),
            "some": fingerprint(kept.tolist()),
            "sum": float(good.sum()),
            "norm": float(np.linalg.norm(good)),
        }
    if isinstance(value, np.ndarray | np.generic):
        return fingerprint(value.tolist())
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [fingerprint(item) for item in value]
    if isinstance(value, float):
        return value if np.isfinite(value) else str(value)
    return value if isinstance(value, str | int | bool | None) else type(value).__name__


def run(name: str) -> tuple[str, Any, float]:
    """Run one journey; its fingerprint and its time [s]."""
    start = time.monotonic()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            found = fingerprint(JOURNEYS[name]())
        except NoCompilerError as error:
            found = {"skipped": str(error)}
        except ExoidError as error:
            found = {"refused": error.what}
        except Exception as error:  # a journey that the code does not know any more
            found = {"raised": f"{type(error).__name__}: {error}"}
    return name, found, time.monotonic() - start


def difference(old: Any, new: Any) -> tuple[float, str]:  # noqa: ANN401
    """Largest relative difference of two fingerprints, and where; infinite for other words, keys or lengths."""
    if isinstance(old, dict) and isinstance(new, dict):
        if old.keys() != new.keys():
            return np.inf, f"keys {sorted(old.keys() ^ new.keys())}"
        parts = [(difference(old[key], new[key]), key) for key in old]
    elif isinstance(old, list) and isinstance(new, list):
        if len(old) != len(new):
            return np.inf, f"{len(old)} entries, now {len(new)}"
        if old and all(isinstance(x, float) for x in (*old, *new)):
            gap, size = np.abs(np.subtract(old, new)), np.maximum(np.abs(old), np.abs(new))
            counted = gap > FLOOR * size.max()
            return (float((gap[counted] / size[counted]).max()), "") if counted.any() else (0.0, "")
        parts = [(difference(x, y), str(k)) for k, (x, y) in enumerate(zip(old, new, strict=True))]
    elif isinstance(old, int | float) and isinstance(new, int | float) and not isinstance(old, bool):
        gap = abs(old - new)
        return (gap / max(abs(old), abs(new)), "") if gap > FLOOR else (0.0, "")
    else:
        return (0.0, "") if old == new else (np.inf, f"{str(old)[:60]!r}, now {str(new)[:60]!r}")
    (worst, where), key = max(parts, key=lambda part: part[0][0], default=((0.0, ""), ""))
    return worst, f"{key}/{where}" if worst > 0.0 else ""


def main() -> None:
    """Store or compare."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--store", type=Path, help="file to write the numbers to")
    parser.add_argument("--compare", type=Path, help="file of numbers to compare with")
    parser.add_argument("--list", action="store_true", help="print the names of the journeys")
    parser.add_argument("-k", default="", help="only journeys whose name has this text")
    parser.add_argument("--tolerance", type=float, default=1e-9, help="largest relative difference")
    parser.add_argument("--jobs", type=int, default=2, help="number of processes")
    options = parser.parse_args()
    names = [name for name in JOURNEYS if options.k in name]
    if options.list:
        sys.exit("\n".join(names) + f"\n{len(names)} journeys" if names else "none")
    if not names:
        parser.error(f"no journey has {options.k!r} in its name")
    targets = {key: path.resolve() for key in ("store", "compare") if (path := getattr(options, key))}
    found: dict[str, Any] = {}
    with ProcessPoolExecutor(options.jobs) as pool:
        for name, result, seconds in pool.map(run, names):
            found[name] = result
            print(
                f"{seconds:6.1f} s  {name}  {str(result)[:70] if 'raised' in result or 'refused' in result else ''}",
                file=sys.stderr,
            )
    if "store" in targets:
        targets["store"].write_text(
            json.dumps(found, separators=(",", ":"), ensure_ascii=False) + "\n", encoding="utf-8"
        )
    skipped = [name for name in names if isinstance(found[name], dict) and "skipped" in found[name]]
    for name in skipped:
        print(f"SKIPPED  {name}  {found[name]['skipped']}")
    raised = [name for name in names if isinstance(found[name], dict) and "raised" in found[name]]
    for name in raised:
        print(f"RAISED  {name}  {found[name]['raised']}")
    moved, gone = 0, []
    if "compare" in targets:
        old = json.loads(targets["compare"].read_text(encoding="utf-8"))
        compared = [name for name in names if name not in skipped]
        for name in compared:
            worst, where = difference(old[name], found[name]) if name in old else (np.inf, "is new")
            moved += worst > options.tolerance
            if worst > 0.0:
                print(f"{'MOVED' if worst > options.tolerance else 'same '} {worst:9.2e}  {name}  {where}")
        gone = [name for name in old if options.k in name and name not in JOURNEYS]
        for name in gone:
            print(f"GONE  {name}")
        print(f"{len(compared) - moved} of {len(compared)} journeys equal to {options.tolerance:g}")
    sys.exit(bool(moved or raised or gone))


if __name__ == "__main__":
    main()
