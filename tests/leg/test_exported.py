"""An exported leg comes back from its two files: as a leg, as a plant of the rig, and from the rig as the estimate."""

from __future__ import annotations

import json

import numpy as np
import pytest

import exoid
from exoid import Armature, Coulomb, Estimate, ExoidError, Offset, Stiffness, Viscous
from exoid.errors import BadArgumentError, UnreadableInputError
from exoid.experiments import Harmonics
from exoid.leg.catalog import urdf_folder
from exoid.leg.exported import read_exported, sidecar_of
from exoid.rig import IdealTorque, Plant, ProportionalDerivative, Rates, Sensors, simulate
from exoid.signals import Smoothed, ZeroPhase
from exoid.torques import TorqueModel

TERMS = (Coulomb(), Viscous(), Armature(), Offset())


def estimate_of(leg, terms=TERMS, **values):
    """An estimate with the leg's own rigid bodies and other terms at random, unless given."""
    model = TorqueModel(leg, terms)
    rng = np.random.default_rng(1)
    others = {name: rng.uniform(0.1, 0.4) for name in model.names[len(leg.parameters) :]}
    every = np.array([*leg.parameters, *(values.get(name, value) for name, value in others.items())])
    covariance = np.diag((0.01 * np.maximum(np.abs(every), 0.1)) ** 2)
    return Estimate(model, every, covariance, 10.0, 100.0, np.ones(len(leg.joint_names)), "ols", ZeroPhase(5.0))


@pytest.fixture(scope="module")
def leg():
    return exoid.load_leg("bleex", side="left", inertias="identified")


@pytest.fixture
def files(leg, tmp_path):
    """An estimate and its export."""
    estimate = estimate_of(leg)
    return estimate, estimate.to_urdf(tmp_path / "leg.urdf")


def test_everything_of_the_estimate_comes_back_from_the_files(files):
    estimate, export = files
    leg, resistances, offsets = read_exported(export.urdf)
    found = dict(zip(leg.parameter_names, leg.parameters, strict=True)) | resistances
    found |= {f"offset_{label}": x for label, x in zip(leg.joint_labels, offsets, strict=True)}
    assert found.keys() == set(estimate.names)
    np.testing.assert_allclose([found[name] for name in estimate.names], estimate.values, rtol=1e-12, atol=1e-14)


@pytest.mark.slow
def test_the_rig_simulates_it_and_identification_of_the_log_returns_the_estimate(files):
    """Estimate, URDF, plant, motion under a controller, log, estimate: the circle closes.

    The controller holds its command for a period, so that the torque in the log is half a period, 0.25 ms, old on
    average: what remains is its effect (twice as large at 1000 Hz).
    """
    estimate, export = files
    exported = read_exported(export.urdf)
    plant = Plant.from_urdf(export.urdf)
    rng = np.random.default_rng(4)
    motion = Harmonics(
        centre=np.array([[0.3], [-0.8], [0.0]]),
        amplitude=rng.uniform(0.05, 0.13, (4, 3, 1)),
        frequency=2.0 * np.pi * np.array([0.15, 0.35, 0.7, 1.1])[:, None, None] * np.ones((1, 3, 1)),
        phase=rng.uniform(0.0, 6.0, (4, 3, 1)),
    )
    run = simulate(
        plant,
        motion,
        ProportionalDerivative(np.array([400.0, 200.0, 60.0]), np.array([40.0, 15.0, 4.0])),
        IdealTorque(),
        duration=20.0,
        sensors=Sensors(encoder_counts=np.inf, torque_offset=exported.offsets),
        rates=Rates(control=2000.0, log=200.0),
    )
    terms = (Coulomb(smoothing=0.0, dead_band=0.05), *TERMS[1:])
    found = exoid.identify(exported.leg, run.recording(), terms, preparation=Smoothed(20.0))
    assert found.names == estimate.names
    off = np.abs(found.values - estimate.values) / found.parameter_scale
    assert off.max() < 6e-3
    rigid = slice(0, 9)
    assert np.median(off[rigid]) < 2e-3
    friction = [name.startswith("c0") for name in found.names]
    np.testing.assert_allclose(found.values[friction], estimate.values[friction], rtol=0.05)


def test_an_identified_example_runs_on_the_rig(data, estimate, tmp_path):
    plant = Plant.from_urdf(estimate.to_urdf(tmp_path / "leg.urdf").urdf, pitch=0.1)
    assert plant.leg.joint_names == data.leg.joint_names
    assert plant.pitch[0] == 0.1
    np.testing.assert_array_equal(plant.coulomb[:, 0], [estimate.value(f"c0_{j}") for j in ("hip", "knee", "ankle")])
    assert plant.armature[1, 0] == max(0.0, estimate.value("Ia_knee"))


