"""Memory of a recursive estimator as JSON: exact to the last bit, whole or not at all."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.leg.leg import Leg
from exoid.tools.files import write_whole
from exoid.torques import TorqueModel
from exoid.torques.catalog import term_from_json, term_to_json

from .intake import Intake
from .memory import Memory
from .settings import Settings
from .state import Change, Correlation, Detector, Drift, Epochs, Information, State

SCHEMA = "exoid-online-2"

REMEDY = "give the path of a file that RecursiveEstimator.save wrote"

PLAIN = (
    "rate",
    "cutoff",
    "forgetting",
    "memory",
    "estimator",
    "reversal_speed",
    "nonnegative",
    "consistent",
    "false_alarms",
    "window",
    "epoch",
)
"""Settings that JSON holds as they are."""


def write_memory(path: str | os.PathLike[str], settings: Settings, memory: Memory) -> None:
    """Write settings and memory."""
    data = {"schema": SCHEMA, "leg": _leg(settings.model.leg), "settings": _settings(settings), **_memory(memory)}
    write_whole(path, [json.dumps(data, ensure_ascii=False, allow_nan=False), "\n"])


def read_memory(path: str | os.PathLike[str], leg: Leg) -> tuple[Settings, Memory]:
    """Read what :func:`write_memory` wrote."""
    where = str(path)
    try:
        data = json.loads(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise ExoidError(f"cannot be read ({error.strerror or error})", where=where, remedy=REMEDY) from error
    except (ValueError, RecursionError) as error:
        raise ExoidError(f"not JSON ({error})", where=where, remedy=REMEDY) from error
    if not isinstance(data, dict) or data.get("schema") != SCHEMA:
        raise ExoidError(f"no memory of schema {SCHEMA!r}", where=where, remedy=REMEDY)
    try:
        if data["leg"] != _leg(leg):
            raise ExoidError(
                f"the memory is of {data['leg']['name']}, and not of this leg",
                where=where,
                remedy="resume with the leg of the saved estimator, or begin anew",
            )
        settings = _settings_from(data["settings"], leg)
        return settings, _memory_from(data, settings)
    except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError) as error:
        raise ExoidError(f"damaged: {type(error).__name__} {error}", where=where, remedy=REMEDY) from error


def _leg(leg: Leg) -> dict[str, Any]:
    """What identifies a leg."""
    return {
        "name": leg.description.name,
        "sha256": leg.description.sha256,
        "joints": list(leg.joint_names),
        "locked": dict(leg.locked),
        "cumulative": leg.cumulative,
    }


def _settings(settings: Settings) -> dict[str, Any]:
    model = settings.model
    return {
        **{name: getattr(settings, name) for name in PLAIN},
        "torque_limits": [None if math.isinf(x) else x for x in settings.torque_limits.tolist()],
        "terms": [term_to_json(term) for term in model.terms],
        "separate": list(model.separate),
        "parameters": list(model.names),
    }


def _settings_from(data: Mapping[str, Any], leg: Leg) -> Settings:
    terms = tuple(term_from_json(term) for term in data["terms"])
    model = TorqueModel(leg, terms, separate=tuple(data["separate"]))
    if list(model.names) != data["parameters"]:
        raise ValueError(f"parameters {data['parameters']} of a model with {list(model.names)}")
    limits = np.array([math.inf if x is None else x for x in data["torque_limits"]])
    return Settings(model=model, torque_limits=limits, **{name: data[name] for name in PLAIN})


def _memory(memory: Memory) -> dict[str, Any]:
    state, intake = memory.state, memory.intake
    return {
        "state": {
            **{name: _array(getattr(state, name)) for name in State._fields if name not in NESTED},
            "samples": state.samples,
            **{name: _record(getattr(state, name)) for name in PARTS},
            "changes": [change._asdict() for change in state.changes],
            "drifts": [drift._asdict() for drift in state.drifts],
        },
        "intake": {**intake._asdict(), "time": None if math.isnan(intake.time) else intake.time},
        "pending": [list(sample) for sample in memory.pending],
    }


PARTS: dict[str, type[Information] | type[Correlation] | type[Detector] | type[Epochs]] = {
    "information": Information,
    "correlation": Correlation,
    "detector": Detector,
    "epochs": Epochs,
}
"""Records in a state."""

NESTED = (*PARTS, "samples", "changes", "drifts")
"""Fields of a state that are no arrays."""


def _memory_from(data: Mapping[str, Any], settings: Settings) -> Memory:
    found = data["state"]
    parts: dict[str, Any] = {
        name: kind(**{key: _value(x) for key, x in found[name].items()}) for name, kind in PARTS.items()
    }
    arrays = {name: _value(found[name]) for name in State._fields if name not in NESTED}
    changes = tuple(
        Change(**{**one, "parameters": tuple(one["parameters"]), "values": tuple(one["values"])})
        for one in found["changes"]
    )
    state = State(
        **{
            "samples": int(found["samples"]),
            "changes": changes,
            "drifts": tuple(Drift(**one) for one in found["drifts"]),
            **parts,
            **arrays,
        }
    )
    P, n = settings.count, settings.n
    if state.values.shape != (P,) or state.information.R.shape != (n + 1, P + 1, P + 1):
        raise ValueError("shapes of the state do not fit the settings")
    stream = data["intake"]
    intake = Intake(
        given=None if stream["given"] is None else (bool(stream["given"][0]), bool(stream["given"][1])),
        last=tuple(stream["last"]),
        time=math.nan if stream["time"] is None else stream["time"],
        missing=int(stream["missing"]),
        implausible=int(stream["implausible"]),
        counts=tuple((str(kind), int(count)) for kind, count in stream["counts"]),
        received=int(stream["received"]),
    )
    return Memory(state, intake, tuple(tuple(sample) for sample in data["pending"]))


def _record(record: Information | Correlation | Detector | Epochs) -> dict[str, Any]:
    return {key: _array(x) if isinstance(x, np.ndarray) else x for key, x in record._asdict().items()}


def _array(array: FloatArray) -> dict[str, Any]:
    """Shape and numbers; null stands for infinity."""
    flat = array.ravel().tolist()
    return {"shape": list(array.shape), "numbers": [None if math.isinf(x) else x for x in flat]}


def _value(data: Any) -> Any:  # noqa: ANN401 - as JSON holds it
    """Array that :func:`_array` wrote, or a number as it is."""
    if not isinstance(data, Mapping):
        return data
    numbers = [math.inf if x is None else float(x) for x in data["numbers"]]
    return np.array(numbers, dtype=np.float64).reshape(data["shape"])
