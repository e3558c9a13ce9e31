"""C of the coordinator, of the filter of contacts, and of both around the law on the ground: tables and memory."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy  # its parts load when they are first used

from exoid.codegen import ArrayInC, Dialect, InputInC, LawInC
from exoid.codegen.law_in_c import PartInC
from exoid.codegen.planar import masses, planar_parameters, turns_at_zero
from exoid.codegen.templates import sized
from exoid.codegen.terms import term_columns
from exoid.control.functions import PHASE, SEAT, SIDES, Contacts, legs_flexion
from exoid.errors import BadArgumentError

from .coordinator import Coordinator
from .hypotheses import ContactFilter
from .in_c import stance_in_c
from .law import StanceLaw
from .model import GroundModel

CONTACTS = (*SIDES, SEAT)
"""Contacts in the order of their bits."""

BEGIN = "    for (j = 0; j < {{N}}; ++j) {\n        state->torque[j] = state->last[j];\n    }\n    (void)in;"
"""The torque goes on from the last one, that of a fault too."""

CONDITIONS = ("request", "end", "known")
"""Conditions of a rule in the order of their numbers."""


def coordinator_part(machine: Coordinator, sets: Sequence[Contacts]) -> PartInC:
    """Write the state machine for probabilities of some sets; it begins in the safe stop, with unknown contacts."""
    functions, count, n = machine.functions, len(machine.functions), len(machine.limit)
    states = {name: k for k, name in enumerate(machine.states)}
    most = max(len(each.contacts) for each in functions.values())
    starts, masks = np.full((count, most), 2.0), np.full((count, most), 3)
    for k, each in enumerate(functions.values()):
        for place, (start, contacts) in enumerate(each.contacts):
            starts[k, place], masks[k, place] = start, mask(contacts)
    rules = [[states[rule.function], CONDITIONS.index(rule.condition), states[rule.then]] for rule in machine.table]
    own, helpers = [*functions.values()], sized("coordinator", F=count, H=len(sets), K=most, L=len(PHASE), R=len(rules))
    numbers = {name: x for name, x in machine.numbers.items() if name != "damping"}
    tables = (
        ArrayInC("dt", "time of a step [s]", np.array(1.0 / machine.rate)),
        ArrayInC("set", "sets of contacts: 1 left foot, 2 right foot, 4 seat", np.array([mask(each) for each in sets])),
        ArrayInC("duration", f"of {', '.join(functions)} [s]", np.array([each.duration for each in own])),
        ArrayInC("cyclic", "whether phase 1 is followed by phase 0", np.array([int(each.cyclic) for each in own])),
        ArrayInC("room", "distance from its posture in which a function begins [rad]", np.array([x.room for x in own])),
        ArrayInC("start", "phase at which each set of contacts begins; 2 for none", starts),
        ArrayInC("order", "sets of contacts in order", masks),
        ArrayInC("lifts", "whether a foot is lifted", np.array([int((row & 3 != 3).any()) for row in masks])),
        ArrayInC("at_phase", "phases of the postures", PHASE),
        ArrayInC("flexion", "of both legs at each phase [rad]", np.array([x.flexion.reshape(-1, 6) for x in own])),
        ArrayInC("rule", "function, 0 request, 1 end or 2 known, and function that follows", np.array(rules)),
        ArrayInC("standing", "function of standing", np.array(states["stand"])),
        ArrayInC("torque_limit", "largest torque [N m]", np.array(machine.limit, dtype=np.float64)),
        ArrayInC("power_limit", "largest power [W]", np.array(machine.power)),
        ArrayInC("patience", "time of a request, and of unexpected contacts [s]", np.array(machine.patience)),
        *(ArrayInC(name, "see exoid.control.ground.coordinator", np.array(x)) for name, x in numbers.items()),
    )
    order, first = ", ".join(f"{k} {name}" for name, k in states.items()), machine.begin(machine.states[-1])
    loaded = [first.loaded.get(x, 0.0) for x in CONTACTS]
    times = ("since_known", "unexpected", "settled", "lost", "waiting")
    memory = (
        ArrayInC("function", f"function that runs: {order}", np.array(states[first.function])),
        ArrayInC("phase", "its phase", np.array(0.0)),
        ArrayInC("level", "0 damping, 1 support of the last known contacts, 2 support", np.array(0)),
        ArrayInC("share", f"share of the load of {', '.join(CONTACTS)}", np.zeros(3)),
        ArrayInC("known", "contacts when they were last known, by their bits", np.array(mask(first.known))),
        *(ArrayInC(name, "see exoid.control.ground.coordinator.CoordinatorMemory", np.array(0.0)) for name in times),
        ArrayInC("fell", "whether the safe stop follows a loss of footing", np.array(0)),
        ArrayInC("request", "function that the wearer asks for, counted from 1; 0 for none", np.array(0)),
        ArrayInC("loaded", f"course of the share of {', '.join(CONTACTS)}", np.array(loaded)),
        ArrayInC("torque", "last torque within the bounds [N m]", np.zeros(n)),
        ArrayInC("slope", "its rate [N m/s]", np.zeros(n)),
    )
    return PartInC(tables, memory, helpers)


def wishes(machine: Coordinator) -> tuple[InputInC, ...]:
    """Inputs of the wearer's request and of what the caller noticed."""
    order = ", ".join(f"{k} {name}" for k, name in enumerate(machine.functions, 1))
    return (
        InputInC("wish", f"function that the wearer asks for, at one step: {order}; 0 for nothing new", "reading", 1),
        InputInC("slips", "1 where the footing is lost: joints are damped, and the safe stop follows", "reading", 1),
        InputInC("broken", "1 while a reading is made up from others: no foot is lifted", "reading", 1),
    )


