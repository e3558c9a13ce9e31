"""The one call from a leg and recordings to findings: mistakes of logs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from exoid.errors import ExoidError
from exoid.estimate.finding import Finding, ordered
from exoid.leg.leg import Leg
from exoid.regression.parameters import PriorKnowledge
from exoid.signals import Poses, Recording
from exoid.torques import Term

from .drives import Drives
from .estimators import wls
from .findings.checkup import signal_findings
from .gather import begin
from .group_rows import check_recordings
from .identify import identify


def check(
    leg: Leg,
    recordings: Recording | Poses | Iterable[Recording | Poses],
    terms: Sequence[Term] | None = None,
    *,
    cutoff: float | None = None,
    known: Mapping[str, float] | None = None,
    actuators: Drives | None = None,
) -> tuple[Finding, ...]:
    """Check logs for the mistakes that real logs have: the findings of :func:`exoid.identify`.

    Channels are checked first, then the residuals of a fit. ``docs/checks.md`` lists all kinds of findings.

    Args:
        leg: The leg.
        recordings: One recording or several of the same leg, with torques.
        terms: Terms besides rigid-body dynamics; None for those of :func:`exoid.identify`.
        cutoff: Cut-off frequency of the parallel filter [Hz]; None to choose it.
        known: Parameters that are known, by name.
        actuators: Drives of the recordings, as for :func:`exoid.identify`; None for torques.

    Returns:
        Findings, the worst first; empty where nothing was found. A log that nothing can be identified from has the
        finding "not-identifiable".

    Raises:
        ExoidError: There is no recording, or a joint of the leg is not in it.

    Example:
        >>> data = exoid.datasets.bleex_swing()
        >>> exoid.check(data.leg, data.train)
        ()
    """
    data = check_recordings(recordings)
    try:
        return identify(leg, data, terms, cutoff=cutoff, known=known, actuators=actuators).findings
    except ExoidError as error:
        # what is wrong with the drives is no finding of the log, and raises here
        (group,) = begin(leg, data, terms, wls, PriorKnowledge(known or {}), actuators=actuators).groups
        names = group.model.names
        refused = Finding("not-identifiable", "", 1.0, "1", "error", error.what, error.remedy, parameters=names)
        return ordered((*signal_findings(group.model, group.data), refused))
