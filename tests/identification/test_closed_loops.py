"""Closed legs through the whole way: identify, check, save, export, command line, controllers, scenes."""

import numpy as np
import pytest
import study_loops
from closed_machines import four_bar_knee, two_rod_ankle
from made_estimates import from_file
from swings import harmonics

import exoid
from exoid.control import ControlModel
from exoid.identification.findings.checkup import signal_findings
from exoid.identification.findings.timing import loop_gaps
from exoid.leg.description import read_description
from exoid.torques import TorqueModel

SOME = 0.02  # friction of the motors [N·m·s/rad]


def swing(leg: exoid.Leg, seed: int, noise: float = 0.0, joints: tuple[str, ...] = ()) -> exoid.Recording:
    """Log of a random motion by inverse dynamics; dependent joints of these names are measured, too."""
    rng = np.random.default_rng(seed)
    t, n = np.arange(3000) / 200.0, len(leg.joint_names)
    f, phase = rng.uniform(0.2, 1.5, (5, n)), rng.uniform(0, 2 * np.pi, (5, n))
    q, v, a = harmonics(t, 0.08, 2 * np.pi * f.T, phase.T)
    tau = leg.inverse_dynamics(q, v, a) + SOME * v
    tau += noise * np.std(tau, axis=0) * rng.standard_normal(tau.shape)
    names = leg.tree_joint_names if joints else leg.joint_names
    every, torque = leg.tree_motion(q).q if joints else q, np.full((len(t), len(names)), np.nan)
    torque[:, [names.index(name) for name in leg.joint_names]] = tau
    log = exoid.Recording(time=t, q=every, tau=torque, joint_names=names)
    return log.select([name for name in names if name in (*leg.joint_names, *joints)]) if joints else log


@pytest.fixture(params=[four_bar_knee, two_rod_ankle], ids=["knee", "ankle"], scope="module")
def leg(request, tmp_path_factory) -> exoid.Leg:
    return request.param(0).leg(tmp_path_factory.mktemp("leg"))


@pytest.mark.slow
def test_an_exact_log_gives_the_torque_of_another_motion(leg):
    estimate = exoid.identify(leg, [swing(leg, 0, 1e-3), swing(leg, 1, 1e-3)], [exoid.Viscous()])
    test = swing(leg, 2)
    assert (exoid.validate(estimate, test).nrmse < 2e-3).all()
    assert estimate.names[-2:] == tuple(f"d_{label}" for label in leg.joint_labels)
    off = np.abs(estimate.values - [*leg.parameters, SOME, SOME]) / estimate.std
    assert off.max() < 5.0


@pytest.mark.slow
def test_an_estimate_and_an_export_keep_the_loops(leg, tmp_path):
    estimate = exoid.identify(leg, swing(leg, 0, 1e-3), [exoid.Viscous()])
    again = from_file(estimate, tmp_path)
    q, v, a = np.random.default_rng(0).uniform(-0.2, 0.2, (3, 5, 2))
    np.testing.assert_array_equal(again.torque(q, v, a), estimate.torque(q, v, a))
    estimate.to_urdf(tmp_path / "identified.urdf")
    description = read_description(tmp_path / "identified.urdf")
    exported = exoid.Leg.from_description(description, leg.joint_names, loops=leg.closure.loops)
    found = exported.inverse_dynamics(q, v, a)
    np.testing.assert_allclose(
        found, estimate.leg.inverse_dynamics(q, v, a), rtol=1e-3, atol=1e-3 * np.abs(found).max()
    )


@pytest.mark.nightly
def test_most_intervals_of_a_machine_hold_or_miss_together_by_chance_and_not_by_a_bias(tmp_path):
    found = study_loops.again("four-bar knee", 900, tmp_path, 12, motions=2)
    assert found["axis"].min() > 6.0  # of 13
    assert found["exact"].max() < 0.5
    assert 0.5 < np.sqrt(np.mean(found["along"] ** 2)) < 1.5


def test_controllers_take_the_driven_joints_only(leg):
    model = ControlModel.of(leg)
    q, v, a = np.random.default_rng(0).uniform(-0.2, 0.2, (3, 2))
    torque = model.inverse_dynamics(q, v, a)
    np.testing.assert_allclose(torque, leg.inverse_dynamics(q, v, a)[0])
    np.testing.assert_allclose(model.inverse_dynamics(*np.tile([q, v, a], (1, 1))[..., None])[:, 0], torque)
    np.testing.assert_allclose(model.gravity(q), leg.gravity(q)[0])


def test_a_loop_described_wrongly_is_named_with_its_size(tmp_path):
    machine = four_bar_knee(0)
    leg = machine.leg(tmp_path)
    log = swing(leg, 0, 1e-3, ("front_pin", "rear_pin"))
    assert not list(loop_gaps(leg.closure, log))
    x, _, z = leg.closure.loops.loops[0].second.xyz
    for millimetres in (0.8, 1.3, 5.0):
        shifted = machine.loops.replace(f"{x:.5f}, 0.00000, {z:.5f}", f"{x + 1e-3 * millimetres}, 0, {z}")
        assert shifted != machine.loops
        wrong = machine.leg(tmp_path, shifted)
        found = list(loop_gaps(wrong.closure, log))
        assert bool(found) is (millimetres > 1.0)
    assert found[0].value == pytest.approx(5e-3, rel=0.02)
    assert "four-bar" in found[0].message
    (finding,) = loop_gaps(wrong.closure, log.select(["hip", "knee", "rear_pin"]))
    assert finding.value > 2e-3
    described = signal_findings(TorqueModel(wrong, ()), [log])
    assert "loop-gap" in [finding.kind for finding in described]


def test_a_torque_at_a_passive_joint_is_refused(tmp_path):
    leg = four_bar_knee(0).leg(tmp_path)
    log = swing(leg, 0, 1e-3, ("rear_pin",))
    tau = np.array(log.tau)
    tau[:, log.joint_names.index("rear_pin")] = 0.3
    driven = exoid.Recording(time=log.time, q=log.q, tau=tau, joint_names=log.joint_names)
    with pytest.raises(exoid.ExoidError, match="joint rear_pin follows from a closed loop"):
        exoid.identify(leg, driven)


@pytest.mark.slow
def test_the_command_line_takes_loops(exoid_, tmp_path):
    leg = four_bar_knee(0).leg(tmp_path)
    for seed in (0, 1):
        swing(leg, seed, 1e-3, ("rear_pin",)).to_csv(tmp_path / f"{seed}.csv")
    options = ("leg.urdf", "0.csv", "--loops", "loops.toml")
    assert exoid_("identify", *options, "-o", "est.json", "--terms", "viscous").printed
    assert exoid_("validate", "est.json", "1.csv", "--json").data
    assert exoid_("check", *options, "--json").data is not None
    assert "leg.urdf" in exoid_("identify", "leg.urdf", "0.csv", "--loops", "leg.urdf").refusal
