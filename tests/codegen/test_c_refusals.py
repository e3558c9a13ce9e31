"""What has no form in C is refused by kind, before anything is written."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from compiled import made_up, source_of
from laws_of_bleex import KD, KP, model

import exoid
from exoid import Coulomb
from exoid.actuators import Actuators, Coupling, LinearActuator, MomentArmTable, Motor, motor_terms
from exoid.codegen import Dialect, InputInC, LawInC, Safety, c_source, register_c_form, write_ros2
from exoid.control import Limited, MomentumObserver, impedance, pd
from exoid.errors import BadArgumentError, ExoidError, NotSupportedError
from exoid.torques import LoadFriction, TorqueModel

CUHK = exoid.load_leg("cuhk")
ESTIMATE, FLOATING = made_up(CUHK), exoid.load_exo("cuhk", base="floating")


@dataclass(frozen=True, kw_only=True)
class Sticky(Coulomb):
    """A user's own friction, which the C of its parent would get wrong."""


class Described:
    """A law with a form in C."""

    rate = 100.0

    def torque(self, state, target):
        return 0.0 * state.q

    def in_c(self, dialect: Dialect) -> LawInC:
        return LawInC(("hip",), "tau = 0", "    tau[0] = {{number(0)}};\n", self.rate, np.zeros(1))


class Pushed(Described):
    """A law that needs the torque of the wearer."""

    def in_c(self, dialect: Dialect) -> LawInC:
        return replace(super().in_c(dialect), inputs=(InputInC("interaction", "torque [N m]", "reading"),))


class Overridden(Described):
    """Computes something else than its parent."""

    def torque(self, state, target):
        return 1.0 + 0.0 * state.q


def leg_of(term):
    return lambda: made_up(CUHK, (term,)).to_c("leg.c")


def commands_of(drive):
    return c_source(ESTIMATE.model, ESTIMATE.values, actuators=Actuators.of(CUHK, {"hip": drive}))


WRIST = Coupling(("hip", "knee"), ((0.05, 0.06), (0.07, -0.04)))
HUGE = replace(ESTIMATE, values=np.where(np.arange(len(ESTIMATE.values)) == 0, 1e39, ESTIMATE.values))
LATE = MomentumObserver(model(), 8.0, 100.0, torque_delay=0.004)

UNSUPPORTED = {
    "leg whose base floats": lambda: c_source(TorqueModel(FLOATING, ()), FLOATING.parameters),
    "friction that remembers": leg_of(Coulomb(presliding=1e-3)),
    "friction that depends on the load": leg_of(LoadFriction()),
    "term of another package": leg_of(Sticky()),
    "table of moment arms": lambda: commands_of(LinearActuator(MomentArmTable((-1.0, 0.0, 1.0, 2.0), (0.04,) * 4))),
    "rotors of coupled motors": lambda: source_of(made_up(CUHK, motor_terms(WRIST)[2:])),
    "law with such rotors": lambda: c_source(impedance(made_up(CUHK, motor_terms(WRIST)[2:]), 50.0, 5.0)),
    "law without a description": lambda: c_source(object()),
    "law that computes something else than its parent": lambda: c_source(Overridden()),
    "channels that lag": lambda: c_source(LATE),
    "observer for ROS 2": lambda: write_ros2("leg", MomentumObserver(model(), 8.0, 100.0, torque_delay=0.0)),
    "input that ROS 2 does not have": lambda: write_ros2("leg", Pushed()),
}

BAD = {
    "drive whose constant is not known": lambda: commands_of(Motor(None)),
    "precision": lambda: source_of(ESTIMATE, precision="half"),
    "number that no float can hold": lambda: source_of(HUGE, precision="float"),
    "too few values": lambda: c_source(TorqueModel(CUHK, ()), CUHK.parameters[:-1]),
    "values that are not finite": lambda: c_source(TorqueModel(CUHK, ()), np.full(len(CUHK.parameters), np.nan)),
    **{f"name {name!r}": lambda name=name: source_of(ESTIMATE, name) for name in ("", ".c", "___", "腿.c")},
    "place of a term": lambda: register_c_form(Sticky, "spring"),
    "gains of an unknown number of joints": lambda: c_source(pd(10.0, 1.0)),
    "limits of another number of joints": lambda: c_source(Limited(pd(KP, KD), (10.0, 10.0))),
    "gravity without a model": lambda: c_source(pd(KP, KD), safety=Safety("gravity")),
    "kind of safe torque": lambda: Safety("limp"),
    "patience": lambda: Safety(patience=np.nan),
    "rate for ROS 2": lambda: write_ros2("leg", pd((1.0, 2.0), (0.1, 0.2), rate=99.5)),
    "name of a joint for ROS 2": lambda: write_ros2("leg", pd((1.0, 2.0), (0.1, 0.2))),
}

CASES = [
    *(pytest.param(call, NotSupportedError, id=name) for name, call in UNSUPPORTED.items()),
    *(pytest.param(call, BadArgumentError, id=name) for name, call in BAD.items()),
]


@pytest.mark.parametrize(("call", "kind"), CASES)
def test_it_is_refused_and_nothing_is_written(call, kind, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(kind):
        call()
    assert not list(tmp_path.iterdir())


def test_a_refusal_leaves_an_existing_file_alone(tmp_path):
    (tmp_path / "leg.c").write_text("mine")
    with pytest.raises(ExoidError):
        ESTIMATE.to_c(tmp_path / "leg.c", precision="half")
    assert [path.name for path in tmp_path.iterdir()] == ["leg.c"]
    assert (tmp_path / "leg.c").read_text() == "mine"
    with pytest.raises(ExoidError, match=r"nowhere/leg.c: cannot be written"):
        ESTIMATE.to_c(tmp_path / "nowhere" / "leg.c")
