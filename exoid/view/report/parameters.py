"""Parameters in the report of an identification: their table and figures, which need more data, and what to record."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from matplotlib.figure import Figure

from exoid.errors import ExoidError
from exoid.estimate import Estimate
from exoid.estimate.comparison import Comparison
from exoid.estimate.text import below_parameters, parameter_table
from exoid.experiments.excitation import assess
from exoid.experiments.excitation.assess import Advice
from exoid.signals import Recording
from exoid.view.parameters import STRONG, plot_comparison, plot_correlation, plot_parameters, strongest_pairs

from .blocks import sentence
from .page import Block, Picture, Text, on_axes, paper_figure

IDENTIFIABILITY = {
    "well": "well identified",
    "weakly": "weakly identified",
    "not": "not identified",
    "prior": "known mainly from the prior",
    "known": "fixed at a known value",
}
"""Text of each class of identifiability."""

EXPERIMENTS = (
    "Experiments that would help. Percentages are the expected standard deviation over the scale of the parameter: its "
    "value, or a tenth of the value that alone would explain all torque of a joint. They assume noise such as the "
    "residuals, and no prior knowledge."
)
"""Heading of the experiments."""


def parameter_blocks(estimate: Estimate) -> Iterator[Block]:
    """Draw parameters beside those of the URDF, those of each unit, and the strongest correlations."""
    leg = estimate.model.leg
    other_values = {"URDF": dict(zip(leg.parameter_names, leg.parameters.tolist(), strict=True))}
    caption = f"{estimate.estimator} estimate, condition number {estimate.condition_number:.1f}"
    yield parameter_table(estimate, caption)
    yield Text([sentence(line) for line in below_parameters(estimate)])
    for unit in dict.fromkeys(estimate.units):
        names = [name for name, its_unit in zip(estimate.names, estimate.units, strict=True) if its_unit == unit]
        yield Picture(
            on_axes(plot_parameters, estimate, names, other_values),
            f"Parameters in {unit} with 95 % intervals: {', '.join(names)}",
            f"Parameters in {unit} with 95 % intervals",
            "parameters",
            height=max(1.4, 0.6 + 0.23 * len(names)),
            across=2,
        )
    if pairs := strongest_pairs(estimate):
        yield Picture(
            on_axes(plot_correlation, estimate),
            "Correlation of the errors of pairs of parameters",
            f"Pairs whose errors correlate most; from ±{STRONG} on they are hard to separate",
            "correlation",
            height=max(1.4, 0.6 + 0.2 * len(pairs)),
        )


def comparison_figures(first: Estimate, second: Estimate, comparison: Comparison) -> dict[str, Figure]:
    """Draw the parameters of two estimates beside each other, with their differences.

    Args:
        first: An estimate.
        second: Another one.
        comparison: Their comparison (:func:`exoid.compare`).

    Returns:
        Figures of a paper by name, for :func:`exoid.view.write_figures`.
    """
    panels = [
        Picture(
            on_axes(plot_comparison, first, second, comparison, unit),
            f"Parameters in {unit} of both estimates with 95 % intervals",
            height=max(1.4, 0.6 + 0.3 * comparison.units.count(unit)),
            across=2,
        )
        for unit in dict.fromkeys(comparison.units)
    ]
    return {"comparison": paper_figure(panels)}


def advice(estimate: Estimate, recordings: Sequence[Recording]) -> Iterator[Text]:
    """Name poorly identified parameters, and simple experiments that would help."""
    grades = zip(estimate.names, estimate.identifiability, strict=True)
    poor = {name: grade for name, grade in grades if grade in ("weakly", "not")}
    if not poor:
        yield Text(["Every parameter is well identified; a held-out recording tests the model."])
        return
    for grade in dict.fromkeys(poor.values()):
        yield Text(
            [f"{IDENTIFIABILITY[grade].capitalize()}: {', '.join(n for n, its in poor.items() if its == grade)}."]
        )
    helping = [each for each in _experiments(estimate, recordings) if {*each.parameters} & {*poor}]
    yield Text([EXPERIMENTS if helping else "exoid plan finds motions that separate correlated parameters."])
    if helping:
        yield Text([sentence(str(each)) for each in helping])


def _experiments(estimate: Estimate, recordings: Sequence[Recording]) -> Sequence[Advice]:
    """Assess simple experiments, with noise as large and as correlated as the residuals; none if that fails."""
    seconds = sum(recording.duration for recording in recordings)
    heard = [noise.effective_samples for noise in estimate.noise if noise.samples]
    counts = [count for count in heard if np.isfinite(count)]
    deaf = 1e6 * float(estimate.residual_rms.max())  # a joint whose torque was not measured tells nothing
    try:
        return assess(
            estimate.model.leg,
            recordings,
            estimate.model.terms,
            noise=np.where(estimate.trained, estimate.residual_rms, deaf),
            noise_bandwidth=min(counts) / seconds / 2.0 if counts else np.inf,
            values=dict(zip(estimate.names, estimate.values.tolist(), strict=True)),
            preparation=estimate.preparation,
        ).advice
    except ExoidError:  # for example no range of motion within the limits: the rest of the report is still valid
        return ()
