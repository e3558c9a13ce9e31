"""A term from outside exoid says how it looks in C, and computes there what it computes in Python."""

from dataclasses import dataclass

import numpy as np
import pytest
from compiled import CompiledLeg, needs_compiler
from planar_chains import assert_relative, random_motion

import exoid
from exoid import Armature, Coulomb, Offset, Stiffness
from exoid.codegen import JointInC, c_source, register_c_form
from exoid.errors import BadArgumentError, NotSupportedError
from exoid.torques import CouplingFriction, CouplingSpring, Stribeck, Term, TorqueModel

LEG = exoid.load_leg("bleex", inertias="identified")


@dataclass(frozen=True, kw_only=True)
class Drag(Term):
    """Drag of a fluid, τ = kp v² forwards and −kn v² backwards, from a speed on."""

    threshold: float = 0.5

    symbols = "kp", "kn"
    units = ("N·m·s²/rad²",) * 2

    def fill(self, motion, out):
        drag = np.abs(motion.v) * motion.v * (np.abs(motion.v) > self.threshold)
        out[0], out[1] = np.maximum(drag, 0.0), np.minimum(drag, 0.0)


@register_c_form(Drag, "friction")
def drag_in_c(term: Drag, joint: JointInC) -> str:
    v, zero = joint.variable, joint.number(0.0)
    size = f"({v} > {zero} ? {joint.parameter('kp')} : {joint.parameter('kn')})"
    moving = f"{joint.function('fabs')}({v}) > {joint.number(term.threshold)}"
    return f"{moving} ? {size} * {joint.function('fabs')}({v}) * {v} : {zero}"


@dataclass(frozen=True, kw_only=True)
class Counterweight(Term):
    """τ = m sin q + o: a weight on the joint that is not in the URDF, and an offset of its own."""

    symbols = "m", "o"
    units = ("N·m",) * 2

    def fill(self, motion, out):
        out[0], out[1] = np.sin(motion.q), 1.0


@register_c_form(Counterweight, "stiffness")
def counterweight_in_c(term: Counterweight, joint: JointInC) -> str:
    return f"{joint.parameter('m')} * {joint.function('sin')}({joint.variable}) + {joint.parameter('o')}"


@dataclass(frozen=True, kw_only=True)
class GearedRotor(Term):
    """τ = ratio² Im a: the rotor of a motor of which the gear is known."""

    ratio: float = 10.0

    symbols = ("Im",)
    units = ("kg·m²",)

    def fill(self, motion, out):
        out[0] = self.ratio**2 * motion.a


@register_c_form(GearedRotor, "rotor")
def geared_rotor_in_c(term: GearedRotor, joint: JointInC) -> str:
    return f"{joint.number(term.ratio**2)} * {joint.parameter('Im')}"


def made_up(*terms, seed=0):
    """A model of the leg with these terms, and values for all parameters."""
    model = TorqueModel(LEG, terms)
    others = np.random.default_rng(seed).uniform(0.1, 2.0, len(model.names) - len(LEG.parameters))
    return model, np.concatenate([LEG.parameters, others])


OWN = {
    "friction": (Drag(),),
    "friction at one joint beside exoid's own": (Coulomb(), Drag(joints=("knee",), threshold=0.0)),
    "stiffness": (Counterweight(),),
    "stiffness with a parameter that is part of another": (Offset(), Counterweight()),
    "rotor": (GearedRotor(),),
    "two inertias at different joints": (GearedRotor(joints=("knee",)), Armature(joints=("ankle",))),
    "couplings": (
        CouplingSpring(joints=("knee", "hip"), ratios=(1.0, -0.6)),
        CouplingFriction(joints=("hip", "knee", "ankle"), ratios=(1.0, 1.0, -0.3)),
        Coulomb(),
        Drag(),
    ),
    "sharp friction across joints": (CouplingFriction(joints=("hip", "knee"), ratios=(1.0, 1.0), smoothing=0.0),),
    "all": (Stiffness(degree=1), Drag(), Counterweight(), GearedRotor(), Stribeck()),
}


@pytest.mark.slow
@needs_compiler
@pytest.mark.parametrize(
    ("name", "precision", "tolerance"), [*((name, "double", 1e-12) for name in OWN), ("all", "float", 3e-6)]
)
def test_a_term_from_outside_computes_the_same_in_c(name, precision, tolerance, tmp_path):
    model, values = made_up(*OWN[name])
    c = CompiledLeg(c_source(model, values, precision=precision), tmp_path)
    q, v, a = np.float64(np.float32(random_motion(np.random.default_rng(1), c.n, turns=0.25)))
    rigid = TorqueModel(LEG, ()).regressor(q, v, a) @ LEG.parameters
    whole = model.regressor(q, v, a) @ values
    assert np.abs(whole - rigid).max() > 0.01 * np.abs(whole).max()  # the terms can be seen
    assert_relative(c("inverse_dynamics", q, v, a), whole, tolerance)


@dataclass(frozen=True, kw_only=True)
class ThickDrag(Drag):
    """Computes something else than its parent."""

    def fill(self, motion, out):
        super().fill(motion, out)
        out *= np.abs(motion.v)


def test_a_subclass_does_not_inherit_the_form_and_may_register_its_own(monkeypatch):
    model, values = made_up(ThickDrag())
    with pytest.raises(NotSupportedError, match=r"ThickDrag \(kp, kn\) has no form in C.*register_c_form"):
        c_source(model, values)
    monkeypatch.setattr("exoid.codegen.forms.FORMS", {})
    register_c_form(ThickDrag, "friction")(lambda term, joint: f"{joint.parameter('kp')} * {joint.variable}")
    assert "tau[1] = leg_term[2] * v[1];" in c_source(model, values).text


@pytest.mark.parametrize("setting", [np.inf, np.nan])
def test_a_setting_that_c_cannot_write_is_refused(setting):
    with pytest.raises(BadArgumentError, match="C has no number"):
        c_source(*made_up(Drag(threshold=setting)))
