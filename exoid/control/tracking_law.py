"""Controllers that follow a reference: PD feedback, and what the model adds to it by a table, in Python and in C."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.codegen import MOTION, REFERENCE, ArrayInC, Dialect, InputInC, LawInC
from exoid.codegen.law_in_c import Needed
from exoid.errors import BadArgumentError
from exoid.leg.joint_numbers import for_joints
from exoid.rig import Target

from .c_description import describe
from .friction import FrictionCompensation
from .law import RATE, State, acceleration, refuse_rate, sound, spread, unsound
from .model import ControlModel


class Feedforward(NamedTuple):
    """Use of the model in a tracking law: its torque in Python, and the equation and the statements of it in C."""

    name: str  # name of the law in tables
    torque: Callable[[TrackingLaw, State, Target], FloatArray]  # without friction
    equation: str
    step: str  # {{feedback}} is Kp (q_d - q) + Kd (v_d - v) of joint j, {{friction}} what compensates friction
    calls: tuple[Needed, ...] = ("inverse_dynamics",)
    inputs: tuple[InputInC, ...] = MOTION
    # comment of the table of each gain in C
    gains: Mapping[str, str] = MappingProxyType({"kp": "Kp [N m/rad]", "kd": "Kd [N m s/rad]"})
    # damping of the safe torque from kd; None for the default gain of controllers
    damping: Callable[[TrackingLaw, FloatArray], FloatArray | None] = lambda law, kd: kd


INVERSE_DYNAMICS = """\
    {{real}} friction[{{N}}];
    {{p}}_inverse_dynamics(in->q_d, in->v_d, in->a_d, tau);
{{friction}}
    for (j = 0; j < {{N}}; ++j) {
        tau[j] += {{feedback}} + friction[j];
    }
"""

FEEDFORWARDS = {
    "none": Feedforward(
        "PD",  # doc. 2, eq. (24)
        lambda law, s, t: law.feedback(s, t),
        "tau = Kp (q_d - q) + Kd (v_d - v)",
        "    for (j = 0; j < {{N}}; ++j) {\n        tau[j] = {{feedback}};\n    }\n",
        (),
        REFERENCE,
    ),
    "gravity": Feedforward(
        "GravityFrictionPD",  # doc. 2, eq. (25); springs and offsets depend on the angle as gravity does
        lambda law, s, t: law.feedback(s, t) + law.known.statics(s.q),
        "tau = Kp (q_d - q) + Kd (v_d - v) + G(q) + springs(q){friction}",
        """\
    {{real}} gravity[{{N}}], springs[{{N}}], friction[{{N}}];
    {{p}}_gravity(in->q, gravity);
    {{p}}_springs(in->q, springs);
{{friction}}
    for (j = 0; j < {{N}}; ++j) {
        tau[j] = {{feedback}};
        tau[j] += gravity[j] + springs[j] + friction[j];
    }
""",
        ("gravity", "springs"),
        REFERENCE,
    ),
    "reference": Feedforward(
        "FeedforwardPD",  # depends on the reference alone: noise and delay of the sensors do not affect it
        lambda law, s, t: law.feedback(s, t) + law.known.inverse_dynamics(t.q, t.v, acceleration(t)),
        "tau = Kp (q_d - q) + Kd (v_d - v) + M(q_d) a_d + C(q_d, v_d) v_d + G(q_d) + springs(q_d){friction}",
        INVERSE_DYNAMICS,
    ),
    "linearising": Feedforward(
        "ComputedTorque",  # with an exact model and in continuous time ë + kd ė + kp e = 0, joint by joint
        lambda law, s, t: law.known.inverse_dynamics(s.q, s.v, acceleration(t) + law.feedback(s, t)),
        "tau = M(q) (a_d + kd (v_d - v) + kp (q_d - q)) + C(q, v) v + G(q) + springs(q){friction}",
        """\
    {{real}} a[{{N}}], friction[{{N}}];
    for (j = 0; j < {{N}}; ++j) {
        a[j] = in->a_d[j] + {{p}}_kd[j] * (in->v_d[j] - in->v[j]) + {{p}}_kp[j] * (in->q_d[j] - in->q[j]);
    }
    {{p}}_inverse_dynamics(in->q, in->v, a, tau);
{{friction}}
    for (j = 0; j < {{N}}; ++j) {
        tau[j] += friction[j];
    }
""",
        gains={"kp": "kp [1/s^2]", "kd": "kd [1/s]"},
        damping=lambda law, kd: kd * np.diagonal(law.known.mass_matrix(np.zeros(law.known.n))),
    ),
    "measured": Feedforward(
        "Impedance",  # Hogan 1985: the wearer feels −(M ë + D ė + K e), at rest a spring, whatever the weight
        lambda law, s, t: (
            law.feedback(s, t)  # a target without acceleration has a constant velocity
            + law.known.inverse_dynamics(s.q, s.v, np.broadcast_to(0.0 if t.a is None else t.a, s.q.shape))
        ),
        "tau = K (q_d - q) + D (v_d - v) + M(q) a_d + C(q, v) v + G(q) + springs(q){friction}",
        INVERSE_DYNAMICS.replace("in->q_d, in->v_d", "in->q, in->v"),
        gains={"kp": "K [N m/rad]", "kd": "D [N m s/rad]"},
        damping=lambda law, kd: None,
    ),
    "optimal": Feedforward(
        "LQR",  # errors of all joints act on each
        lambda law, s, t: (
            law.known.inverse_dynamics(t.q, t.v, acceleration(t)) + law.kp @ (t.q - s.q) + law.kd @ (t.v - s.v)
        ),
        "tau = M(q_d) a_d + C(q_d, v_d) v_d + G(q_d) + springs(q_d){friction} + K (x_d - x), x = (q, v)",
        """\
    {{real}} friction[{{N}}];
    int k;
    {{p}}_inverse_dynamics(in->q_d, in->v_d, in->a_d, tau);
{{friction}}
    for (j = 0; j < {{N}}; ++j) {
        tau[j] += friction[j];
        for (k = 0; k < {{N}}; ++k) {
            tau[j] += {{p}}_gain[j][k] * (in->q_d[k] - in->q[k]);
            tau[j] += {{p}}_gain[j][{{N}} + k] * (in->v_d[k] - in->v[k]);
        }
    }
