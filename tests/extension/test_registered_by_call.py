"""What a script registers works like what exoid brings along; what no file can hold is refused unwritten."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from made_estimates import made
from springs import STIFFNESS

import exoid
from exoid import Coulomb, Viscous
from exoid.codegen.forms import FORMS
from exoid.errors import BadArgumentError
from exoid.identification.estimators import JointML, wls
from exoid.signals import ZeroPhase
from exoid.torques import Term, TorqueModel, register_term

LEG = exoid.load_leg("cuhk")
FRICTION = (Coulomb(), Viscous())


@dataclass(frozen=True, kw_only=True)
class Thick(Term):
    """Damping τ = d |v| v, whose parameter has the symbol of viscous friction; it takes any setting."""

    setting: Any = None

    @property
    def symbols(self):
        return ("d",)

    @property
    def units(self):
        return ("N·m·s²/rad²",)

    def fill(self, motion, out):
        out[0] = np.abs(motion.v) * motion.v


def estimate_of(*terms, **changes):
    """An estimate of the leg's own parameters with these terms."""
    model = TorqueModel(LEG, terms)
    others = np.random.default_rng(0).uniform(0.1, 0.9, len(model.names) - len(LEG.parameters))
    values = np.concatenate([LEG.parameters, others])
    return replace(made(model, values, np.diag((0.01 * np.maximum(np.abs(values), 0.1)) ** 2)), **changes)


@pytest.mark.parametrize("setting", [None, np.zeros(3), [0.1], np.inf, {"a": 1}, print], ids=ascii)
def test_a_term_that_no_file_can_hold_is_refused_before_anything_is_written(setting, forgetful, tmp_path):
    """Its setting, or its class, which has no name."""
    if setting is not None:
        register_term("thick", Thick)
    estimate = estimate_of(Coulomb(), Thick(setting=setting))
    with pytest.raises(BadArgumentError):
        estimate.save(tmp_path / "est.json")
    assert not list(tmp_path.iterdir())


def test_damping_of_a_urdf_is_viscous_friction_alone(forgetful, tmp_path):
    """A term from outside may use a symbol of exoid's: it stays what it is everywhere."""
    register_term("thick", Thick)
    estimate = estimate_of(Coulomb(), Viscous(joints=("hip",)), Thick(joints=("knee",)))
    export = estimate.to_urdf(tmp_path / "leg.urdf")
    assert export.left_out == ("d_knee",)
    urdf = export.urdf.read_text(encoding="utf-8")
    assert f'damping="{estimate.value("d_hip")!r}"' in urdf
    assert f'damping="{estimate.value("d_knee")!r}"' not in urdf


def test_an_estimator_that_asks_for_rows_only_works_with_groups(springs, recording):
    halves = {"first": recording.slice(0, 1000), "second": recording.slice(1000)}
    terms = (*FRICTION, springs.EndStop())
    both = exoid.identify(LEG, halves, terms, springs.mad, own="c0")
    assert both["first"].estimator == "mad"
    assert both["second"].value("k_knee") == pytest.approx(STIFFNESS["knee"], rel=0.02)
    assert both["first"].value("c0_knee") != both["second"].value("c0_knee")


NO_ESTIMATORS = [3, JointML, lambda _: None, lambda p: wls(p).solution, lambda p: wls(p)._replace(weights=[1.0])]
"""They cannot be called with a problem, or do not return a fit with a weight for each R factor."""


@pytest.mark.parametrize("wrong", NO_ESTIMATORS)
def test_what_is_no_estimator_is_refused(wrong, recording):
    with pytest.raises(BadArgumentError):
        exoid.identify(LEG, recording, FRICTION, wrong)


@pytest.mark.parametrize(("name", "kind"), [*(("thick", x) for x in (Thick(), ZeroPhase, print)), ("viscous", Thick)])
def test_what_cannot_be_registered_is_refused(name, kind):
    with pytest.raises(BadArgumentError):
        register_term(name, kind)


def test_the_form_in_c_comes_with_the_package(springs):
    assert springs.EndStop in FORMS