def mask(contacts: Contacts) -> int:
    """Write a set of contacts as bits."""
    return sum(1 << k for k, name in enumerate(CONTACTS) if name in contacts)


def coordinated_in_c(law: StanceLaw, told: ContactFilter, machine: Coordinator, dialect: Dialect) -> LawInC:
    """Describe law, filter and coordinator, which begin in the safe stop; the caller gives the reference."""
    n = law.model.n
    if [*law.model.soles] != [*told.soles] or law.model.leg.joint_names != told.model.leg.joint_names:
        what = f"a law with {', '.join(law.model.soles)} and a filter with {', '.join(told.soles)}"
        raise BadArgumentError(what, remedy="make both of one estimate, with the same soles in one order")
    sets, order = [*told.chances(told.begin().probability)], ", ".join(told.soles)
    step = sized("coordinated", F=len(machine.functions), H=len(sets), S=len(told.soles))
    base = stance_in_c(law.model, law.friction, machine.rate, law.numbers, dialect, step)
    parts = coordinator_part(machine, sets), _filter_part(law.model, told, sets, base)
    bends = legs_flexion(law.model.leg, np.eye(n)).reshape(n, 6).T
    return replace(
        base,
        equation=f"contacts by their probability, function and shares by rules, and within bounds {base.equation}",
        damping=np.full(n, machine.numbers["damping"]),
        inputs=(
            *(each for each in base.inputs if each.name not in ("contact", "share")),
            InputInC("force", "specific force at the origin of the root link, forward and up [m/s^2]", "reading", 2),
            InputInC("closed", f"switches: 1 closed, 0 open, -1 none; {order}", "reading", len(told.soles)),
            *wishes(machine),
            InputInC(
                "tilt_d", f"planned angle to the horizontal, as the pitch [rad]; {order}", "target", len(told.soles)
            ),
        ),
        tables=(
            *(*base.tables, *parts[0].tables, *parts[1].tables),
            ArrayInC("bends", "flexion of hip, knee and ankle of the left, then of the right leg per angle", bends),
            ArrayInC("side", "leg of each joint: 1 left, 2 right", np.where(bends[:3].any(axis=0), 1, 2)),
            ArrayInC("damping", "damping without a footing [N m s/rad]", np.array(machine.numbers["damping"])),
        ),
        memory=(
            *(*parts[0].memory, *parts[1].memory),
            ArrayInC("held", "whether there was a support", np.array(0)),
            ArrayInC("held_q", "posture of the last support [rad]", np.zeros(n)),
            ArrayInC("held_torque", "its torque [N m]", np.zeros(n)),
        ),
        begin=f"{BEGIN}\n    {{{{p}}}}_settle(state, in);",
        helpers="\n".join((base.helpers, parts[0].helpers, parts[1].helpers)),
        limit=machine.limit,
    )


