"""Settings and inputs that controllers refuse, with the kind of the error."""

from dataclasses import replace

import numpy as np
import pytest
from controlled_legs import LEG, cuhk_plant, exact_estimate

from exoid.codegen import Dialect
from exoid.control import (
    AHEAD,
    ControlModel,
    FrictionCompensation,
    Limited,
    State,
    compare_laws,
    computed_torque,
    default_gains,
    feedforward_pd,
    gravity_friction_pd,
    gravity_support,
    impedance,
    lqr,
    mean_pose,
    pd,
    replay_law,
    self_tuning,
    sensitivity_amplification,
    simulate_law,
    simulate_many,
    standard_laws,
    stateful,
)
from exoid.control.closed_loop import plant_step
from exoid.control.sensitivity_amplification import MotionFilter
from exoid.errors import BadArgumentError, ExoidError, NotIdentifiableError
from exoid.experiments import Harmonics, healthy_gait
from exoid.rig import Target
from exoid.signals import Recording

GAIT, PLANT = healthy_gait(period=2.0), cuhk_plant()
TWO_GAITS = Harmonics.concatenate([GAIT, GAIT])
REST, AIM = State(np.zeros(2), np.zeros(2)), Target(np.zeros(2), np.zeros(2))
MOVE = AIM._replace(a=np.zeros(2))
NAN, INF = np.nan, np.inf

