"""The package exoid_springs in this process."""

import pytest
from springs import load_module, swing_with_stops

from exoid.codegen.forms import FORMS


@pytest.fixture(scope="session")
def springs():
    """The package, imported and not registered."""
    module = load_module()
    yield module
    FORMS.pop(module.EndStop)


@pytest.fixture(scope="session")
def recording():
    """A log of a leg with end stops."""
    return swing_with_stops()
