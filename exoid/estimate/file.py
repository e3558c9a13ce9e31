"""Estimates as JSON files: self-contained, versioned, exact to the last bit."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import fields
from typing import Any, TypeVar

import numpy as np

from exoid.actuators.drive_data import actuators_from_data, actuators_to_data
from exoid.errors import ExoidError, UnreadableInputError
from exoid.leg.description import describe
from exoid.leg.leg import Leg
from exoid.leg.loops import Loops
from exoid.regression.parameters import Prior, PriorKnowledge
from exoid.signals.preparation import preparation_from_json, preparation_to_json
from exoid.tools.files import read_json
from exoid.tools.json_values import json_value, named, record, records
from exoid.torques import TorqueModel
from exoid.torques.catalog import TERMS

from .data import EstimateData, Input
from .evidence import Evidence
from .finding import Finding
from .model_error import ModelError
from .nonlinear import NonlinearParameters
from .text import numbers_to_json

SCHEMA = "exoid-estimate-2"

OPTIONAL = ("segments", "payloads", "moving_base", "wrenches", "passive")
"""Keys of a recording that are left out of a file where there is nothing to say."""

WRITTEN = "give the file that exoid identify -o wrote; it stands before the logs"
"""Remedy for a file that is no estimate."""

E = TypeVar("E", bound=EstimateData)


def estimate_text(estimate: EstimateData) -> str:
    """Write what :func:`read_estimate` reads."""
    return json.dumps(estimate_to_json(estimate), indent=1, ensure_ascii=False) + "\n"


def read_estimate(path: str | os.PathLike[str], kind: type[E]) -> E:
    """Read an estimate; see :meth:`Estimate.load`."""
    data = read_json(path, "estimate", SCHEMA, WRITTEN)
    try:
        return estimate_from_json(data, kind)
    except ExoidError as error:
        raise error.within(str(path)) from error
    except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError) as error:  # such as 10**400
        what = f"damaged: {type(error).__name__} {error}"
        raise UnreadableInputError(what, where=str(path), remedy="identify again and save") from error


def estimate_to_json(estimate: EstimateData) -> dict[str, Any]:
    """Turn an estimate into what JSON can hold, values by name."""
    model, leg, nonlinear = estimate.model, estimate.model.leg, estimate.nonlinear
    return {
        "schema": SCHEMA,
        **numbers_to_json(estimate, estimate.interval()),
        "condition_number": estimate.condition_number,
        "evidence": json_value(estimate.evidence),
        "degrees_of_freedom": estimate.dof,
        "residual_rms": named(estimate.joint_names, estimate.residual_rms),
        "merged": {regrouped.name: regrouped.into for regrouped in estimate.regrouped},
        "estimator": estimate.estimator,
        "preparation": preparation_to_json(estimate.preparation),
        "warnings": list(estimate.warnings),
        "findings": json_value(estimate.findings),
        "model_error": {} if estimate.model_error is None else json_value(estimate.model_error),
        "torque_delays": named(estimate.joint_names, estimate.torque_delays),
        "actuators": None if estimate.actuators is None else actuators_to_data(estimate.actuators),
        "known": dict(estimate.prior_knowledge.known),
        "prior": {name: list(pair) for name, pair in estimate.prior_knowledge.prior.values.items()},
        "nonnegative": estimate.prior_knowledge.nonnegative,
        "inputs": [
            {key: value for key, value in json_value(source).items() if value or key not in OPTIONAL}
            for source in estimate.inputs
        ],
        **({"columns": dict(estimate.columns)} if estimate.columns else {}),
        "shapes": {
            **numbers_to_json(nonlinear, nonlinear.interval(estimate.dof)),
            "held": list(nonlinear.held),
            "covariance": nonlinear.covariance.tolist(),
        }
        if nonlinear.names
        else {},
        "terms": [TERMS.to_json(term) for term in model.terms],
        "leg": {
            "name": leg.description.name,
            "sha256": leg.description.sha256,
            "joints": list(leg.joint_names),
            "locked": dict(leg.locked),
            "cumulative": leg.cumulative,
            **({"base": leg.base} if leg.base != "fixed" else {}),
            **({"contacts": dict(leg.contacts)} if leg.contacts else {}),
            **({"loops": json_value(leg.closure.loops)} if leg.closure else {}),
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
        contacts=about.get("contacts"),
        loops=Loops.from_data(about["loops"]) if "loops" in about else None,
    )
    if leg.description.sha256 != about["sha256"]:
        what = "the URDF inside is not the one identified: its hash differs"
        raise UnreadableInputError(what, remedy="identify again")
    if not isinstance(data["warnings"], list) or not all(isinstance(text, str) for text in data["warnings"]):
        raise UnreadableInputError("warnings are not a list of sentences", remedy="identify again and save")
    terms = tuple(TERMS.from_json(term) for term in data["terms"])
    model = TorqueModel(leg, terms, separate=tuple(data["values"]))
    if tuple(data["values"]) != model.names:
        raise UnreadableInputError(
            f"values {', '.join(data['values'])} do not fit the parameters {', '.join(model.names)}"
        )
    values = np.array(list(data["values"].values()), dtype=np.float64)
    prior = Prior({name: tuple(pair) for name, pair in data["prior"].items()})
    knowledge = PriorKnowledge(data["known"], prior, bool(data["nonnegative"]))
    knowledge.check(model)
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
        warnings=tuple(data["warnings"]),
        prior_knowledge=knowledge,
        nonlinear=_shapes(data["shapes"]),
        findings=records(Finding, data["findings"]),
        model_error=record(ModelError, data["model_error"]) if data["model_error"] else None,
        torque_delays=np.array([data["torque_delays"][name] for name in leg.joint_names], dtype=np.float64),
        actuators=None if data["actuators"] is None else actuators_from_data(data["actuators"], leg),
        columns=data.get("columns", {}),
        evidence=record(Evidence, {field.name: data["evidence"][field.name] for field in fields(Evidence)}),
    )


def _shapes(data: Mapping[str, Any]) -> NonlinearParameters:
    """Read nonlinear parameters, if there are any."""
    if not data:
        return NonlinearParameters()
    names, units = tuple(data["values"]), tuple(data["units"].values())
    return NonlinearParameters(
        names, units, np.array(list(data["values"].values())), data["covariance"], tuple(data["held"])
    )
