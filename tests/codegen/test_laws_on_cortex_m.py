"""Laws on an emulated Cortex-M4F: the torques of Python, and how many instructions a step takes.

``pytest -m nightly tests/codegen/test_laws_on_cortex_m.py -s`` prints the instructions.
"""

import numpy as np
import pytest
from compiled_laws import records
from cortex_m import RAM, Machine, compile_for_cortex_m, needs_cortex_m
from laws_of_bleex import laws, random_values, torques_in_python

from exoid.codegen import c_source

pytestmark = [needs_cortex_m, pytest.mark.nightly]

ROWS = 20
STATE, INPUT, TORQUE = RAM + 0x1000, RAM + 0x8000, RAM + 0x9000


@pytest.mark.parametrize("name", ["gravity_friction_pd", "computed_torque", "sensitivity_amplification", "lqr"])
@pytest.mark.parametrize(("precision", "error"), [("float", 1e-5), ("double", 1e-12)])
def test_a_law_runs_on_a_microcontroller(name, precision, error, tmp_path):
    source, values = c_source(laws()[name], name="law", precision=precision), random_values(ROWS)
    for file, text in source.files.items():
        (tmp_path / file).write_text(text)
    machine = Machine(compile_for_cortex_m([tmp_path / "law.c"], ("law_step", "law_init"), tmp_path), count=True)
    machine.call("law_init", STATE)
    torques, taken = [], []
    for row in records(source, ROWS, values):
        before = machine.instructions()
        machine.uc.mem_write(INPUT, row.tobytes())
        assert machine.call("law_step", STATE, INPUT, TORQUE) == 0
        taken.append(machine.instructions() - before)
        torques.append(np.frombuffer(bytes(machine.uc.mem_read(TORQUE, 3 * row["q"].itemsize)), row["q"].dtype))
    print(
        f"\n{name}, {precision}: {max(taken)} instructions at most, {np.mean(taken):.0f} on average, "
        f"{machine.instructions('law_') / ROWS:.0f} of them in functions of the law; {machine.elf.flash} bytes"
    )
    expected = torques_in_python(laws()[name], values)
    np.testing.assert_allclose(torques, expected, atol=error * np.abs(expected).max(), rtol=0)
    assert 100 < min(taken) <= max(taken) < 200_000
