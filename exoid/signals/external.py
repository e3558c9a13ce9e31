"""Wrenches and contacts of a recording: what the surroundings do to the links, link by link."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NoReturn, TypeVar

import numpy as np

from exoid._typing import BoolArray, FloatArray
from exoid.errors import BadArgumentError, UnreadableInputError

from . import checks
from .wrench import Wrench

V = TypeVar("V")
LEAST = 5.0  # a foot that bears less is not on the ground, or its force is in kN [N]


class ReadOnlyDict(dict[str, V]):
    """Read-only dictionary, such as of wrenches by link, which pickle can send to other processes."""

    __slots__ = ()

    def _refuse(self, *_: object, **__: object) -> NoReturn:
        """Refuse a change."""
        raise TypeError("it cannot be changed; use dataclasses.replace")

    __setitem__ = __delitem__ = __ior__ = update = pop = popitem = clear = setdefault = _refuse

    def __reduce__(self) -> tuple[type[ReadOnlyDict[V]], tuple[dict[str, V]]]:
        """Pickle as a call of the constructor, as items cannot be set."""
        return type(self), (dict(self),)


def as_external(wrenches: Any, contacts: Any, samples: int) -> dict[str, Any]:  # noqa: ANN401 - not yet checked
    """Check and freeze wrenches and contacts."""
    measured = _mapping(wrenches, "wrenches", '{"left_foot": exoid.Wrench(...)}')
    for link, wrench in measured.items():
        if not isinstance(wrench, Wrench):
            raise BadArgumentError(
                f"the wrench on {link} is of type {type(wrench).__name__}", remedy="pass exoid.Wrench(force, moment)"
            )
        checks.refuse_shape(wrench.force, (samples, 3), f"the wrench on {link}")
    touching = {
        link: checks.as_mask(values, f"the contact of {link}")
        for link, values in _mapping(contacts, "contacts", '{"left_foot": bools}').items()
    }
    for link, contact in touching.items():
        checks.refuse_shape(contact, (samples,), f"the contact of {link}")
    return {"wrenches": ReadOnlyDict(measured), "contacts": ReadOnlyDict(touching)}


def refuse_world_axes_without_pose(wrenches: Mapping[str, Wrench], has_pose: bool) -> None:
    """Refuse wrenches in axes of the laboratory where nothing says how the base stands in it."""
    for link, wrench in wrenches.items():
        if wrench.axes == "world" and not has_pose:
            raise BadArgumentError(
                f"the wrench on {link} is in axes of the laboratory, and an IMU does not give the pose of the base",
                remedy="record the pose, BaseMotion.from_pose(...) or from_imu(..., pose=BasePose(...)), or give the "
                'wrench in axes of the link (axes="link")',
                command="add the columns base_x…z, base_qx…w of a pose, or give the wrench in axes of the link",
            )


def _mapping(values: Any, argument: str, example: str) -> dict[str, Any]:  # noqa: ANN401
    """Check the names of links."""
    if values is None:
        return {}
    if not isinstance(values, Mapping):
        raise BadArgumentError(f"{argument} is of type {type(values).__name__}", remedy=f"pass {argument}={example}")
    checks.refuse_names(tuple(values), "link")
    return dict(values)


def refuse_contradictions(time: FloatArray, wrenches: Mapping[str, Wrench], contacts: Mapping[str, BoolArray]) -> None:
    """Refuse contacts that contradict the wrench on the same link: inverted, never there under load, force in kN."""
    # Only for whole logs: in a short slice around one mislabelled step the contact may really be wrong.
    # A link is certainly loaded beyond 50 N, and nobody stands on it below a median of 5 N. A load of less than 1 s
    # without any contact may be touch-down and lift-off.
    for link in (link for link in contacts if link in wrenches):
        contact, force = contacts[link], np.linalg.norm(wrenches[link].force, axis=1)
        with_contact = float(np.median(force[contact])) if contact.any() else np.nan
        without = float(np.median(force[~contact])) if not contact.all() else np.nan
        missed = np.count_nonzero(force > 50.0) * float(np.median(np.diff(time)))
        if not contact.any() and missed > 1.0:
            raise UnreadableInputError(
                f"the contact of {link} is never 1, and its wrench exceeds 50 N for {missed:.3g} s",
                remedy=f"check the foot switch, or find the contact by exoid.signals.contacts_from_wrench of {link}",
            )
        if without > LEAST and with_contact < 0.2 * without:
            raise UnreadableInputError(
                f"the contact of {link} is inverted: its wrench has {with_contact:.3g} N (median) where it is 1, and "
                f"{without:.3g} N where it is 0",
                remedy="invert it: contacts={...: ~contact}",
                command=f"invert it: --column contact_{link}=HEADER:-1:1",
            )
        if with_contact < LEAST:
            raise UnreadableInputError(
                f"the wrench on {link} has {with_contact:.3g} N (median) while it is in contact: it looks like kN",
                remedy="give forces in N and moments in N·m; or leave out the contact of a link that is not loaded",
                command=f"give its unit: --column wrench_{link}_fx=HEADER:kN, and so for the others",
            )
