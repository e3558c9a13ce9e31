"""Estimates as JSON files: self-contained, versioned, exact to the last bit."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from exoid._typing import FloatArray
from exoid.actuators.drive_data import actuators_from_data, actuators_to_data
from exoid.errors import ExoidError, UnreadableInputError
from exoid.leg.description import describe
from exoid.leg.leg import Leg
from exoid.regression.diagnostics import JointNoise
from exoid.regression.influence import influence_from_json, influence_to_json
from exoid.regression.parameters import Prior, PriorKnowledge
from exoid.regression.trends import Trend
from exoid.signals.preparation_names import preparation_from_json, preparation_to_json
from exoid.tools.files import refuse_content, write_whole
from exoid.tools.json_values import json_value, named, record, records
from exoid.torques import TorqueModel
from exoid.torques.catalog import term_from_json, term_to_json

from .data import EstimateData, Input
from .finding import Finding
from .model_error import ModelError
from .motion_ranges import ranges_from_json, ranges_to_json
from .nonlinear import NonlinearParameters
from .support import Support

SCHEMA = "exoid-estimate-1"

OPTIONAL = ("segments", "payloads", "moving_base")
"""Keys of a recording that are left out of a file where there is nothing to say."""

E = TypeVar("E", bound=EstimateData)


def write_estimate(estimate: EstimateData, path: str | os.PathLike[str]) -> None:
    """Write an estimate; see :meth:`Estimate.save`."""
    refuse_content(path, [each.sha256 for each in estimate.inputs if each.sha256])
    write_whole(path, [estimate_text(estimate)])


def estimate_text(estimate: EstimateData) -> str:
    """Write what :func:`read_estimate` reads."""
    return json.dumps(estimate_to_json(estimate), indent=1, ensure_ascii=False) + "\n"


def read_estimate(path: str | os.PathLike[str], kind: type[E]) -> E:
    """Read an estimate; see :meth:`Estimate.load`."""
    try:
        data = json.loads(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        remedy = "give the path of a file that exoid identify wrote"
        raise UnreadableInputError(
            f"cannot be read ({error.strerror or error})", where=str(path), remedy=remedy
        ) from error
    except (ValueError, RecursionError) as error:  # not UTF-8, not JSON, a number of ten thousand digits
        raise UnreadableInputError(f"not JSON ({error})", where=str(path), remedy="identify again and save") from error
    if not isinstance(data, dict) or data.get("schema") != SCHEMA:
        raise UnreadableInputError(
            f"not an estimate of schema {SCHEMA!r}", where=str(path), remedy="identify again and save"
        )
    try:
        return estimate_from_json(data, kind)
    except ExoidError as error:
        raise error.within(str(path)) from error
    except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError) as error:  # such as 10**400
        what = f"damaged: {type(error).__name__} {error}"
        raise UnreadableInputError(what, where=str(path), remedy="identify again and save") from error


def estimate_to_json(estimate: EstimateData) -> dict[str, Any]:
    """Turn an estimate into what JSON can hold, values by name."""
    model, leg = estimate.model, estimate.model.leg
    interval = estimate.interval(0.95)
    return {
        "schema": SCHEMA,
        "values": dict(zip(estimate.names, estimate.values.tolist(), strict=True)),
        "std": dict(zip(estimate.names, estimate.std.tolist(), strict=True)),
        "interval_95": dict(zip(estimate.names, interval.tolist(), strict=True)),
        "units": dict(zip(estimate.names, estimate.units, strict=True)),
        "condition_number": estimate.condition_number,
        "degrees_of_freedom": estimate.dof,
        "degrees_of_freedom_each": dict(zip(estimate.names, estimate.dof_each.tolist(), strict=True)),
        "residual_rms": dict(zip(estimate.joint_names, estimate.residual_rms.tolist(), strict=True)),
        "torque_spread": dict(zip(estimate.joint_names, estimate.torque_spread.tolist(), strict=True)),
        "merged": {regrouped.name: regrouped.into for regrouped in estimate.regrouped},
        "estimator": estimate.estimator,
        "preparation": preparation_to_json(estimate.preparation),
        "noise": named(estimate.joint_names, estimate.noise) if estimate.noise else {},
        "sizes": dict(zip(estimate.names, np.asarray(estimate.parameter_scale).tolist(), strict=True)),
        "calm_sizes": dict(zip(estimate.names, estimate.reference_scale.tolist(), strict=True)),
        "collinearity": dict(zip(estimate.names, estimate.collinearity.tolist(), strict=True)),
        "determined": dict(zip(estimate.names, estimate.identifiability, strict=True)),
        "warnings": list(estimate.warnings),
        "findings": json_value(estimate.findings),
        "ranges": ranges_to_json(estimate.ranges, estimate.joint_names),
        "model_error": {} if estimate.model_error is None else json_value(estimate.model_error),
        "cutoff_source": estimate.cutoff_source,
        "torque_delays": dict(zip(estimate.joint_names, estimate.torque_delays.tolist(), strict=True)),
        "actuators": None if estimate.actuators is None else actuators_to_data(estimate.actuators),
        **({"supports": json_value(estimate.supports)} if estimate.supports else {}),
        "known": dict(estimate.prior_knowledge.known),
        "prior": {name: list(pair) for name, pair in estimate.prior_knowledge.prior.values.items()},
        "prior_gains": estimate.prior_gains.tolist(),
        "nonnegative": estimate.prior_knowledge.nonnegative,
        "bounded": list(estimate.bounded),
        "trends": json_value(estimate.trends),
        "influence": influence_to_json(estimate.influence, estimate.names),
        "inputs": [
            {key: value for key, value in json_value(source).items() if value or key not in OPTIONAL}
            for source in estimate.inputs
        ],
        "shapes": _shapes_to_json(estimate.nonlinear, estimate.dof) if len(estimate.nonlinear) else {},
        "terms": [term_to_json(term) for term in model.terms],
        "leg": {
            "name": leg.description.name,
            "sha256": leg.description.sha256,
            "joints": list(leg.joint_names),
            "locked": dict(leg.locked),
            "cumulative": leg.cumulative,
            **({"base": leg.base} if leg.base != "fixed" else {}),
            "urdf": leg.description.text,
        },
        "covariance": estimate.covariance.tolist(),
    }


def estimate_from_json(data: Mapping[str, Any], kind: type[E]) -> E:
    """Rebuild an estimate."""
    about = data["leg"]
    leg = Leg.from_description(
        describe(about["urdf"], about["name"]),
        about["joints"],
        locked=about["locked"],
        cumulative=about["cumulative"],
        base=about.get("base", "fixed"),
    )
    if leg.description.sha256 != about["sha256"]:
        raise UnreadableInputError(
            "the URDF inside is not the one identified: its hash differs", remedy="identify again"
        )
    terms = tuple(term_from_json(term) for term in data["terms"])
    model = TorqueModel(leg, terms, separate=tuple(data["values"]))
    if tuple(data["values"]) != model.names:
        raise UnreadableInputError(
            f"values {', '.join(data['values'])} do not fit the parameters {', '.join(model.names)}"
        )
    values = np.array(list(data["values"].values()), dtype=np.float64)
    return kind(
        model=model,
        values=values,
        covariance=np.array(data["covariance"], dtype=np.float64),
        condition_number=float(data["condition_number"]),
        dof=float(data["degrees_of_freedom"]),
        residual_rms=np.array([data["residual_rms"][name] for name in leg.joint_names], dtype=np.float64),
        estimator=str(data["estimator"]),
        preparation=preparation_from_json(data["preparation"]),
        inputs=records(Input, data["inputs"]),
        noise=records(JointNoise, [data["noise"][name] for name in leg.joint_names] if data["noise"] else []),
        parameter_scale=_by_name(data["sizes"], model.names),
        warnings=_warnings(data["warnings"]),
        prior_knowledge=_prior_knowledge(data, model),
        bounded=tuple(str(name) for name in data["bounded"]),
        trends=records(Trend, data["trends"]),
        influence=influence_from_json(data["influence"], model.names),
        nonlinear=_shapes(data["shapes"]),
        dof_each=_by_name(data["degrees_of_freedom_each"], model.names),
        reference_scale=_by_name(data["calm_sizes"], model.names),
        prior_gains=np.array(data["prior_gains"] or np.zeros((0, 0)), dtype=np.float64),
        collinearity=_by_name(data["collinearity"], model.names),
        findings=records(Finding, data["findings"]),
        ranges=ranges_from_json(data["ranges"], leg.joint_names),
        model_error=record(ModelError, data["model_error"]) if data["model_error"] else None,
        cutoff_source=str(data["cutoff_source"]),
        torque_delays=_by_name(data["torque_delays"], leg.joint_names),
        actuators=None
        if data["actuators"] is None
        else actuators_from_data(data["actuators"], leg, transmissions=False),
        supports=records(Support, data.get("supports", [])),
        torque_spread=_by_name(data["torque_spread"], leg.joint_names),
    )


def _prior_knowledge(data: Mapping[str, Any], model: TorqueModel) -> PriorKnowledge:
    """Read what was known beside the recordings."""
    prior = Prior({name: tuple(pair) for name, pair in data["prior"].items()})
    prior_knowledge = PriorKnowledge(data["known"], prior, bool(data["nonnegative"]))
    prior_knowledge.check(model)
    return prior_knowledge


def _shapes_to_json(nonlinear: NonlinearParameters, dof: float) -> dict[str, Any]:
    return {
        "values": dict(zip(nonlinear.names, nonlinear.values.tolist(), strict=True)),
        "std": dict(zip(nonlinear.names, nonlinear.std.tolist(), strict=True)),
        "interval_95": dict(zip(nonlinear.names, nonlinear.interval(dof).tolist(), strict=True)),
        "units": dict(zip(nonlinear.names, nonlinear.units, strict=True)),
        "determined": dict(zip(nonlinear.names, nonlinear.identifiability, strict=True)),
        "held": list(nonlinear.held),
        "covariance": nonlinear.covariance.tolist(),
    }


def _shapes(data: Mapping[str, Any]) -> NonlinearParameters:
    """Read nonlinear parameters, if there are any."""
    if not data:
        return NonlinearParameters()
    names, units = tuple(data["values"]), tuple(data["units"].values())
    return NonlinearParameters(
        names, units, np.array(list(data["values"].values())), data["covariance"], tuple(data["held"])
    )


def _by_name(data: Mapping[str, float], names: Sequence[str]) -> FloatArray:
    """Read a number of each parameter."""
    return np.array([data[name] for name in names], dtype=np.float64)


def _warnings(data: Sequence[str]) -> tuple[str, ...]:
    if not isinstance(data, list) or not all(isinstance(text, str) for text in data):
        raise UnreadableInputError("warnings are not a list of sentences", remedy="identify again and save")
    return tuple(data)
