"""Columns of faults are derivatives of the torque; averaging a fast log changes no finding."""

import dataclasses

import numpy as np
import pytest
from logs import clean, late, of_kind
from public_robots import PUBLIC

import exoid
from exoid.checks.sample import averaged
from exoid.dynamics import inverse_dynamics, inverse_dynamics_slopes
from exoid.signals import FiniteDifference, ZeroPhase
