"""How many cases each property is tried on: 480 in all, or as many as ``EXOID_PROPERTY_CASES`` says."""

import functools
import os
from collections import Counter

from hypothesis import HealthCheck, settings

TOTAL = int(os.environ.get("EXOID_PROPERTY_CASES", "480"))

DONE: Counter[str] = Counter()
"""Cases that ran, by test."""


def cases(share):
    """Try a property on a share of all cases; put it above ``@given``."""
    limit = settings(max_examples=max(1, round(share * TOTAL)), deadline=None, suppress_health_check=list(HealthCheck))

    def counted(test):
        inner = test.hypothesis.inner_test

        @functools.wraps(inner)
        def once(*args, **kwargs):
            DONE[test.__name__] += 1
            return inner(*args, **kwargs)

        test.hypothesis.inner_test = once
        return limit(test)

    return counted
