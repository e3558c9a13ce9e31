"""Memory of a recursive estimator as JSON: exact to the last bit, whole or not at all."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping
from dataclasses import fields
from typing import Any, NamedTuple

import numpy as np

from exoid.errors import BadArgumentError, ExoidError, UnreadableInputError
from exoid.leg.leg import Leg
from exoid.tools.files import read_json, write_whole
from exoid.torques import TorqueModel
from exoid.torques.catalog import term_from_json, term_to_json

from .settings import Settings
from .state import Change, Drift, State, begin
from .stream import Sample, Stream

SCHEMA = "exoid-online-4"

PLAIN = tuple(field.name for field in fields(Settings) if field.name not in ("model", "torque_limits"))
"""Settings that JSON holds as they are."""


class Memory(NamedTuple):
    """All that a recursive estimator has to remember."""

    state: State  # what it knows
    stream: Stream  # what it knows of the stream
    pending: tuple[Sample, ...] = ()  # samples that wait for their block to be complete


def write_memory(path: str | os.PathLike[str], settings: Settings, memory: Memory) -> None:
    """Write settings and memory."""
    model = settings.model
    data = {
        "schema": SCHEMA,
        "leg": _leg(model.leg),
        "settings": {
            **{name: getattr(settings, name) for name in PLAIN},
            "torque_limits": settings.limits and [None if math.isinf(x) else x for x in settings.limits],
            "terms": [term_to_json(term) for term in model.terms],
            "separate": list(model.separate),
            "parameters": list(model.names),
        },
        "memory": _plain(memory),
    }
    write_whole(path, [json.dumps(data, ensure_ascii=False, allow_nan=False), "\n"])


def read_memory(path: str | os.PathLike[str], leg: Leg) -> tuple[Settings, Memory]:
    """Read what :func:`write_memory` wrote; all that does not fit the schema is an :class:`UnreadableInputError`."""
    where, remedy = str(path), "give the path of a file that RecursiveEstimator.save wrote"
    data = read_json(path, "memory", (SCHEMA,), remedy)
    try:
        name = data["leg"]["name"]
        if data["leg"] == _leg(leg):
            settings = _settings_from(data["settings"], leg)
            return settings, _memory_from(data["memory"], settings)
    except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError, ExoidError) as error:
        what = f"damaged: {type(error).__name__} {error}"
        raise UnreadableInputError(what, where=where, remedy=remedy, file=where) from error
    raise BadArgumentError(
        f"the memory is of {name}, and not of this leg",
        where=where,
        remedy="resume with the leg of the saved estimator, or begin anew",
        file=where,
    )


def _leg(leg: Leg) -> dict[str, Any]:
    """What identifies a leg."""
    return {
        "name": leg.description.name,
        "sha256": leg.description.sha256,
        "joints": list(leg.joint_names),
        "locked": dict(leg.locked),
        "cumulative": leg.cumulative,
    }


def _settings_from(data: Mapping[str, Any], leg: Leg) -> Settings:
    model = TorqueModel(leg, tuple(map(term_from_json, data["terms"])), separate=tuple(data["separate"]))
    if list(model.names) != data["parameters"]:
        raise ValueError(f"parameters {data['parameters']} of a model with {list(model.names)}")
    default = Settings(model)
    plain = {name: _like(getattr(default, name), data[name]) for name in PLAIN if name != "cutoff"}
    cutoff = None if data["cutoff"] is None else _like(1.0, data["cutoff"])
    limits = data["torque_limits"] and [math.inf if x is None else _like(1.0, x) for x in data["torque_limits"]]
    return Settings(model=model, torque_limits=limits, cutoff=cutoff, **plain)


def _memory_from(data: Mapping[str, Any], settings: Settings) -> Memory:
    """Fill the form of a memory, in which tuples have one item that stands for any number."""
    sample = (0.0,)
    changes = (Change(0, 0.0, "", "", ("",), 0.0, (0.0,)),)
    drifts = (Drift(0, 0.0, "", "", 0.0, 0.0, 0.0, 0.0),)
    count = len(settings.detection.hypotheses)
    state = begin(settings)._replace(changes=changes, drifts=drifts)
    state = state._replace(detector=state.detector._replace(candidates=(0,)))
    memory: Memory = _like(Memory(state, Stream((True,), sample, counts=(0,)), (sample,)), data)
    lengths = {len(sample) for sample in memory.pending} | {len(memory.stream.last) or 5 * settings.n}
    regular = lengths == {5 * settings.n} and len(memory.pending) < settings.block
    regular &= len(memory.stream.counts) == len(Stream().counts) and len(memory.stream.given) in (0, 2)
    triangles = (
        memory.state.information.R,
        memory.state.checkpoints.R,
        memory.state.epochs.R,
        memory.state.detector.collected.R,
    )
    detector = memory.state.detector
    regular &= all(-1 <= k < count for k in (detector.named, *detector.candidates))
    positive = (memory.state.weights, memory.state.detector.weights)
    if not regular or any(np.tril(R, -1).any() for R in triangles) or any((x <= 0.0).any() for x in positive):
        raise ValueError("samples, R factors or weights that no stream has")
    return memory


def _plain(value: Any) -> Any:  # noqa: ANN401 - as JSON holds it
    """Turn arrays into shape and numbers, and records into objects; null stands for infinity, and for NaN."""
    if isinstance(value, np.ndarray):
        numbers = [x if math.isfinite(x) else None for x in value.ravel().tolist()]
        return {"shape": list(value.shape), "numbers": numbers}
    if isinstance(value, tuple):
        names = getattr(value, "_fields", None)
        return [*map(_plain, value)] if names is None else dict(zip(names, map(_plain, value), strict=True))
    return None if isinstance(value, float) and math.isnan(value) else value


def _like(form: Any, data: Any) -> Any:  # noqa: ANN401 - as JSON holds it
    """Read what :func:`_plain` wrote, in the form of a value; a ValueError says what does not fit."""
    if isinstance(form, np.ndarray):
        if data["shape"] != list(form.shape):
            raise ValueError(f"an array of shape {data['shape']}, not {form.shape}")
        numbers = [math.inf if x is None else _like(0.0, x) for x in data["numbers"]]
        return np.array(numbers, dtype=np.float64).reshape(form.shape)
    if isinstance(form, tuple):
        names = getattr(form, "_fields", None)
        if names is None:
            return tuple(_like(form[0], each) for each in data)
        if set(data) != set(names):
            raise ValueError(f"fields {', '.join(data)}, not {', '.join(names)}")
        return type(form)(*(_like(getattr(form, name), data[name]) for name in names))
    if isinstance(form, float) and math.isnan(form) and data is None:
        return form
    wanted = (int, float) if isinstance(form, float) else type(form)
    if not isinstance(data, wanted) or isinstance(data, bool) is not isinstance(form, bool):
        raise ValueError(f"{data!r} in place of {type(form).__name__}")
    if isinstance(form, float) and not math.isfinite(data):
        raise ValueError(f"the number {data}")
    return float(data) if isinstance(form, float) else data
