"""What a controller may know of a worn leg: its CAD model, an identified model, and the truth."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from exoid.control import ControlModel
from exoid.errors import BadArgumentError
from exoid.estimate import Estimate
from exoid.lab.stability.draws import draw_truths
from exoid.leg.catalog import load_leg
from exoid.leg.leg import Leg
from exoid.leg.published import cuhk_cad_parameters
from exoid.rig import Plant

from .bleex import identify_bleex
from .bleex_measurements import truth_values
from .cuhk import identify_cuhk, truth_with_rotor


class WornModels(NamedTuple):
    """Three models of one leg."""

    cad: Leg  # CAD model, without friction, springs and rotors
    identified: Estimate  # identified model
    truth: Plant  # the true leg, without end stops


def worn_models(source: str | Estimate | WornModels, seed: int, progress: Callable[[float], None]) -> WornModels:
    """Provide CAD, identified model and true leg."""
    # * "bleex": the rig and the joint estimate of the document's replay; CAD is Table V.
    # * "cuhk": the rig of the document's replay and the estimate from a multisine; CAD is
    #   `exoid.leg.published.cuhk_cad_parameters`.
    # * An estimate: the rig is drawn from its distribution, CAD is its URDF.
    # * Models: they are taken as they are.
    if isinstance(source, WornModels):
        return source
    if isinstance(source, Estimate):
        drawn, _ = draw_truths(source.model.loaded_by(source.values), source.values, source.covariance, 1, seed)
        truth = ControlModel.of_parameters(source.model, drawn[0]).plant(end_stops=False)
        return WornModels(source.model.leg, source, truth)
    if source == "bleex":
        estimate = identify_bleex(seed, progress)
        cad = load_leg("bleex", side="left", inertias="cad")
        # The leg walks between its end stops.
        return WornModels(cad, estimate, Plant.build(estimate.model.leg, truth_values("left"), end_stops=False))
    if source == "cuhk":
        estimate, design = identify_cuhk(seed, progress), cuhk_cad_parameters()
        leg = load_leg("cuhk")
        cad = leg.with_parameters([design[name] for name in leg.parameter_names])
        return WornModels(cad, estimate, Plant.build(estimate.model.leg, truth_with_rotor(), end_stops=False))
    raise BadArgumentError(f"nobody wears {source!r}", remedy="name bleex or cuhk, or give an estimate")
