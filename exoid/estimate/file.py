"""Estimates as JSON files: self-contained, versioned, exact to the last bit."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from exoid._typing import FloatArray
from exoid.actuators import Actuators, actuators_from_data, actuators_to_data
from exoid.errors import ExoidError
from exoid.leg.description import describe
from exoid.leg.leg import Leg
from exoid.regression.diagnostics import JointNoise
from exoid.regression.influence import influence_from_json, influence_to_json
from exoid.regression.parameters import Prior, PriorKnowledge
from exoid.regression.trends import trends_from_json, trends_to_json
from exoid.signals.preparation_names import preparation_from_json, preparation_to_json
from exoid.tools.files import refuse_content, write_whole
from exoid.torques import TorqueModel
from exoid.torques.catalog import term_from_json, term_to_json

from .data import EstimateData, Input
from .finding import findings_from_json, findings_to_json
from .model_error import model_error_from_json, model_error_to_json
from .motion_ranges import ranges_from_json, ranges_to_json
from .nonlinear import NonlinearParameters
from .support import supports_from_json, supports_to_json

SCHEMA = "exoid-estimate-1"

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
        raise ExoidError(f"cannot be read ({error.strerror or error})", where=str(path), remedy=remedy) from error
    except (ValueError, RecursionError) as error:  # not UTF-8, not JSON, a number of ten thousand digits
        raise ExoidError(f"not JSON ({error})", where=str(path), remedy="identify again and save") from error
    if not isinstance(data, dict) or data.get("schema") != SCHEMA:
        raise ExoidError(f"not an estimate of schema {SCHEMA!r}", where=str(path), remedy="identify again and save")
    try:
        return estimate_from_json(data, kind)
    except ExoidError as error:
        raise ExoidError(
            error.what, where=f"{path}, {error.where}".rstrip(", "), remedy=error.remedy, command=error.command
        ) from error
    except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError) as error:  # such as 10**400
        what = f"damaged: {type(error).__name__} {error}"
        raise ExoidError(what, where=str(path), remedy="identify again and save") from error


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
        "noise": {name: asdict(of_joint) for name, of_joint in zip(estimate.joint_names, estimate.noise, strict=False)},
        "sizes": dict(zip(estimate.names, np.asarray(estimate.parameter_scale).tolist(), strict=True)),
        "calm_sizes": dict(zip(estimate.names, estimate.reference_scale.tolist(), strict=True)),
        "collinearity": dict(zip(estimate.names, estimate.collinearity.tolist(), strict=True)),
        "determined": dict(zip(estimate.names, estimate.identifiability, strict=True)),
        "warnings": list(estimate.warnings),
        "findings": findings_to_json(estimate.findings),
        "ranges": ranges_to_json(estimate.ranges, estimate.joint_names),
        "model_error": model_error_to_json(estimate.model_error),
        "cutoff_source": estimate.cutoff_source,
        "torque_delays": dict(zip(estimate.joint_names, estimate.torque_delays.tolist(), strict=True)),
        "actuators": None if estimate.actuators is None else actuators_to_data(estimate.actuators),
        **({"supports": supports_to_json(estimate.supports)} if estimate.supports else {}),
        "known": dict(estimate.prior_knowledge.known),
        "prior": {name: list(pair) for name, pair in estimate.prior_knowledge.prior.values.items()},
        "prior_gains": estimate.prior_gains.tolist(),
        "nonnegative": estimate.prior_knowledge.nonnegative,
        "bounded": list(estimate.bounded),
        "trends": trends_to_json(estimate.trends),
        "influence": influence_to_json(estimate.influence, estimate.names),
        "inputs": [_input_to_json(source) for source in estimate.inputs],
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
        raise ExoidError("the URDF inside is not the one identified: its hash differs", remedy="identify again")
    terms = tuple(term_from_json(term) for term in data["terms"])
    model = TorqueModel(leg, terms, separate=tuple(data["values"]))
    if tuple(data["values"]) != model.names:
        raise ExoidError(f"values {', '.join(data['values'])} do not fit the parameters {', '.join(model.names)}")
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
        inputs=tuple(_input(**source) for source in data["inputs"]),
        noise=_noise(data["noise"], leg.joint_names),
        parameter_scale=_by_name(data["sizes"], model.names),
        warnings=_warnings(data["warnings"]),
        prior_knowledge=_prior_knowledge(data, model),
        bounded=tuple(str(name) for name in data["bounded"]),
        trends=trends_from_json(data["trends"]),
        influence=influence_from_json(data["influence"], model.names),
        nonlinear=_shapes(data["shapes"]),
        dof_each=_by_name(data["degrees_of_freedom_each"], model.names),
        reference_scale=_by_name(data["calm_sizes"], model.names),
        prior_gains=_prior_gains(data["prior_gains"]),
        collinearity=_by_name(data["collinearity"], model.names),
        findings=findings_from_json(data.get("findings", [])),  # files of exoid 0.1 have none
        ranges=ranges_from_json(data.get("ranges"), leg.joint_names),
        model_error=model_error_from_json(data.get("model_error"), leg.joint_names, model.names),
        cutoff_source=str(data.get("cutoff_source", "")),
        torque_delays=_by_name(data.get("torque_delays", dict.fromkeys(leg.joint_names, 0.0)), leg.joint_names),
        actuators=_actuators(data.get("actuators"), leg),
        supports=supports_from_json(data.get("supports", [])),
        torque_spread=_by_name(data.get("torque_spread", dict.fromkeys(leg.joint_names, 0.0)), leg.joint_names),
    )


def _actuators(data: Any, leg: Leg) -> Actuators | None:  # noqa: ANN401 - as JSON holds it
    """Read the drives, if there are any; they are complete without the URDF's transmissions."""
    return None if data is None else actuators_from_data(data, leg, transmissions=False)


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


