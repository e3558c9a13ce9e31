"""What a script registers works like what exoid brings along; what no file can hold is refused unwritten."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from made_estimates import made
from springs import STIFFNESS

import exoid
from exoid import Coulomb, ExoidError, Viscous
from exoid.codegen.forms import FORMS
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


class TestTerms:
    @pytest.mark.parametrize("setting", [np.zeros(3), [0.1], np.inf, {"a": 1}, print], ids=ascii)
    def test_a_setting_that_no_file_can_hold_is_refused_before_anything_is_written(self, setting, forgetful, tmp_path):
        register_term("thick", Thick)
        estimate = estimate_of(Coulomb(), Thick(setting=setting))
        with pytest.raises(ExoidError, match=r"Thick\(setting=.* cannot be written.*let settings be finite"):
            estimate.save(tmp_path / "est.json")
        assert not list(tmp_path.iterdir())

    def test_a_term_without_a_name_is_refused_before_anything_is_written(self, tmp_path):
        estimate = estimate_of(Thick())
        with pytest.raises(ExoidError, match=r'exoid\.torques\.register_term\("name", Thick\)'):
            estimate.save(tmp_path / "est.json")
        assert not list(tmp_path.iterdir())


class TestSymbolsOfExoid:
    """A term from outside may use a symbol of exoid's: it stays what it is everywhere."""

    def test_damping_of_a_urdf_is_viscous_friction_alone(self, forgetful, tmp_path):
        register_term("thick", Thick)
        estimate = estimate_of(Coulomb(), Viscous(joints=("hip",)), Thick(joints=("knee",)))
        export = estimate.to_urdf(tmp_path / "leg.urdf")
        assert export.left_out == ("d_knee",)
        urdf = export.urdf.read_text(encoding="utf-8")
        assert f'damping="{estimate.value("d_hip")!r}"' in urdf
        assert f'damping="{estimate.value("d_knee")!r}"' not in urdf


class TestEstimators:
    def test_one_that_asks_for_rows_only_works_with_groups(self, springs, recording):
        halves = {"first": recording.slice(0, 1000), "second": recording.slice(1000)}
        terms = (*FRICTION, springs.EndStop())
        both = exoid.identify(LEG, halves, terms, springs.mad, own="c0")
        assert both["first"].estimator == "mad"
        assert both["second"].value("k_knee") == pytest.approx(STIFFNESS["knee"], rel=0.02)
        assert both["first"].value("c0_knee") != both["second"].value("c0_knee")

    @pytest.mark.parametrize(
        ("estimator", "found"),
        [
            (lambda problem: None, "returned NoneType"),
            (lambda problem: wls(problem).solution, "returned Solution"),
            (lambda problem: wls(problem)._replace(weights=[1.0]), "returned 1 weights"),
        ],
    )
    def test_one_that_returns_no_fit_is_refused(self, estimator, found, recording):
        with pytest.raises(ExoidError, match=rf"<lambda> {found}.*one weight for each of the 2 R factors"):
            exoid.identify(LEG, recording, FRICTION, estimator)

    @pytest.mark.parametrize("wrong", [3, JointML])
    def test_what_cannot_be_called_with_a_problem_is_refused(self, wrong, recording):
        with pytest.raises(ExoidError, match="is no estimator"):
            exoid.identify(LEG, recording, FRICTION, wrong)


@pytest.mark.parametrize(
    ("word", "call"),
    [
        *(("is no type of term", lambda x=x: register_term("thick", x)) for x in (Thick(), ZeroPhase, print)),
        ("the term 'viscous' exists: exoid.torques.terms.Viscous", lambda: register_term("viscous", Thick)),
    ],
)
def test_what_cannot_be_registered_is_refused(word, call):
    with pytest.raises(ExoidError) as refused:
        call()
    assert word in str(refused.value)


def test_the_form_in_c_comes_with_the_package(springs):
    assert springs.EndStop in FORMS
