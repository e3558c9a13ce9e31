"""Registries that forget what a test registered, and the package exoid_springs in this process."""

from __future__ import annotations

import pytest
from springs import load_module, swing_with_stops

from exoid.codegen.forms import FORMS
from exoid.identification import ESTIMATORS
from exoid.signals import PREPARATIONS
from exoid.signals.formats import READERS
from exoid.torques import TERMS

REGISTRIES = {"term": TERMS, "estimator": ESTIMATORS, "preparation": PREPARATIONS, "log format": READERS}


@pytest.fixture
def forgetful(monkeypatch):
    """Registries that have afterwards what they had before."""
    for registry in REGISTRIES.values():
        monkeypatch.setattr(registry, "_registered", dict(registry._registered))
    return REGISTRIES


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