REFUSED = {
    "gain": [
        (make, bad)
        for bad in (-1.0, NAN, (1.0, INF), (1.0, -2.0), np.ones((2, 2, 2)))
        for make in (
            lambda x: pd(x, 1.0),
            lambda x: pd(1.0, x),
            lambda x: gravity_friction_pd(LEG, x, 1.0),
            lambda x: feedforward_pd(LEG, x, 1.0),
            lambda x: computed_torque(LEG, x, 1.0),
        )
    ],
    "gains of another number of joints": [
        (lambda shape: pd((1.0, 2.0, 3.0), 0.1).torque(_state(shape), _aim(shape)), (2,)),
        (lambda shape: gravity_friction_pd(LEG, (1.0, 2.0, 3.0), 0.1).torque(_state(shape), _aim(shape)), (2, 4)),
    ],
    "rate": [
        (make, bad)
        for bad in (0.0, -1.0, INF, NAN)
        for make in (lambda x: pd(1.0, 1.0, rate=x), lambda x: gravity_friction_pd(LEG, 1.0, 1.0, rate=x))
    ],
    "friction": [
        *((lambda x: FrictionCompensation(**x), bad) for bad in ({"velocity": "own"}, {"width": -0.1}, {"scale": INF})),
        *((lambda make: make(LEG, 1.0, friction=AHEAD), make) for make in (gravity_support, sensitivity_amplification)),
        *(
            (lambda x: FrictionCompensation(drives=False, **x), bad)
            for bad in ({"scale": 1.2}, {"scale": -0.1}, {"scale": NAN}, {"width": 0.0}, {"velocity": "desired"})
        ),
    ],
    "share": [(lambda x: gravity_support(LEG, x), bad) for bad in (1.1, -0.1, NAN, (0.5, 2.0), np.ones((2, 2)))],
    "amplification": [
        (lambda x: sensitivity_amplification(LEG, x), bad) for bad in (0.5, INF, NAN, "5", (2.0, 0.9), np.ones((2, 2)))
    ],
    "limit": [
        (lambda x: Limited(pd(1.0, 1.0), **x), bad)
        for bad in ({"limit": 0.0}, {"slew": -1.0}, {"limit": NAN}, {"slew": np.ones((2, 2))})
    ],
    "bandwidth": [
        (lambda x: MotionFilter(*x), bad)
        for bad in ((0.0, 100.0), (-5.0, 100.0), (51.0, 100.0), (NAN, 100.0), ("5", 100.0), (5.0, 0.0))
    ],
    "target without acceleration": [
        *((lambda make: make(LEG, 1.0, 1.0).torque(REST, AIM), make) for make in (feedforward_pd, computed_torque)),
        (lambda make: _step(make(LEG, 1.0, 1.0), REST, AIM), self_tuning),
    ],
    "LQR": [
        (lambda x: lqr(**{"source": LEG, "pose": (0.1, 0.2), **x}), bad)
        for bad in ({"pose": (0.1, NAN)}, {"pose": (0.1, 0.2, 0.3)}, {"angle_deg": 0.0}, {"torque": INF}, {"rate": NAN})
    ] + [
        (lambda x: lqr(LEG, (0.1, 0.2), angle_deg=x), (1.0, 2.0, 3.0)),
        *((lambda x: default_gains(LEG, *x), bad) for bad in ((np.zeros(2), -10.0), (np.array([NAN, 0.0]),))),
    ],
    "mean pose": [(lambda x: mean_pose(*x), bad) for bad in ((GAIT, 0.0), (GAIT, NAN), (TWO_GAITS, 10.0))],
    "self-tuning": [
        (lambda x: self_tuning(**{"source": exact_estimate(), "kp": 20.0, "kd": 2.0, **x}), bad)
        for bad in ({"kp": -1.0}, {"rate": 0.0}, {"payload": -1.0}, {"friction": NAN}, {"payload": INF})
    ],
    "model": [(ControlModel.of, bad) for bad in (None, "est.json", cuhk_plant().repeat(2))],
    "law": [(stateful, {}), (Limited, "pd"), (lambda name: gravity_support(LEG, friction=name), "smooth")],
    "run": [
        (lambda x: simulate_law(PLANT.repeat(x), pd(1.0, 1.0), GAIT, 1.0), 2),
        (lambda x: simulate_many(PLANT.repeat(2), pd(1.0, 1.0), GAIT, 1.0, names=x), ("one",)),
        (lambda x: simulate_many(PLANT.repeat(2), x, GAIT, 1.0), (pd(1.0, 1.0, rate=30.0), pd(1.0, 1.0))),
        (lambda x: simulate_many(PLANT.repeat(2), x, GAIT, 1.0), (pd(1.0, 1.0),)),
        (lambda x: compare_laws(PLANT, x, GAIT, 1.0), {}),
        (lambda x: simulate_law(PLANT, pd(1.0, 1.0), GAIT, 1.0, settle=x), 1.0),
        *((lambda x: plant_step(*x), bad) for bad in ((0.0, 100.0), (100.0, NAN), (99.97, 100.0))),
    ],
    "sample": [
        (lambda bad, law=law: _step(stateful(law), *bad), bad)
        for law in (pd(1.0, 1.0), lqr(LEG, (0.1, 0.2)), computed_torque(LEG, 1.0, 1.0), self_tuning(LEG, 1.0, 1.0))
        for bad in ((REST._replace(q=np.array([NAN, 0.0])), MOVE), (REST, MOVE._replace(v=np.array([0.0, NAN]))))
    ] + [
        (lambda aim, law=law: _step(stateful(law), REST, aim), MOVE._replace(**{name: bad}))
        for law in (pd(1.0, 1.0), gravity_friction_pd(LEG, 1.0, 1.0), impedance(LEG, 1.0, 1.0))
        for name, bad in (("q", np.ones(1)), ("v", np.ones(1)), ("q", np.ones((2, 1))))
    ] + [
        (lambda state, law=law: _step(law, state, Target(state.q, state.v, state.v)), State(np.zeros(q), np.zeros(v)))
        for law in (sensitivity_amplification(LEG, 2.0), self_tuning(LEG, 1.0, 1.0))
        for q, v in ((3, 3), (2, 3), ((), ()), ((1, 2), (1, 2)), ((2, 1), 2))
    ] + [
        (lambda law: law.step(law.begin(REST), _state((2, 3)), _aim((2, 3))), law)
        for law in (sensitivity_amplification(LEG, 2.0), self_tuning(LEG, 1.0, 1.0))
    ] + [
        *(
            (lambda x: _step(sensitivity_amplification(LEG, 2.0), REST._replace(v=np.array([x, 0.0])), None), bad)
            for bad in (NAN, INF)
        ),
        *((lambda sample: pd(1.0, 1.0).torque(*sample), bad) for bad in ((REST, None), (State([0, 0], [0, 0]), AIM))),
        (lambda x: _step(Limited(pd(1.0, 1.0), 5.0), REST._replace(last=x), AIM), np.zeros(1)),
        (lambda gain: pd(gain, 1.0).torque(REST, AIM), np.eye(2)),
    ],
    "replay": [
        (lambda law: replay_law(law, logged()), sensitivity_amplification(LEG, 2.0)),  # 500 Hz, the log has 100
        (lambda law: replay_law(law, logged().select(LEG.joint_names[:1]), GAIT), pd((1.0, 1.0), (1.0, 1.0))),
    ],
}  # fmt: skip


