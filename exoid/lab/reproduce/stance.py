"""Study beside both documents: what swing, stance with force plates and stance without them tell of BLEEX."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.errors import NotIdentifiableError
from exoid.estimate import Estimate, ground_forces
from exoid.estimate.finding import Finding
from exoid.estimate.ground_prediction import level_wrench
from exoid.identification import check, identify
from exoid.leg.catalog import load_exo, load_leg
from exoid.leg.leg import Leg
from exoid.leg.reduction.planar import GRAVITY
from exoid.rig.ground import GroundPlant
from exoid.signals import Recording, ZeroPhase
from exoid.torques import Armature, Coulomb, Viscous
from exoid.torques.contacts import split
from exoid.torques.contacts.imu import ImuErrors
from exoid.torques.contacts.stretches import EDGE

from .stance_logs import WRONG, StanceExtent, StanceRuns, run_stance

TERMS = (Coulomb(smoothing=0.02, reversal_speed=0.0), Viscous(), Armature())
"""Terms of all estimates: those of the rig."""

SIDES = ("left", "right")
WALKING = ZeroPhase(cutoff=8.0, kinematics_cutoff=60.0)
"""Preparation of the walk: touch-downs shake the legs faster than the default low-pass of the angles lets through."""


@dataclass(frozen=True, eq=False, repr=False)
class ForceError:
    """Ground force on one foot, predicted from joint torques on a motion that the estimate has not seen."""

    motion: str  # name of the motion
    link: str  # foot
    time: FloatArray  # samples [s], (N,)
    measured: FloatArray  # vertical force of the force plate [N], (N,)
    predicted: FloatArray  # predicted vertical force [N], (N,)
    half: FloatArray  # half the width of its 95 % band [N], (N,)
    force: float  # RMS error of the vertical force against the truth [N]
    relative: float  # the same over the weight of the machine
    pressure: float  # RMS error of the centre of pressure forward [m]
    inside: float  # share of the samples whose true vertical force is within the band


@dataclass(frozen=True, eq=False, repr=False)
class WalkReplay:
    """What the rows of a walking leg tell while it swings, with an IMU whose bias a stance log of the session told."""

    estimates: Mapping[str, Estimate]  # estimate of each leg by side, on a base that moves
    seconds: Mapping[str, float]  # time of swing that was used, by side [s]
    alone: Estimate  # estimate of both legs and the torso from the walking log alone; friction and rotors are unknown
    fixed: tuple[Finding, ...]  # findings about the left leg if its torso is taken for fixed
    bias_error: float  # error of the bias of the specific force that was taken out [m/s²]


@dataclass(frozen=True, eq=False, repr=False)
class Disturbed:
    """Estimate from stance of which a share is labelled wrongly or slips."""

    moved: float  # largest change of a parameter over its standard deviation
    parameter: str  # that parameter
    share: float  # share of the samples that findings name
    findings: tuple[Finding, ...]  # what was found


@dataclass(frozen=True, eq=False, repr=False)
class StanceReplay:
    """One virtual BLEEX, identified from swing, with stance and force plates, and with stance alone."""

    leg: Leg  # the machine with its true inertias
    truth: Mapping[str, float]  # true parameters by name. On a held torso J1 includes the rotor of the hip
    estimates: Mapping[str, Estimate]  # "swing", "plates" and "no plates"
    refused: str  # why swing does not tell the torso
    forces: tuple[ForceError, ...]  # ground forces that the estimate without plates predicts
    walk: WalkReplay  # walking
    wrong: Disturbed  # stance with wrong labels
    slipping: Disturbed  # stance with slipping feet
    seed: int  # seed of phases, bias and noise

    def true_value(self, way: str, name: str) -> float:
        """Look up the truth of a parameter of an estimate."""
        rotor = self.truth[f"Ia_{name[3:]}_hip"] if way == "swing" and name.startswith("J1_") else 0.0
        return self.truth[name] + rotor

    def errors(self, way: str) -> FloatArray:
        """Compute the errors of all parameters of an estimate."""
        estimate = self.estimates[way]
        return np.asarray(estimate.values - np.array([self.true_value(way, name) for name in estimate.names]))

    def coverage(self, way: str) -> float:
        """Compute the share of the parameters whose true value is in its 95 % interval."""
        estimate = self.estimates[way]
        half = 0.5 * np.diff(estimate.interval(0.95), axis=1)[:, 0]
        return float(np.mean(np.abs(self.errors(way)) <= half))

    def largest(self, way: str, symbol: str) -> float:
        """Find the largest relative error among parameters."""
        names, errors = self.estimates[way].names, self.errors(way)
        return relative_error(names, errors, self.truth, symbol)


def relative_error(names: Sequence[str], errors: FloatArray, truth: Mapping[str, float], symbol: str) -> float:
    """Find the largest relative error among parameters "M", "X…" or "J…" of the legs; NaN without such."""
    chosen = [
        abs(error / truth[name])
        for name, error in zip(names, errors, strict=True)
        if name[0] == symbol and name not in ("X0", "J0") and name in truth
    ]
    return max(chosen, default=float("nan"))


def reproduce_stance(
    seed: int = 0, progress: Callable[[float], None] | None = None, extent: StanceExtent | None = None
) -> StanceReplay:
    """Let a virtual BLEEX swing, squat, stand on one foot and walk, and identify it in three ways.

    Args:
        seed: Seed of phases, bias of the IMU and noise.
        progress: Function that receives the completed share, 0 to 1.
        extent: Durations of the logs; None for the default ones.

    Returns:
        The replay.

    Raises:
        ExoidError: MuJoCo is not installed, or the logs are too short.
    """
    report = progress or (lambda _: None)
    runs = run_stance(seed, extent, lambda share: report(0.3 * share))
    machine = load_exo("bleex", base="floating")
    imu = split(machine, runs.log("squats")).imu
    swing, walk = (_corrected(runs.log(motion, held=motion == "walking"), imu) for motion in ("swing", "walking"))
    estimates = {
        "swing": identify(load_exo("bleex"), replace(swing, contacts={}), TERMS, check=False),
        "plates": identify(machine, [*runs.stance(plates=True), swing], TERMS),
        "no plates": identify(machine, [*runs.stance(), swing], TERMS),
    }
    report(0.7)
    truth, refused = true_values(runs.plant), ""
    try:
        identify(machine, swing, TERMS)
    except NotIdentifiableError as error:
        refused = error.what
    found = estimates["no plates"]
    wrong = [*runs.stance(wrong=WRONG), swing]
    slipping = [runs.log("slipping squats"), *runs.stance()[1:], swing]
    replay = StanceReplay(
        leg=runs.plant.leg,
        truth=MappingProxyType(truth),
        estimates=MappingProxyType(estimates),
        refused=refused,
        forces=_forces(found, runs),
        walk=_walk(machine, found, walk, _rms((imu.force_bias if imu is not None else 0.0) - runs.bias[3:])),
        wrong=_disturbed(found, identify(machine, wrong, TERMS), ("wrong-contact", "contact-changes")),
        slipping=_disturbed(found, identify(machine, slipping, TERMS), ("slipping-contact",)),
        seed=seed,
    )
    report(1.0)
    return replay


def true_values(plant: GroundPlant) -> dict[str, float]:
    """Return the true parameters by name: rigid bodies, friction and rotors."""
    leg = plant.leg
    values = dict(zip(leg.parameter_names, leg.parameters.tolist(), strict=True))
    of_joints = {"c0": plant.coulomb, "d": plant.viscous, "Ia": plant.armature}
    for symbol, each in of_joints.items():
        values |= {f"{symbol}_{label}": float(x) for label, x in zip(leg.joint_labels, each, strict=True)}
    return values


def _corrected(recording: Recording, imu: ImuErrors | None) -> Recording:
    """Take errors of the IMU, if any, out of a log; they are those of another log of the session."""
    if imu is None or recording.base is None:
        return recording
    return replace(recording, base=imu.corrected(recording.base))


def _forces(estimate: Estimate, runs: StanceRuns) -> tuple[ForceError, ...]:
    """Predict ground forces on motions that were not used, without the force plates."""
    found, leg = [], runs.plant.leg
    weight = GRAVITY * float(sum(body.mass for body in leg.model.inertias))  # of all bodies [N]
    for motion in ("unseen squats", "unseen left"):
        run, plates = runs.runs[motion], runs.log(motion, plates=True)
        for link, force in ground_forces(estimate, runs.log(motion)).items():
            rows = np.searchsorted(run.time, force.time)
            height = float(runs.plant.soles[link].points[:, 2].mean())
            true = level_wrench(leg, plates.q, link, run.wrench(link), rows)
            measured = level_wrench(leg, plates.q, link, plates.wrenches[link], rows)
            error = force.force[:, 2] - true.force[:, 2]
            aside = (force.center_of_pressure(height) - true.center_of_pressure(height))[:, 0]
            found.append(
                ForceError(
                    motion=motion,
                    link=link,
                    time=force.time,
                    measured=measured.force[:, 2],
                    predicted=force.force[:, 2],
                    half=force.force_half[:, 2],
                    force=_rms(error),
                    relative=_rms(error) / weight,
                    pressure=_rms(aside),
                    inside=float(np.mean(np.abs(error) <= force.force_half[:, 2])),
                )
            )
    return tuple(found)


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _walk(machine: Leg, known: Estimate, walk: Recording, bias_error: float) -> WalkReplay:
    """Identify the legs from the swing of a walk; friction and rotors are those of another estimate."""
    legs = {side: load_leg("bleex", side=side) for side in SIDES}
    logs = {side: swinging_leg(walk, leg, side) for side, leg in legs.items()}
    estimates = {}
    for side, leg in legs.items():
        pairs = [(symbol, label) for symbol in ("c0", "d", "Ia") for label in leg.joint_labels]
        given = {f"{symbol}_{label}": known[f"{symbol}_{side}_{label}"].value for symbol, label in pairs}
        estimates[side] = identify(leg, logs[side], TERMS, known=given, preparation=WALKING, check=False)
    return WalkReplay(
        estimates=MappingProxyType(estimates),
        seconds={side: np.count_nonzero(np.asarray(log.mask)) / log.sample_rate for side, log in logs.items()},
        alone=identify(machine, walk, TERMS, preparation=WALKING),
        fixed=tuple(check(legs["left"], replace(logs["left"], base=None))),
        bias_error=bias_error,
    )


def swinging_leg(walk: Recording, leg: Leg, side: str) -> Recording:
    """Take one leg out of a walking log, at samples at which its foot is further than the edge from the ground."""
    assert walk.tau is not None
    joints = [walk.joint_names.index(name) for name in leg.joint_names]
    away = max(1, round(EDGE * walk.sample_rate))
    mask = scipy.ndimage.binary_erosion(~np.asarray(walk.contacts[f"{side}_foot"]), iterations=away)
    return Recording(
        walk.time,
        walk.q[:, joints],
        tau=walk.tau[:, joints],
        joint_names=leg.joint_names,
        base=walk.base,
        mask=mask,
    )


def _disturbed(before: Estimate, after: Estimate, kinds: Sequence[str]) -> Disturbed:
    """Compare an estimate with one from undisturbed logs."""
    moved = np.abs(after.values - before.values) / before.std
    findings = tuple(finding for finding in after.findings if finding.kind in kinds)
    share = max((float(finding.value) for finding in findings), default=0.0)
    return Disturbed(float(moved.max()), before.names[int(np.argmax(moved))], share, findings)
