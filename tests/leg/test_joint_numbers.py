"""Numbers of joints: one for all, one for each, and what is neither."""

import numpy as np
import pytest

from exoid.errors import BadArgumentError
from exoid.leg.joint_numbers import for_joints


@pytest.mark.parametrize("value", [2.0, [2.0], [2.0, 2.0, 2.0]])
def test_one_number_stands_for_all_joints(value):
    np.testing.assert_array_equal(for_joints(value, 3, "gain"), [2.0, 2.0, 2.0])


@pytest.mark.parametrize("value", [[1.0, 2.0], [], "stiff", [[1.0], [2.0, 3.0]], [[1.0, 2.0, 3.0]]])
def test_what_is_neither_one_number_nor_one_for_each_is_refused(value):
    with pytest.raises(BadArgumentError, match="gain"):
        for_joints(value, 3, "gain")
