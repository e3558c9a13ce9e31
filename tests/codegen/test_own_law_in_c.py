"""A law from outside exoid says how it looks in C, with memory of its own."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from compiled import needs_compiler
from compiled_laws import compile_laws, records
from laws_of_bleex import KD, KP, laws, observer, random_values, torques_in_python

from exoid.codegen import REFERENCE, ArrayInC, Dialect, LawInC, c_source, write_ros2
from exoid.control import Limited


class Filtered(NamedTuple):
    """Memory: filtered velocities [rad/s], and the sum of errors [rad]."""

    v: np.ndarray
    sum: np.ndarray


@dataclass(frozen=True)
class FilteredPID:
    """PID control with a low-pass of the velocity: a law with memory, as another package would write it."""

    share: float = 0.2
    rate: float = 100.0

    def begin(self, state):
        return Filtered(state.v, np.zeros_like(state.q))

    def step(self, memory, state, target):
        v = memory.v + self.share * (state.v - memory.v)
        total = memory.sum + (target.q - state.q)
        return KP * (target.q - state.q) - KD * v + 0.5 * total, Filtered(v, total)

    def in_c(self, dialect: Dialect) -> LawInC:
        share = ArrayInC("share", "share of the filter", np.array(self.share))
        tables = share, ArrayInC("kp", "Kp [N m/rad]", KP), ArrayInC("kd", "Kd [N m s/rad]", KD)
        slow = ArrayInC("v_slow", "filtered velocity [rad/s]", np.zeros(3))
        memory = slow, ArrayInC("sum", "sum of errors [rad]", np.zeros(3))
        joints = ("hip", "knee", "ankle")
        return LawInC(joints, "PID */ int x; /*", STEP, self.rate, KD, REFERENCE, tables, memory, BEGIN)


STEP = """\
    for (j = 0; j < {{N}}; ++j) {
        state->v_slow[j] += {{p}}_share * (in->v[j] - state->v_slow[j]);
        state->sum[j] += in->q_d[j] - in->q[j];
        tau[j] = {{p}}_kp[j] * (in->q_d[j] - in->q[j]) - {{p}}_kd[j] * state->v_slow[j];
        tau[j] += {{number(0.5)}} * state->sum[j];
    }
"""

BEGIN = """\
    for (j = 0; j < {{N}}; ++j) {
        state->v_slow[j] = in->v[j];
    }
"""


@needs_compiler
def test_a_law_with_memory_begins_again_after_a_fault(tmp_path):
    source = c_source(FilteredPID(), name="own")
    (law,), values = compile_laws([source], tmp_path).values(), random_values(40)
    rows = records(source, 40, values)
    rows["q"][20, 1] = np.nan
    before, after = ({name: x[part] for name, x in values.items()} for part in (slice(20), slice(21, 40)))
    tau, status, _ = law.run(rows)
    assert status.tolist() == [0] * 20 + [1] + [0] * 19
    np.testing.assert_allclose(tau[:20], torques_in_python(FilteredPID(), before), atol=1e-11)
    np.testing.assert_allclose(tau[20], -KD * values["v"][20], atol=1e-11)
    np.testing.assert_allclose(tau[21:], torques_in_python(FilteredPID(), after), atol=1e-11)


def test_joints_without_a_limit_of_the_torque_are_named(tmp_path):
    """Also in a package for ROS 2; an observer commands nothing."""
    half = Limited(laws()["impedance"], (50.0, np.inf, 30.0))
    for source in (c_source(half), write_ros2(tmp_path / "leg", half)):
        assert len(source.warnings) == 1
        for text in (source.warnings[0], source.files.get("law.h") or source.files["include/leg/leg.h"]):
            assert "no limit of the torque at left_knee" in text
    assert not any(c_source(law).warnings for law in (Limited(half, 60.0), observer()))
    assert "+ F(v), never driving" in c_source(laws()["sensitivity_amplification"]).header
