"""Numbers are taken as they are, or refused by the name of what they are."""

import numpy as np
import pytest

from exoid.errors import BadArgumentError
from exoid.tools.numbers import checked


@pytest.mark.parametrize(
    ("value", "bounds"),
    [
        *((value, {}) for value in (np.nan, np.inf, "8", 1j, None, [1.0, [2.0]], np.ones((9, 9)), [np.nan] * 999)),
        (0.0, {"above": 0.0}),
        (-0.1, {"least": 0.0}),
        ([0.5, 1.1], {"most": 1.0}),
        (np.nan, {"infinite": True}),
    ],
)
def test_what_is_no_such_number_is_refused(value, bounds):
    with pytest.raises(BadArgumentError, match=r"^the gain is .{,60}give (finite )?numbers"):
        checked(value, "the gain", **bounds)


def test_good_numbers_are_copied_and_read_only():
    given = np.array([0.0, 2.0])
    found = checked(given, "the gain", least=0.0, most=2.0)
    given[0] = -1.0
    np.testing.assert_array_equal(found, [0.0, 2.0])
    assert not found.flags.writeable
    assert checked(np.inf, "the limit", above=0.0, infinite=True) == np.inf