def test_springs_come_back_and_friction_below_zero_is_none(leg, tmp_path):
    estimate = estimate_of(leg, (Coulomb(), Stiffness()), c0_knee=-0.1, b1_ankle=3.0)
    plant = Plant.from_urdf(estimate.to_urdf(tmp_path / "leg.urdf").urdf)
    assert plant.coulomb[1, 0] == 0.0
    assert plant.stiffness[1, 2, 0] == 3.0


def test_locked_joints_stay_locked(tmp_path):
    leg = exoid.Leg.from_urdf(urdf_folder() / "bleex.urdf", ("left_hip", "left_knee"), locked={"left_ankle": 0.2})
    estimate_of(leg).to_urdf(tmp_path / "leg.urdf")
    again = read_exported(tmp_path / "leg.urdf").leg
    assert again.joint_names == ("left_hip", "left_knee")
    assert again.locked == {"left_ankle": 0.2}
    np.testing.assert_allclose(again.parameters, leg.parameters, rtol=1e-12, atol=1e-14)


def test_without_a_sidecar_friction_is_what_the_urdf_says(files):
    estimate, export = files
    export.sidecar.unlink()
    leg, resistances, offsets = read_exported(export.urdf, estimate.model.leg.joint_names)
    expected = [f"{symbol}_{label}" for label in leg.joint_labels for symbol in ("c0", "d")]
    assert list(resistances) == expected
    np.testing.assert_allclose(list(resistances.values()), [estimate.value(name) for name in expected], rtol=1e-15)
    assert not offsets.any()
    plain = read_exported(urdf_folder() / "bleex.urdf", ("left_hip",))
    assert plain.resistances == {"c0_hip": 0.0, "d_hip": 0.0}


def edited(path, **changes):
    data = json.loads(path.read_text(encoding="utf-8"))
    path.write_text(json.dumps(data | changes), encoding="utf-8")


@pytest.mark.parametrize(
    ("spoil", "file"),
    [
        (lambda export: export.sidecar.write_text("{"), "sidecar"),
        (lambda export: export.sidecar.write_bytes(b"\xff\xfe"), "sidecar"),
        (lambda export: export.sidecar.write_text("[" * 100_000), "sidecar"),
        (lambda export: export.sidecar.write_text("[]"), "sidecar"),
        (lambda export: edited(export.sidecar, schema="exoid-sidecar-99"), "sidecar"),
        (lambda export: edited(export.sidecar, values={"d_hip": "1"}), "sidecar"),
        (lambda export: edited(export.sidecar, values={"d_hip": float("nan")}), "sidecar"),
        (lambda export: edited(export.sidecar, joints="left_hip"), "sidecar"),
        (lambda export: edited(export.sidecar, joints=["left_wing"]), ""),
        (lambda export: edited(export.sidecar, values={"wings": 1.0}), ""),
        (lambda export: edited(export.sidecar, not_dissipative=["wings"]), ""),
        (lambda export: export.urdf.write_text(export.urdf.read_text() + "\n<!-- mine -->"), "sidecar"),
    ],
)
def test_files_that_do_not_belong_together_or_are_damaged_are_refused(files, spoil, file):
    spoil(files[1])
    with pytest.raises(ExoidError) as caught:
        Plant.from_urdf(files[1].urdf)
    assert caught.value.file == (str(getattr(files[1], file)) if file else "")
    assert caught.value.remedy


def test_other_joints_than_those_of_the_sidecar_are_refused(files):
    with pytest.raises(BadArgumentError) as refused:
        read_exported(files[1].urdf, ("left_hip",))
    assert refused.value.file == str(files[1].sidecar)


@pytest.mark.parametrize("text", ["much", "-1", "nan", "inf", ""])
def test_friction_that_is_no_number_is_refused(files, text):
    export = files[1]
    export.sidecar.unlink()
    urdf = export.urdf.read_text(encoding="utf-8")
    value = repr(float(files[0].value("d_knee")))
    assert f'damping="{value}"' in urdf
    export.urdf.write_text(urdf.replace(f'damping="{value}"', f'damping="{text}"'), encoding="utf-8")
    with pytest.raises(UnreadableInputError, match="left_knee"):
        read_exported(export.urdf)


def test_the_sidecar_lies_beside_the_urdf(tmp_path):
    assert sidecar_of(tmp_path / "leg.urdf") == tmp_path / "leg.exoid.json"
