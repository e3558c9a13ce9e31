"""Advice in the report of an identification: which parameters need more data, and what to record."""

from __future__ import annotations

from collections.abc import Container, Iterator, Sequence

import numpy as np

from exoid.errors import ExoidError
from exoid.estimate import Estimate
from exoid.experiments.excitation import assess
from exoid.signals import Recording
from exoid.tools.tables import with_error

from .page import Text
from .text import IDENTIFIABILITY, sentence

POOR = ("weakly", "not")
"""Classes of identifiability that more recordings would improve."""

NOTE = (
    "Experiments that would help. Percentages are the expected standard deviation over the scale of the parameter: its "
    "value, or a tenth of the value that alone would explain all torque of a joint. They assume noise such as the "
    "residuals, and no prior knowledge."
)
"""Text above the list of experiments."""


DEAF = 1e6
"""Noise of a joint whose torque was not measured, over the largest residual."""


def advice(estimate: Estimate, recordings: Sequence[Recording]) -> Iterator[Text]:
    """Name poorly identified parameters, the parameters that they correlate with, and what to record."""
    correlation = np.abs(estimate.correlation - np.eye(len(estimate.names)))
    poor = {name: grade for name, grade in zip(estimate.names, estimate.identifiability, strict=True) if grade in POOR}
    lines = []
    for name, grade in poor.items():
        k = estimate.names.index(name)
        partner = int(correlation[k].argmax())
        value, std = with_error(estimate.values[k], estimate.std[k])
        lines.append(
            f"{name} is {IDENTIFIABILITY[grade]} ({value} ± {std} {estimate.units[k]}); its error correlates most with "
            f"that of {estimate.names[partner]} (correlation {estimate.correlation[k, partner]:+.2f})."
        )
    lines += [f"{warning}." for warning in estimate.nonlinear.warnings]
    if not lines:
        yield Text(["Every parameter is well identified. Test the model on a held-out recording."])
        return
    yield Text(lines)
    if experiments := list(_experiments(estimate, recordings, poor)):
        yield Text([NOTE])
        yield Text(experiments)
    else:
        yield Text(["Record motions that separate the correlated parameters; exoid plan finds such motions."])


def _experiments(estimate: Estimate, recordings: Sequence[Recording], poor: Container[str]) -> Iterator[str]:
    """Assess simple experiments, with noise as large and as correlated as the residuals; none if that fails."""
    seconds = sum(recording.duration for recording in recordings)
    heard = [noise.effective_samples for noise in estimate.noise if noise.samples]
    counts = [count for count in heard if np.isfinite(count)]
    deaf = DEAF * float(estimate.residual_rms.max())  # a joint whose torque was not measured tells nothing
    try:
        assessment = assess(
            estimate.model.leg,
            recordings,
            estimate.model.terms,
            noise=np.where(estimate.trained, estimate.residual_rms, deaf),
            noise_bandwidth=min(counts) / seconds / 2.0 if counts else np.inf,
            values=dict(zip(estimate.names, estimate.values.tolist(), strict=True)),
            preparation=estimate.preparation,
        )
    except ExoidError:  # for example no range of motion within the limits: the rest of the report is still valid
        return
    for each in assessment.advice:
        helped = [k for k, name in enumerate(each.parameters) if name in poor]
        if helped:
            part = each._replace(
                parameters=tuple(each.parameters[k] for k in helped),
                before=tuple(each.before[k] for k in helped),
                after=tuple(each.after[k] for k in helped),
            )
            yield sentence(str(part))