def _filter_part(model: GroundModel, told: ContactFilter, sets: Sequence[Contacts], law: LawInC) -> PartInC:
    """Write the filter; its rows are those of planar bodies and terms, times mean and factor of the parameters."""
    leg, noise, n, count = told.model.leg, told.noise, model.n, len(told.soles)
    size = np.sqrt(np.diag(told.covariance))
    weights, axes = np.linalg.eigh(told.covariance / np.outer(size, size).clip(1e-300))
    columns = np.column_stack([told.values, size[:, None] * axes * np.sqrt(weights.clip(0.0))])
    turns, links = turns_at_zero(model.pinocchio), leg.reduction.spread @ columns[: len(leg.parameter_names)]
    rows = [planar_parameters(leg.plane, turn) @ links[10 * b : 10 * b + 10] for b, turn in enumerate(turns)]
    # without terms one that is zero
    terms, joints, texts = zip(*(term_columns(told.model) or [(told.model.names[0], 0, "0.0")]), strict=True)
    of_terms = columns[[told.model.names.index(name) for name in terms]]
    low, first, second = told.gains
    shaken = [noise.acceleration * low] * 2 + [noise.gyro * first] + [noise.angle * second] * n
    rough = np.array([noise.force] * 2 + [noise.moment] * (n + 1)) ** 2 + ([0.0] * 3 + [(noise.torque * low) ** 2] * n)
    centres = next(each.values for each in law.tables if each.name == "sole").copy()
    for k, (link, sole) in enumerate(told.soles.items()):  # mean of its points, beside the middle of its ends
        ends = sole.points.min(axis=0) + sole.points.max(axis=0)
        centres[k] += told.axes[link][:2, :3] @ (sole.centre - 0.5 * ends)
    members = [*([float(link in each) for link in told.soles] for each in told.sets), [0.5] * count]
    every, sizes = (
        max(1, round(told.numbers["block"] * told.rate)),
        {"H": len(sets), "S": count, "Q": columns.shape[1], "T": len(terms)},
    )
    helpers = sized("contacts", **sizes, W=every, columns=", ".join(texts))
    numbers = {name: x for name, x in told.numbers.items() if f"_noise_{name}" in helpers}  # others are in tables
    tables = (
        ArrayInC("sections", "low-pass, and the same of first and second derivatives", np.ravel(told.filters)),
        ArrayInC("at_rest", "memory of them for 1", np.ravel([*map(scipy.signal.sosfilt_zi, told.filters)])),
        ArrayInC("parameters", "mass, mass moments and inertia of each body: mean and factor", np.concatenate(rows)),
        ArrayInC("terms", "parameter of each term: mean and factor", of_terms),
        ArrayInC("term_joint", "joint of each", np.array(joints)),
        *masses(leg.plane, turns, [*leg.model.inertias], leg.model.armature, "plain_"),
        ArrayInC("shaken", "variance of the accelerations", np.array(shaken) ** 2),
        ArrayInC("spread", "variance of the rows", rough),
        ArrayInC("wide", "forces of the unknown [N, N m]", told.weight * np.array([1.0] * 2 + [0.3] * (n + 1))),
        ArrayInC("centre", "middle of the points of each sole [m]", centres),
        ArrayInC("prior", "usual forces of a contact [N, N, N m]", told.prior),
        ArrayInC(
            "bit", "contact of each sole: 1 left foot, 2 right foot, 4 seat", np.array([*map(mask, sets[1:])])[:count]
        ),
        ArrayInC("member", "whether each sole is in each set, half for the unknown", np.array(members)),
        ArrayInC("changes", "prior of transitions from column to row", told.changes),
        *(ArrayInC(f"noise_{name}", "see ContactNoise in Python", np.array(x)) for name, x in numbers.items()),
    )
    start, channels, order = told.begin(), 3 * n + 6, ", ".join(told.soles)
    memory = (
        ArrayInC("probability", "of each set of contacts, the unknown last", start.probability),
        ArrayInC("chance", "probability of each set that the coordinator reads", start.probability[:-1]),
        ArrayInC("wrench", f"force forward and up and moment [N, N, N m]; {order}", np.zeros((count, 3))),
        ArrayInC("passed", "memory of the low-passes", np.zeros((channels, 12))),
        ArrayInC("samples", "samples since the last block", np.array(0)),
        ArrayInC("disagreement", f"share of the time in which a switch is wrong; {order}", np.zeros(count)),
        ArrayInC("misfit", "mean misfit of the best set", np.array(start.misfit)),
        ArrayInC("distrusted", "time for which contacts stay unknown [s]", np.array(0.0)),
        ArrayInC("earlier", "last readings: angles, rate of the pitch, torques and others", np.zeros(channels)),
        ArrayInC("still", "samples for which each has not changed", np.zeros(2 * n + 1, dtype=np.intp)),
        ArrayInC("frozen", "whether it is frozen", np.zeros(2 * n + 1, dtype=np.intp)),
        ArrayInC("smallest", "smallest change of each angle [rad]", np.full(n, start.step)),
        ArrayInC("pace", "speed of each joint when its angle changed last [rad/s]", np.zeros(n)),
    )
    return PartInC(tables, memory, helpers)
