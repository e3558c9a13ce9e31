"""The kinds of fault that nuisance columns describe: which columns, which size matters, and what to say of them."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.torques import Offset, Stiffness, TorqueModel
from exoid.torques.catalog import SLIDE, turning_joints

from .arms import ArmShapes
from .columns import Column


class Nuisance(NamedTuple):
    """One fault that columns describe."""

    kind: str  # kind of the finding
    joint: str  # name of the joint; "" for all
    place: int  # index of the joint, or of the segment; −1 for all
    unit: str  # unit of the fault
    columns: tuple[int, ...]  # indices of its columns, with a coefficient each
    form: str = ""  # form of the fault, such as "Stribeck friction"; "" for any
    most: float = np.inf  # size up to which its columns, of first order, describe it
    beside: tuple[int, ...] = ()  # columns that protect its own test

    @property
    def is_corrected(self) -> bool:
        """Whether the fault is taken out of the recordings; else its columns stay in the fit."""
        return KINDS[self.kind].most > 0.0 and len(self.columns) == 1

    def is_large_enough(self, delta: FloatArray, torque_share: float) -> bool:
        """Whether the fault has a size that matters, however exact the log."""
        least = KINDS[self.kind].least
        if least is None:
            return torque_share >= 3e-3  # of the joint's RMS torque
        least *= SLIDE if self.kind == "angle-offset" and self.unit == "m" else 1.0
        return bool((np.abs(delta).max() if self.kind == "cross-talk" else np.linalg.norm(delta)) >= least)


class Kind(NamedTuple):
    """What is said of one kind of fault, and from which size on."""

    least: float | None  # smaller faults are not reported; None where the torque of the fault has to matter
    text: str  # message, a format of :meth:`message`
    remedy: str
    # Largest part that is taken out of the recordings at once: beyond, one step of Gauss and Newton is not to be
    # trusted. 0 where the fault cannot be taken out.
    most: float = 0.0
    value: Callable[[float], float] = lambda delta: delta  # value that is reported for a coefficient
    signs: tuple[str, str] = ("", "")  # word for a positive and a negative value

    def message(
        self, fault: Nuisance, x: float, delta: FloatArray, limit: float = 0.0, share: float = 0.0, waves: float = 0.0
    ) -> str:
        """Say what a fault is, with its value as reported, its coefficients, and what residuals showed before."""
        millimetres = f"were {1e3 * x:.2g} mm elsewhere" if fault.unit == "m" else f"were off by {x:.2g} of the arm"
        moments = ", ".join(f"{x:.3g}" for x in np.round(delta[1:4], 4) + 0.0)
        load = f"{delta[0]:+.2g} kg with a moment of ({moments}) kg·m"
        degrees = f"{1e3 * x:.3g} mm" if fault.unit == "m" else f"{np.degrees(x):.3g}°"
        texts = {"of": "" if fault.unit == "1" else f" {fault.unit}", "sign": self.signs[int(x <= 0.0)], "load": load}
        texts |= {"whose": f"the torque of {fault.joint or 'all joints'}", "degrees": degrees, "displaced": millimetres}
        texts |= {"often": fault.form or f"{waves:.0f} times", "limit": f"{limit:.3g} {fault.form}, {share:.0%}"}
        numbers = {"x": x, "milli": 1e3 * abs(x), "percent": 100.0 * x, "size": 100.0 * abs(x)}
        return self.text.format(**fault._asdict(), **numbers, **texts, largest=np.abs(delta).max())


# An exact log shows faults that matter to nobody: the least sizes are set by hand (docs/checks.md lists them).
KINDS = {
    "torque-delay": Kind(
        5e-4,
        "{whose} comes {milli:.3g} ms {sign}",
        'correct the time stamps, or identify with delay="auto" (--delay auto)',
        most=0.1,
        signs=("after the motion, or its sensor has a low-pass of that time constant", "before the motion"),
    ),
    "angle-delay": Kind(
        1e-3,
        "the angle of {joint} is {milli:.3g} ms behind the other channels, or behind a low-pass of that time constant",
        "correct its time stamps, and filter all channels alike or none",
    ),
    "smoothed-torque": Kind(
        None,
        "the torque of {joint} has no noise, and lacks a part of what is faster than 3 Hz: it was smoothed before",
        "pass the torque as it was measured: exoid filters both sides of the equation alike",
    ),
    "torque-curve": Kind(
        5e-3,
        "the torque of {joint} has not one scale: it reads {percent:+.2g} % {form}",
        "calibrate sensor or motor over the whole range, in both directions: large currents saturate a motor",
    ),
    "saturation": Kind(
        0.75,
        "{percent:.0f} % of the torque of {joint} beyond about {limit} of the samples, does not act, as of commands "
        "that its drive cannot give",
        "log the current or torque that the drive gives, limit the command alike, or leave these samples out",
    ),
    "two-clocks": Kind(
        1e-4,
        "the clock of the torques is {percent:.3g} % slower than that of the angles: delays grow by {milli:.3g} ms/s",
        "stamp both by one clock, or scale the time of one of them; a delay that stays does not mend it",
        most=0.02,
    ),
    "torque-scale": Kind(
        5e-3,
        "{whose} is {x:.3g} times what the other joints' torques ask for; one log cannot tell which joint is right",
        "calibrate the torque sensors: a known mass on the leg shows which one is wrong",
        most=2.0,
        value=lambda delta: 1.0 + delta,
    ),
    "angle-offset": Kind(
        float(np.deg2rad(0.2)),
        "the angle of {joint} reads {degrees} too much: gravity and coupling have another phase",
        "set the zero of the encoder again, or add the offset to the logged angle",
        most=0.5,
        value=lambda delta: -delta,
    ),
    "angle-scale": Kind(
        2e-3,
        "the angle of {joint} is logged {x:.3g} times as large as it is: its unit or gear ratio is wrong",
        "correct the unit or the counts per turn of the encoder",
        most=0.5,
        value=lambda delta: 1.0 / (1.0 + delta),
    ),
    "gravity-direction": Kind(
        float(np.deg2rad(0.2)),
        "gravity is turned by {degrees} against the model: the base is tilted, or the zero of the first angle is wrong",
        "level the base, or give its tilt: Recording(torso=TorsoMotion(pitch=...)); correct the lean of a rail in the "
        "URDF; calibrate the accelerometer of a moving base",
        most=0.5,
    ),
    "segment-length": Kind(
        5e-3,
        "the segment behind {joint} is {percent:+.3g} % longer than in the URDF, or the clock of the log is off by "
        "half of that",
        "measure the distance between the joint axes and correct the URDF; compare the log with another clock",
    ),
    "clock": Kind(
        1e-3,
        "the motion is {size:.3g} % {sign} than the time stamps say, or a length is wrong: coupling and gravity "
        "contradict each other",
        "compare the stamps with another clock, and check the lengths of all segments",
        signs=("faster", "slower"),
    ),
    "known-torque": Kind(
        2e-2,
        "payloads and wrenches of the log act {x:.3g} times as it says{sign}",
        "check mass, place and link of payloads, and sign, unit and axes of force sensors",
        value=lambda delta: 1.0 + delta,
        signs=("", ": they have the wrong sign"),
    ),
    "wrench-delay": Kind(
        1e-3,
        "measured wrenches come {milli:.3g} ms {sign}",
        "correct their time stamps",
        signs=("after the motion", "before the motion"),
    ),
    "contact-place": Kind(
        2e-3,
        "{joint} touches the ground {milli:.2g} mm {form} the place that it is said to be at, in its zero pose",
        "measure this place on its link, and correct its frame in the URDF (contacts=)",
    ),
    "unmodelled-friction": Kind(
        None,
        "the residual of {joint} depends on its velocity or load as {form} does",
        "compare Stribeck and load friction and presliding by exoid select; |v| and v² need a term of your own",
    ),
    "unmodelled-force": Kind(
        None,
        "the residual of {joint} depends on the angles as the force of a strap, a cable or a spring does",
        "remove the strap or cable, or add the term stiffness",
    ),
    "torque-offset": Kind(
        None,
        "the torque of {joint} reads {x:.3g} {unit} too much at all times, which no term describes: the zero of its "
        "sensor, or friction that differs between the directions",
        "add the term offset, or set the zero of the sensor again",
    ),
    "moment-arm": Kind(
        3e-4,
        "the moment arm of the actuator at {joint} has another shape than described: as if the {form} {displaced}",
        "measure both attachment points in the frames of their links, or the moment arm over the angle",
    ),
    "change": Kind(
        None,
        "{form} differs by {x:.3g}{of}: one value does not describe all data",
        "look for what happened then, such as an encoder that slipped, a zero or clock that was set again, a load, a "
        "brake or a stand that carried the leg; leave one part out, or give the parts as groups with own parameters",
    ),
    "wrong-load": Kind(
        None,
        "{form}, the segment behind {joint} carries another load than the log says, by {load}",
        "weigh what was added or taken off, measure its place, and state it (payloads=, --payload); an encoder whose "
        "zero was set again looks alike, and so does a brake or a stand that carries the leg for a time",
    ),
    "play": Kind(
        None,
        "{joint} has play between its encoder and its link, {milli:.2g} m{unit} to each side of the middle",
        "take the play out of the gear, or log the angle of the link",
    ),
    "angle-ripple": Kind(
        5e-4,
        "the angle of {joint} is off by up to {milli:.2g} mrad in waves, {often} a turn or about so often, as a "
        "potentiometer or an encoder with an eccentric disc or magnet is",
        "calibrate the angle over its range against another encoder, and subtract what it reads too much; a spring "
        "between encoder and link bends so under gravity, too",
    ),
    "elastic-joint": Kind(
        None,
        "{joint} is elastic between its encoder and its link, which the model lacks: {x:.3g} {unit}",
        "subtract torque over stiffness from that angle, or log the angle of the link, too, and give the drive: "
        "exoid.actuators.SeriesElastic with the stiffness of the spring; a stand that sways looks so, too",
        value=lambda delta: 1.0 / delta,
    ),
    "cross-talk": Kind(
        5e-3,
        "the torque sensor of {joint} also sees the torques of other joints ({largest:.1%})",
        "calibrate the sensors together, with a full matrix; torques of motors of a differential or a belt are mixed, "
        "too: describe the coupling (exoid.actuators.Coupling)",
    ),
}
"""Kinds of fault, in the units of their findings."""

OF_ONE_JOINT = {
    "late angle": ("angle-delay", "s", ""),
    "scale": ("angle-scale", "1", ""),
    "smoothing": ("smoothed-torque", "1", ""),
    "gain |τ|": ("torque-curve", "1", "where positive, and as much less where negative"),
    "gain τ²": ("torque-curve", "1", "at its RMS size, and ever more beyond"),
    "beyond": ("saturation", "1", "N·m"),
    "constant t": ("change", "N·m/s", "from each second to the next, the zero of the torque"),
    "friction |v|": ("unmodelled-friction", "N·m·s/rad", "asymmetric friction"),
    "friction v²": ("unmodelled-friction", "N·m·s²/rad²", "quadratic friction"),
    "friction Stribeck": ("unmodelled-friction", "N·m", "Stribeck friction"),
    "friction load": ("unmodelled-friction", "1", "friction that grows with the load"),
    "friction t": ("unmodelled-friction", "1/s", "friction that changes with time, such as of a gear that warms up,"),
    "compliance": ("elastic-joint", "N·m/rad", ""),
    "ringing": ("elastic-joint", "N·m/rad", ""),
}
"""Columns that describe a fault of each joint alone: its kind, unit and form."""


def without_offset(model: TorqueModel) -> list[int]:
    """Joints on which no term acts that describes a constant torque."""
    biased = {joint for one in model.blocks if isinstance(one.term, (Offset, Stiffness)) for joint in one.joints}
    return [joint for joint in range(len(model.leg.joint_names)) if joint not in biased]


class Library(NamedTuple):
    """Nuisance columns of a torque model, and the faults that combine them."""

    columns: tuple[Column, ...]  # K of them
    faults: tuple[Nuisance, ...]  # those that are tested
    always: tuple[int, ...]  # columns of every test: sharp friction, or when it turns, is no other fault
    free: tuple[int, ...]  # columns that every fit contains: scales of torques whose constants were not known
    friction: tuple[int, ...]  # columns of friction of other forms


@lru_cache(maxsize=4)  # a check asks for it several times
def library(
    model: TorqueModel, shapes: tuple[tuple[int, ArmShapes], ...], free: tuple[int, ...], *, known: bool, sensed: bool
) -> Library:
    """List the faults that are tested; of known torques, of payloads or sensors, where there are any."""
    arms = dict(shapes)
    names, planar = model.leg.joint_names, model.leg.chain is not None
    n, unbiased, turns = len(names), without_offset(model), turning_joints(model.leg)
    few = n <= 4  # beyond, cross-talk and forces of other joints would be too many columns to tell apart
    columns: list[Column] = []
    faults: list[Nuisance] = []
    always: list[int] = []
    scales: list[int] = []

    def add(kind: str, place: int, *others: int) -> tuple[int, ...]:
        columns.extend(Column(kind, place, other) for other in others or (-1,))
        return tuple(range(len(columns) - len(others or (-1,)), len(columns)))

    for j, joint in enumerate(names):
        # A robot that replays one stride turns alike each time: its friction would look like a delay.
        faults.append(Nuisance("torque-delay", joint, j, "s", add("delay", j), beside=add("turning", j)))
        gain, zero = add("gain", j), add("zero", j)
        scales += gain if j in free else ()
        if n != 2 or j == 1:  # of two joints only the ratio shows
            faults.append(Nuisance("torque-scale", joint, j, "1", gain))
        # In a planar leg a tilt of the base changes the torque as the zero of the first angle does.
        turned = ("gravity-direction", "") if planar and j == 0 else ("angle-offset", joint)
        faults.append(Nuisance(*turned, j, "rad", zero))
        always += (*add("sharpness", j), *add("reversals", j))
        for column, (kind, unit, form) in OF_ONE_JOINT.items():
            # half of a torque: no sensor or motor is bent by more; in 0.05 s a motion of 2 Hz goes on by half a radian
            most = {"torque-curve": 0.5, "angle-delay": 0.05, "saturation": 1.25}.get(kind, np.inf)
            faults.append(Nuisance(kind, joint, j, unit, add(column, j), form=form, most=most))
        force = (*add("force", j, *(range(n) if few else (j,))), *add("force²", j))
        faults.append(Nuisance("unmodelled-force", joint, j, "N·m", force))
        if j in unbiased:
            faults.append(Nuisance("torque-offset", joint, j, "N·m", add("constant", j)))
        if few and n > 1:  # of a belt or a differential a sensor sees all of another torque, and no more
            others = add("cross-talk", j, *(k for k in range(n) if k != j))
            faults.append(Nuisance("cross-talk", joint, j, "1", others, most=1.2))
        if planar and j < n - 1:
            faults.append(Nuisance("segment-length", joint, j, "1", add("length", j), most=0.5))
        faults.append(Nuisance("play", joint, j, "rad", add("play", j), most=0.05))
        for k, often in ((4, "four times"), (0, "")) if turns[j] else ():
            waves = add("ripple", j, 2 * k, 2 * k + 1)
            faults.append(Nuisance("angle-ripple", joint, j, "rad", waves, form=often, most=0.15 / (k or 6)))
        if j in arms:
            faults.append(Nuisance("moment-arm", joint, j, arms[j].unit, add("arm", j, 0, 1), form=arms[j].what))
    if n > 1:
        turning = tuple(k for k, one in enumerate(columns) if one.kind == "turning")
        faults.insert(0, Nuisance("torque-delay", "", -1, "s", add("delays", 0), beside=turning))
        add("gains", 0)  # of all torques, which one log cannot show; it may differ between logs
    of_known = (("known-torque", "1", "known"), ("wrench-delay", "s", "known delay"))
    faults += [Nuisance(kind, "", -1, unit, add(column, 0)) for kind, unit, column in of_known[: known + sensed]]
    faults.append(Nuisance("two-clocks", "", -1, "1", add("delays t", 0)))
    if not planar:
        faults.append(Nuisance("gravity-direction", "", -1, "rad", (*add("gravity", 0), *add("gravity", 1))))
    if n > 2 or (n > 1 and not planar):  # of a planar leg of two segments it is that of the length
        faults.append(Nuisance("clock", "", -1, "1", add("clock", 0), most=0.5))
    in_metres = ([x.replace("N·m", "N").replace("rad", "m") for x in (one.unit, one.form)] for one in faults)
    of_slides = (one._replace(unit=unit, form=form) for one, (unit, form) in zip(faults, in_metres, strict=True))
    faults = [one if one.place < 0 or turns[one.place] else slid for one, slid in zip(faults, of_slides, strict=True)]
    friction = tuple(k for k, one in enumerate(columns) if one.kind.startswith("friction") and one.kind[-2:] != " t")
    return Library(tuple(columns), tuple(faults), tuple(always), tuple(scales), friction)
