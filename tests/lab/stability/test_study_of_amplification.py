"""The predicted largest amplification is the boundary of simulated worn legs on the virtual rig.

CI simulates two draws of each leg; ``python scripts/study_amplification.py`` prints ten.
"""

import numpy as np
import pytest
import study_amplification as study


@pytest.mark.nightly
@pytest.mark.parametrize(("leg", "delay"), [("bleex", 0), ("cuhk", 2)])
def test_worn_legs_settle_inside_the_predicted_boundary_and_grow_outside(leg, delay):
    for found in study.boundaries(leg, 0.15, 2, delay, 8.0, coulomb=False):
        assert found.growth[0] < 0.0 < found.growth[-1]
        assert np.interp(0.0, found.growth, study.FACTORS) == pytest.approx(1.0, abs=0.05)
