"""What no rig, sensor, wearer or machine can have is refused: by its kind of error, which names what is wrong."""

import re

import numpy as np
import pytest
from outcomes import refused
from planar_chains import random_chain
from rigs import BLEEX, POSE, Swing

import exoid
from exoid import Leg
from exoid.errors import BadArgumentError, ExoidError, NotSupportedError
from exoid.experiments import Hold, healthy_gait
from exoid.experiments.ground import bleex_machine
from exoid.leg.description import describe
from exoid.rig import (
    HydraulicServo,
    IdealTorque,
    Payload,
    Plant,
    ProportionalDerivative,
    Rates,
    Sensors,
    Stepper,
    Wearer,
    limb_of,
    plant_with_payloads,
    simulate,
)
from exoid.rig.ground import GroundMotion, GroundPlant, GroundSensors, JointGains, Sole, Spring, simulate_on_ground
from exoid.rig.ground.plant import BLEEX_SOLES

CUHK, GAIT = exoid.load_leg("cuhk"), healthy_gait(1.0, 1.2)
FREE, STIFF, TWO = Plant.build(CUHK, end_stops=False), Plant.build(BLEEX, end_stops=False), Plant.build(BLEEX).repeat(2)
MACHINE, LEGS = bleex_machine(), bleex_machine().leg
PD = ProportionalDerivative((200.0, 80.0), (20.0, 8.0))
HARD = Spring((0.0, 0.0, 0.3), (1e9, 0.0, 1e9), (0.0, 0.0, 0.0))


class Never:
    """Reference of a run that is refused before it begins."""

    def at(self, time):
        raise AssertionError


def run(plant=STIFF, duration=1.0, reference=None, law=None, actuator=None, **options):
    law, actuator = law or ProportionalDerivative(1.0), actuator or HydraulicServo(5e3, 0.01, 10.0)
    return simulate(plant, reference or Swing(), law, actuator, duration, **{"rates": Rates(step=1e-3), **options})


def worn(plant=FREE, wearer=None, **options):
    return run(plant, law=PD, actuator=IdealTorque(), reference=GAIT, wearer=wearer or Wearer.build(CUHK, **options))


def stand(begin=-1.0, **changes):
    time = np.linspace(begin, 1.0, 51)
    q = np.tile(np.array([0.45, -0.65, 0.45] * 2), (51, 1))
    motion = GroundMotion(time, q, 0.0 * q, np.tile([0.0, 0.912, -0.25], (51, 1)))
    return simulate_on_ground(**{"plant": MACHINE, "motion": motion, "gains": JointGains(2000.0, 60.0), **changes})


def spatial_leg():
    first, rest = BLEEX.description.text.split("<axis", 1)
    return Leg.from_description(describe(f"{first}<axis" + re.sub(r'xyz="[^"]*"', 'xyz="0.6 0 0.8"', rest, count=1)))


def other_chain():
    longer, other = (random_chain(np.random.default_rng(seed), 2).leg() for seed in (0, 1))
    return worn(Plant.build(longer, end_stops=False), Wearer(other))


def arm():
    return Leg.from_urdf(exoid.catalog.urdf_folder() / "dfki_double_pendulum.urdf", ("shoulder", "elbow"))


