"""Terms and models that make no sense are refused: the kind of the error, with what to do."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from outcomes import refused

import exoid
from exoid import Armature, Coulomb, Offset, Stiffness, Viscous
from exoid.errors import BadArgumentError, ExoidError
from exoid.torques import CoordinateTerm, CouplingFriction, CouplingInertia, CouplingSpring, Stribeck, TorqueModel
from exoid.torques.catalog import TERMS

LEG = exoid.load_leg("cuhk")
BOTH = ("hip", "knee")


@dataclass(frozen=True, kw_only=True)
class Loaded(CoordinateTerm):
    """Would read the load."""

    symbols = ("f",)
    units = ("1",)
    loaded = True

    def fill(self, motion, out):
        out[0] = motion.load


class Magnet(Offset):
    """A term that files do not know."""


def spring(joints=BOTH, ratios=(1.0, 1.0)):
    return CouplingSpring(joints=joints, ratios=ratios)


SETTINGS = {
    "negative smoothing": lambda: Coulomb(smoothing=-0.1),
    "infinite dead band": lambda: Coulomb(dead_band=np.inf),
    "negative presliding": lambda: Coulomb(presliding=-1.0),
    "Stribeck at rest": lambda: Stribeck(velocity=0.0),
    "half a degree": lambda: Stiffness(degree=2.5),
    "no joints": lambda: spring(joints=None),
    "one joint": lambda: spring(("hip",), (1.0,)),
    "joints as text": lambda: spring("hip", (1.0,)),
    "joint twice": lambda: spring(("hip", "hip")),
    "joint by two names": lambda: TorqueModel(LEG, (spring(("hip", "left_hip")),)),
    "joint not there": lambda: TorqueModel(LEG, (spring(("hip", "toe")),)),
    "joint not there, alone": lambda: TorqueModel(LEG, (Coulomb(joints=("toe",)),)),
    "too few ratios": lambda: spring(ratios=(1.0,)),
    "ratio of text": lambda: spring(ratios=(1.0, "a")),
    "ratio missing": lambda: spring(ratios=(1.0, np.nan)),
    "ratio zero": lambda: CouplingInertia(joints=BOTH, ratios=(1.0, 0.0)),
    "negative smoothing of motors": lambda: CouplingFriction(joints=BOTH, ratios=(1.0, 1.0), smoothing=-1.0),
    "negative reversal of motors": lambda: CouplingFriction(joints=BOTH, ratios=(1.0, 1.0), reversal_speed=-1.0),
    "name of two words": lambda: CouplingFriction(joints=BOTH, ratios=(1.0, 1.0), name="hip motor"),
    "the same twice": lambda: TorqueModel(LEG, (spring(), spring())),
    "load of several joints": lambda: TorqueModel(LEG, (Loaded(joints=BOTH, ratios=(1.0, 1.0)),)),
    "regrouped of other terms": lambda: replace(TorqueModel(LEG, (Armature(),)), terms=(Viscous(),)),
    "no name in files": lambda: TERMS.to_json(Magnet()),
    "unknown name": lambda: TERMS.default("magnet"),
    "no name": lambda: TERMS.from_json({}),
    "name of another type": lambda: TERMS.from_json({"term": ["coulomb"]}),
    "setting of another term": lambda: TERMS.from_json({"term": "viscous", "smoothing": 0.1}),
    "setting of text": lambda: TERMS.from_json({"term": "coulomb", "smoothing": "slow"}),
    "half an open setting": lambda: TERMS.from_json({"term": "stribeck", "velocity": {"start": 1.0}}),
}


@pytest.mark.parametrize("call", SETTINGS.values(), ids=SETTINGS)
def test_a_term_or_model_that_makes_no_sense_is_refused(call):
    refused(BadArgumentError, call)


def test_arrays_of_another_leg_are_refused():
    with pytest.raises(ExoidError, match="do not fit a leg of 2 joints"):
        TorqueModel(LEG, (Coulomb(),)).regressor(*np.zeros((3, 5, 3)))