""",
        gains={"gain": "K [N m/rad, N m s/rad]"},
        damping=lambda law, kd: None,
    ),
    "share": Feedforward(
        "GravitySupport",  # the wearer decides on the motion, and feels the inertia and the rest of weight and friction
        lambda law, s, t: spread(law.kp, s.q) * law.known.statics(s.q),
        "tau = share (G(q) + springs(q)){friction}",
        """\
    {{real}} springs[{{N}}], friction[{{N}}];
    {{p}}_gravity(in->q, tau);
    {{p}}_springs(in->q, springs);
{{friction}}
    for (j = 0; j < {{N}}; ++j) {
        tau[j] = {{p}}_share[j] * (tau[j] + springs[j]) + friction[j];
    }
""",
        ("gravity", "springs"),
        (),
        {"share": "share of the weight"},
        lambda law, kd: None,
    ),
}
"""Ways in which a tracking law uses the model."""


@dataclass(frozen=True, eq=False)
class TrackingLaw:
    """τ = feedforward(u) + τ_f with u = kp (θ_d − θ) + kd (θ̇_d − θ̇), of one leg or of B legs."""

    feedforward: str  # use of the model, one of FEEDFORWARDS
    kp: FloatArray  # gain Kp [N·m/rad], [1/s²] if linearising, the share of the weight; a number, (n,) or (n, B)
    kd: FloatArray  # gain Kd [N·m·s/rad], [1/s] if linearising, likewise; both (n, n) if optimal
    model: ControlModel | None = None  # model of the leg; None without feedforward
    friction: FrictionCompensation | None = None  # friction compensation; None for none
    rate: float = RATE  # sampling rate [Hz]

    def __post_init__(self) -> None:
        """Check the rate."""
        refuse_rate(self.rate)

    @property
    def name(self) -> str:
        """Name in tables."""
        return FEEDFORWARDS[self.feedforward].name

    @property
    def known(self) -> ControlModel:
        """Model of the leg."""
        assert self.model is not None
        return self.model

    def feedback(self, state: State, target: Target) -> FloatArray:
        """Compute kp (θ_d − θ) + kd (θ̇_d − θ̇)."""
        q, v = state.q, state.v
        u = spread(self.kp, q) * (target.q - q) + spread(self.kd, v) * (target.v - v)
        return u if self.model is None else self.model.driven(u)

    def torque(self, state: State, target: Target) -> FloatArray:
        """Compute the torque; see the class."""
        kind = FEEDFORWARDS[self.feedforward]
        try:
            torque = kind.torque(self, state, target)
            if self.friction is not None:
                torque = torque + self.friction.torque(self.known, state, target)
            torque = torque if self.model is None else self.model.driven(torque)
            return sound(torque, state, target if kind.inputs else None)
        except (AttributeError, TypeError, ValueError) as error:  # of numpy: lists, other sizes, no target
            raise unsound(state, target) from error

    def in_c(self, dialect: Dialect) -> LawInC:
        """Describe the law in C."""
        kind = FEEDFORWARDS[self.feedforward]
        sizes = [gain.size for gain in (self.kp, self.kd) if gain.ndim == 1]
        if self.model is None and not sizes:
            raise BadArgumentError("PD control of an unknown number of joints", remedy="give one gain for each joint")
        n = sizes[0] if self.model is None else self.model.n
        full = self.feedforward == "optimal"  # (n, n) each, and one table in C
        kp, kd = (gain if full else for_joints(gain, n, name) for gain, name in ((self.kp, "kp"), (self.kd, "kd")))
        kp, kd = (gain if self.model is None else self.model.driven(gain) for gain in (kp, kd))
        numbers = [np.hstack([kp, kd])] if full else [kp, kd]
        tables = {name: (gain, what) for (name, what), gain in zip(kind.gains.items(), numbers, strict=False)}
        feedback = "{{p}}_kp[j] * (in->q_d[j] - in->q[j]) + {{p}}_kd[j] * (in->v_d[j] - in->v[j])"
        step = kind.step.replace("{{feedback}}", feedback)
        if self.model is None:
            arrays = tuple(ArrayInC(name, what, gain) for name, (gain, what) in tables.items())
            joints = tuple(f"joint {k}" for k in range(n))
            return LawInC(joints, kind.equation, step, self.rate, kd, kind.inputs, arrays)
        return describe(
            self.model,
            self.friction,
            self.rate,
            dialect,
            equation=kind.equation,
            step=step,
            calls=kind.calls,
            inputs=kind.inputs,
            tables=tables,
            damping=kind.damping(self, kd),
        )