def _step(law, state, target):
    return law.step(law.begin(state), state, target)


def _state(shape):
    return State(*np.zeros((2, *shape)))


def _aim(shape):
    return Target(*np.zeros((3, *shape)))


def logged(keep=slice(None)):
    time = np.arange(200) / 100.0
    q = np.sin(np.outer(time, [1.0, 2.0]))
    v = np.cos(np.outer(time, [1.0, 2.0])) * [1.0, 2.0]
    return Recording(time=time[keep], q=q[keep], v=v[keep], joint_names=LEG.joint_names)


def test_an_estimate_with_a_mass_matrix_of_no_links_gets_no_gains():
    wrong = replace(exact_estimate(), values=-exact_estimate().values)  # torques of the other sign
    laws = (lambda: lqr(wrong, (0.1, 0.2), friction=None), lambda: standard_laws(wrong, 1.0, 1.0, GAIT, 2.0))
    for make in (*laws, lambda: computed_torque(wrong, 1.0, 1.0, friction=None)):
        with pytest.raises(NotIdentifiableError, match="mass matrix"):
            make()
    assert (gravity_support(wrong).in_c(Dialect("double")).damping >= 0.0).all()


@pytest.mark.parametrize(("call", "bad"), [case for cases in REFUSED.values() for case in cases])
def test_bad_arguments_are_refused(call, bad):
    with pytest.raises(BadArgumentError):
        call(bad)


def test_a_number_that_is_not_finite_is_named_by_its_channel_and_place():
    wrong = np.array([0.0, NAN])
    for name in ("q", "last"):
        with pytest.raises(BadArgumentError, match=rf"^{name}\[1\] is not finite"):
            _step(Limited(pd(1.0, 1.0), 5.0), REST._replace(**{name: wrong}), AIM)


def test_motions_runs_and_logs_that_give_no_torque_are_refused_with_their_place():
    law, q = pd((1.0, 1.0), (1.0, 1.0)), logged().q.copy()
    q[20, 1] = NAN
    model = ControlModel.of(exact_estimate())
    broken = gravity_support(replace(model, spring=np.full_like(model.spring, NAN)))
    for place, call in (
        ("left_knee", lambda: simulate_law(PLANT, pd(1.0, 1.0), healthy_gait(scale=3.0), 10.0)),
        ("diverged", lambda: simulate_law(PLANT, pd(1e7, 1e7), GAIT, 1.0)),
        ("gap", lambda: replay_law(law, logged(np.r_[0:100, 150:200]), GAIT)),
        ("row 20", lambda: Recording(time=logged().time, q=q, joint_names=LEG.joint_names)),
        ("at 0 s", lambda: replay_law(broken, logged(), GAIT)),
    ):
        with pytest.raises(ExoidError, match=place):
            call()