REFUSED = {
    BadArgumentError: [
        *(("limit", lambda limit=x: IdealTorque(limit)) for x in (0.0, np.nan)),
        ("stiffness", lambda: HydraulicServo(0.0)),
        ("leakage", lambda: run(reference=Hold(POSE), duration=20.0, actuator=HydraulicServo(5e3, 0.0, 40.0))),
        ("diverged", lambda: run(law=ProportionalDerivative(-1e6), actuator=IdealTorque())),
        ("2 rigs", lambda: Stepper(Plant.build(spatial_leg()).repeat(2), np.zeros((3, 2)), np.zeros((3, 2)), 1e-3)),
        ("encoder", lambda: Sensors(encoder_counts=0.0)),
        ("angle_noise", lambda: Sensors(angle_noise=-1e-3)),
        *(("delay", lambda x=x: Sensors(delay=x)) for x in (-1, 0.5)),
        ("rates", lambda: run(rates=Rates(control=1e4, step=1e-3), reference=Never())),
        *(
            ("rates", lambda x=x: run(rates=x, reference=Never()))
            for x in (Rates(0.0), Rates(np.inf), Rates(step=-1.0), Rates(step=np.nan))
        ),
        *(("duration", lambda x=x: run(duration=x)) for x in (0.0, -1.0, np.nan, np.inf)),
        *(("shape", lambda x=x: run(start=np.zeros(x))) for x in ((2, 1), (3, 4))),
        ("left_knee", lambda: run(Plant.build(BLEEX), start=(0.3, 0.5, 0.1))),
        ("command", lambda: run(law=ProportionalDerivative(np.ones((3, 4))))),
        ("c0_toe", lambda: Plant.build(BLEEX, {"c0_toe": 1.0})),
        *(("negative", lambda x=x: Plant.build(BLEEX, {x: -0.1})) for x in ("c0_hip", "Ia_hip")),
        ("kinetic", lambda: Plant.build(BLEEX, {"c0_hip": 1.0, "cs_hip": 0.5})),
        *(("positive definite", lambda x=x: Plant.build(BLEEX, x)) for x in ({"J3": -0.01}, {"J2": 0.01})),
        *(("pitch", lambda x=x: Plant.build(BLEEX, pitch=x)) for x in (np.nan, [[0.1, 0.2]], [])),
        *(("same leg", lambda x=x: Plant.concatenate(x)) for x in ([Plant.build(BLEEX), FREE], [])),
        *(("a wearer of", lambda x=x: Wearer.build(CUHK, *x)) for x in ((175.0,), (1.7, 7e4), (-1.7,), (1.7, np.nan))),
        ("cuff_stiffness", lambda: Wearer.build(CUHK, cuff_stiffness=-1.0)),
        *(("cuff_damping", lambda x=x: Wearer.build(CUHK, cuff_damping=x)) for x in ((1.0, -2.0), "soft")),
        ("each of 2", lambda: Wearer.build(CUHK, cuff_stiffness=(1.0, 2.0, 3.0))),
        ("intention", lambda: Wearer.build(CUHK, muscle_stiffness=10.0)),
        ("muscles", lambda: Wearer(CUHK, intention=GAIT, feedforward=False)),
        ("Plant", lambda: Wearer(FREE)),
        ("bleex", lambda: worn(FREE, Wearer.build(BLEEX))),
        ("limb", other_chain),
        ("cuff_stiffness", lambda: worn(cuff_stiffness=np.ones((2, 3)))),
        ("positive definite", lambda: worn(FREE, Wearer(CUHK.with_parameters(np.zeros(6))))),
        ("left_knee", lambda: worn(Plant.build(CUHK), intention=healthy_gait(3.0, 1.2))),
        ("40 rad", lambda: worn(intention=Hold(np.array([[40.0], [20.0]])), feedforward=False)),
        ("3, 1", lambda: worn(intention=Hold(np.zeros((3, 1))), feedforward=False)),
        ("zero", lambda: stand(begin=0.5)),
        ("stiffness", lambda: stand(gains=JointGains((1.0,) * 4, 1.0))),
        ("step", lambda: stand(rates=Rates(control=3000.0))),
        ("diverged", lambda: stand(spring=HARD)),
        ("sole", lambda: GroundPlant.build(LEGS, {})),
        ("c0_hip", lambda: GroundPlant.build(LEGS, BLEEX_SOLES, {"c0_hip": 1.0})),
        ("sole", lambda: Sole(np.zeros((1, 3)))),
        ("in m", lambda: Sole.flat(-75.0, 130.0, -115.0)),
        ("Spring", lambda: Spring((0.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 0.0, 0.0))),
        ("plate", lambda: GroundSensors(wrench_axes="plate")),
        ("mislabelled", lambda: GroundSensors(mislabelled=1.0)),
    ],
    NotSupportedError: [
        ("anthropometry", lambda: limb_of(arm())),
        ("floating base", lambda: GroundPlant.build(exoid.load_exo("bleex"), BLEEX_SOLES)),
    ],
    ExoidError: [  # what other rooms refuse
        ("finite", lambda: Plant.build(BLEEX, {"X1": np.inf})),
        *(("payload", lambda x=x: Payload("hip", *x)) for x in ((-1.0,), (np.nan,), (1.0, (0.0, np.inf, 0.0)))),
        *(("payload", lambda x=x: Payload("hip", 1.0, gyration=x)) for x in (-0.1, 500.0)),
        ("ankle", lambda: plant_with_payloads(Plant.build(CUHK), [Payload("ankle", 1.0)])),
        ("base", lambda: Wearer(exoid.load_leg("cuhk", base="floating"))),
        ("foot", lambda: GroundPlant.build(LEGS, {"foot": BLEEX_SOLES["left_foot"]})),
    ],
}


@pytest.mark.parametrize(("kind", "word", "call"), [(kind, *row) for kind, rows in REFUSED.items() for row in rows])
def test_it_is_refused_by_its_kind_and_named(kind, word, call):
    assert word in str(refused(kind, call))


def test_the_joint_beyond_its_end_stop_is_evidence():
    error = refused(BadArgumentError, lambda: run(Plant.build(BLEEX), start=np.array([[0.3], [0.5], [0.1]])))
    assert error.joints == ("left_knee",)
