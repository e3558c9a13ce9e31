"""What a user meets: a CSV and the URDF of a drawn machine, on the command line. Seeds are those to tune on."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from log_writers import write_columns

from .machine import draw
from .simulate import simulate

pytestmark = pytest.mark.slow


@cache
def ground(seed):
    """A machine, its log and the truth."""
    machine = draw(seed).with_sensing(delay=0.0, rate=100)
    return machine, simulate(machine, 8.0)


def run(exoid_, verb, seed, columns, *options):
    """Write URDF and CSV, with these columns besides the time and the angles; give what the verb prints as JSON."""
    (machine, log), table = ground(seed), {"time": log_time(seed), **columns}
    for name, angle in zip(machine.names, log.recording.q.T, strict=True):
        table.setdefault(f"q_{name}", angle)
    Path("leg.urdf").write_text(machine.urdf(believed=True), encoding="utf-8")
    kept = np.isfinite(table["time"])
    write_columns(Path("log.csv"), **{name: values[kept] for name, values in table.items()})
    return exoid_(verb, "leg.urdf", "log.csv", *options, "--json").data


def log_time(seed):
    return ground(seed)[1].recording.time


def torques(seed, tau=None):
    """Columns of torques."""
    machine, log = ground(seed)
    return dict(
        zip((f"tau_{name}" for name in machine.names), (log.recording.tau if tau is None else tau).T, strict=True)
    )


def truth(seed):
    leg = ground(seed)[0].leg(believed=False)
    return dict(zip(leg.parameter_names, leg.parameters.tolist(), strict=True))


def test_rotors_are_found_where_all_links_are_known(exoid_):
    known = [part for name, value in truth(19).items() for part in ("--known", f"{name}={value!r}")]
    found = run(exoid_, "identify", 19, torques(19), *known, "--no-check")["values"]
    for joint in ground(19)[0].joints:
        assert found[f"Ia_{joint.name}"] == pytest.approx(joint.rotor, rel=0.1)


def test_intervals_of_a_leg_with_a_passive_joint_hold(exoid_):
    columns = {name: x for name, x in torques(38).items() if name != "tau_j4"}
    done = run(exoid_, "identify", 38, columns, "--passive", "j4", "--radians")
    low, high = np.array([done["interval_95"][name] for name in ("X4", "Y4", "J4")]).T
    true = np.array([truth(38)[name] for name in ("X4", "Y4", "J4")])
    assert ((low <= true) & (true <= high)).all()


def test_gaps_and_repeated_stamps_split_a_log_if_asked(exoid_):
    time = log_time(19).copy()
    time[(time > 3.0) & (time < 3.4)] = np.nan
    time[600] = time[599]
    part = run(exoid_, "identify", 19, {**torques(19), "time": time}, "--gaps", "split", "--no-check")
    whole = run(exoid_, "identify", 19, torques(19), "--no-check")
    for name in truth(19):
        assert abs(part["values"][name] - whole["values"][name]) < 2.0 * part["std"][name]


@pytest.mark.parametrize("kind", ["unsigned-torque", "gravity-compensated-effort", "two-clocks"])
def test_a_log_of_torques_that_are_none_is_named(exoid_, kind):
    machine, log = ground(19)
    time, tau, q = log.recording.time, log.recording.tau, log.recording.q
    wrong = {
        "unsigned-torque": np.abs(tau),
        "gravity-compensated-effort": tau - machine.leg(believed=False).gravity(q),
        "two-clocks": np.column_stack([np.interp(0.995 * time, time, x) for x in tau.T]),
    }[kind]
    assert kind in {one["kind"] for one in run(exoid_, "check", 19, torques(19, wrong))["findings"]}
    assert kind not in {one["kind"] for one in run(exoid_, "check", 19, torques(19))["findings"]}


def test_a_force_that_is_known_in_newtons_gives_torque_constants(exoid_):
    """A one-axis sensor at the last link, which pulls in no friction."""
    machine, log = ground(19)
    leg, force = machine.leg(believed=False), 30.0 * np.sin(7.0 * log.truth.time) + 20.0 * np.sin(17.0 * log.truth.time)
    pull = leg.frame_jacobian(log.truth.q, "link_j3", (0.0, 0.0, -0.1))[:, 0] * force[:, None]
    constants = 0.01 * np.arange(5.0, 8.0)
    current = (log.truth.rigid - pull) / (50.0 * constants)
    columns = {f"i_{name}": x for name, x in zip(machine.names, current.T, strict=True)}
    columns["wrench_link_j3_fx"] = force
    drive = "type = 'motor'\ntorque_constant = 'unknown'\nratio = 50.0\n"
    Path("drives.toml").write_text("".join(f"[{name}]\n{drive}" for name in machine.names), encoding="utf-8")
    found = run(
        exoid_, "identify", 19, columns, "--actuators", "drives.toml", "--wrench", "link_j3:link@0,0,-0.1",
        "--terms", "none", "--no-check",
    )  # fmt: skip
    for name, constant in zip(machine.names, constants, strict=True):
        assert found["shapes"]["values"][f"kt_{name}"] == pytest.approx(constant, rel=0.01)
