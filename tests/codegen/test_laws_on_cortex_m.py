"""Laws on an emulated Cortex-M: the torques of Python, and how many instructions a step takes.

``pytest tests/codegen/test_laws_on_cortex_m.py -s`` prints the instructions.
"""

from __future__ import annotations

import numpy as np
import pytest
from compiled_laws import records
from cortex_m import BOARDS, emulate, needs_cortex_m
from laws_of_bleex import laws, random_values, torques_in_python

from exoid.codegen import c_source

pytestmark = needs_cortex_m

CASES = [
    pytest.param(name, board, marks=() if name == "computed_torque" else pytest.mark.slow)
    for name in ("gravity_friction_pd", "computed_torque", "sensitivity_amplification", "lqr")
    for board in BOARDS
]
ROWS = 20


@pytest.mark.parametrize(("name", "board"), CASES)
def test_a_law_in_single_precision_runs_on_a_microcontroller(name, board, tmp_path):
    source = c_source(laws()[name], name="law", precision="float")
    values = random_values(ROWS)
    found = emulate(source, records(source, ROWS, values), BOARDS[board], tmp_path)
    print(
        f"\n{name} on {board}: {found.mean:.0f} instructions a step, {found.most:.0f} at most; "
        f"{found.code} bytes of program"
    )
    assert not found.status.any()
    expected = torques_in_python(laws()[name], values)
    np.testing.assert_allclose(found.torque, expected, atol=1e-5 * np.abs(expected).max())
    assert found.per_tick == pytest.approx(5.0, rel=1e-3)  # it is instructions that are counted
    assert 100 < found.mean <= found.most < 100_000
