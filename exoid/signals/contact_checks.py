"""Checks of contacts against the wrenches on the same links."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from exoid._typing import BoolArray, FloatArray
from exoid.errors import UnreadableInputError

from .wrench import Wrench


def refuse_contradictions(
    time: FloatArray, wrenches: Mapping[str, Wrench], contacts: Mapping[str, BoolArray], where: str = ""
) -> None:
    """Refuse contacts that contradict the wrench on the same link.

    It is meant for whole logs, and readers of files call it: in a short slice around one mislabelled step the contact
    may really be wrong.

    Args:
        time: Time stamps [s], (N,).
        wrenches: Wrenches by link.
        contacts: Contacts by link, (N,) each.
        where: Name of the file.

    Raises:
        ExoidError: A contact is inverted or never there while the link is loaded, or the force is in kN.
    """
    interval = float(np.median(np.diff(time)))
    for link, contact in contacts.items():
        if link in wrenches:
            force = np.linalg.norm(wrenches[link].force, axis=1)
            _refuse_contradiction(link, contact, force, interval, where)


def _refuse_contradiction(link: str, contact: BoolArray, force: FloatArray, interval: float, where: str) -> None:
    # A link is certainly loaded beyond 50 N, and nobody stands on it below a median of 5 N. A load of less than 1 s
    # without any contact may be touch-down and lift-off.
    with_contact = float(np.median(force[contact])) if contact.any() else np.nan
    without = float(np.median(force[~contact])) if not contact.all() else np.nan
    missed = np.count_nonzero(force > 50.0) * interval
    if not contact.any() and missed > 1.0:
        raise UnreadableInputError(
            f"the contact of {link} is never 1, and its wrench exceeds 50 N for {missed:.3g} s",
            where=where,
            remedy=f"check the foot switch, or find the contact by exoid.signals.contacts_from_wrench of {link}",
        )
    if without > 50.0 and with_contact < 0.2 * without:
        raise UnreadableInputError(
            f"the contact of {link} is inverted: its wrench has {with_contact:.3g} N (median) where it is 1, and "
            f"{without:.3g} N where it is 0",
            where=where,
            remedy="invert it: contacts={...: ~contact}",
            command=f"invert it: --column contact_{link}=HEADER:-1:1",
        )
    if with_contact < 5.0:
        raise UnreadableInputError(
            f"the wrench on {link} has {with_contact:.3g} N (median) while it is in contact: its force looks like kN",
            where=where,
            remedy="give forces in N and moments in N·m; or leave out the contact of a link that is not loaded",
            command=f"give its unit: --column wrench_{link}_fx=HEADER:kN, and so for the others",
        )