def _noise(data: Mapping[str, Any], joints: Sequence[str]) -> tuple[JointNoise, ...]:
    """Read the noise of the joints, if there is any."""
    return tuple(_joint_noise(**data[name]) for name in joints) if data else ()


def _joint_noise(
    samples: int, effective_samples: float, order: int, correlation: float, whiteness: float
) -> JointNoise:
    """Make numbers of what a file says are some."""
    return JointNoise(int(samples), float(effective_samples), int(order), float(correlation), float(whiteness))


def _input(
    name: str,
    sha256: str,
    samples: int,
    sample_rate: float,
    segments: Sequence[Sequence[float]] = (),
    payloads: Sequence[str] = (),
    moving_base: bool = False,
) -> Input:
    """As for the noise."""
    pairs = tuple((float(start), float(stop)) for start, stop in segments)
    return Input(
        str(name), str(sha256), int(samples), float(sample_rate), pairs, tuple(map(str, payloads)), bool(moving_base)
    )


def _input_to_json(source: Input) -> dict[str, Any]:
    """Describe a recording, and its segments, payloads and moving base if it has any."""
    optional = ("segments", "payloads", "moving_base")
    return {key: value for key, value in asdict(source).items() if value or key not in optional}


def _by_name(data: Mapping[str, float], names: Sequence[str]) -> FloatArray:
    """Read a number of each parameter."""
    return np.array([data[name] for name in names], dtype=np.float64)


def _prior_gains(data: Sequence[Sequence[float]]) -> FloatArray:
    """Read how far parameters follow priors; empty where that is not known."""
    return np.array(data, dtype=np.float64) if np.size(data) else np.zeros((0, 0))


def _warnings(data: Sequence[str]) -> tuple[str, ...]:
    if not isinstance(data, list) or not all(isinstance(text, str) for text in data):
        raise ExoidError("warnings are not a list of sentences", remedy="identify again and save")
    return tuple(data)
