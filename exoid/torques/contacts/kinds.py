"""Feet that rest on their heel, on their toe, or flat: a foot has links ``<foot>_heel`` and ``<foot>_toe`` then."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import BoolArray
from exoid.errors import BadArgumentError
from exoid.leg.leg import Leg
from exoid.leg.link_frames import link_frame
from exoid.signals import Recording
from exoid.signals.link_wrenches import link_placements


def foot_of(leg: Leg, link: str) -> str:
    """Foot whose heel or toe a link is; any other link is its own."""
    foot = link.removesuffix("_heel").removesuffix("_toe")
    edge = foot != link and leg.contact_kind(link) != "flat" and foot in leg.description.child_links.values()
    return foot if edge else link


def _by_foot(leg: Leg, links: Sequence[str]) -> dict[str, list[str]]:
    """Heel and toe of each foot among some links."""
    feet: dict[str, list[str]] = {}
    for link in links:
        foot = foot_of(leg, link)
        feet.setdefault(foot, []).extend([link] if link != foot else [])
    return feet


def whole_feet(leg: Leg, flags: Mapping[str, BoolArray]) -> dict[str, BoolArray]:
    """A foot on heel and toe is flat, and a flat foot rests on neither alone: no direction is held twice."""
    out = dict(flags)
    for foot, edges in _by_foot(leg, list(flags)).items():
        if edges:
            flat = sum(flags[edge].astype(int) for edge in edges) > 1
            out[foot] = flat = np.asarray(flat | flags[foot] if foot in flags else flat)
            out |= {edge: flags[edge] & ~flat for edge in edges}
    return out


def touch_downs(leg: Leg, rest: Mapping[str, BoolArray], samples: int, settling: int) -> BoolArray:
    """First samples of each foot on the ground, by whatever part of it, and those in which it settles."""
    found = np.zeros(samples, dtype=np.bool_)
    for foot, edges in _by_foot(leg, list(rest)).items():
        down = np.logical_or.reduce([rest[link] for link in (foot, *edges)])
        found |= down & np.diff(down, prepend=down[:1])
    return np.convolve(found, np.ones(1 + settling))[:samples] > 0.5


def on_time(leg: Leg, recording: Recording) -> tuple[Recording, dict[str, float]]:
    """Let contacts begin with the jolt of touch-downs where switches close after it; and how late they are [s]."""
    # Jolts are changes of the specific force, by their median over touch-downs after 0.1 s in the air. A late switch
    # has none where it closes. On time, jolts come within 6 ms of it, see tests/torques/contacts/test_heel_and_toe.py.
    # On a base that is held, or on a rail, the angles tell how fast a foot falls, and that it is at rest before.
    contacts, late, rate = dict(recording.contacts), dict[str, float](), recording.sample_rate
    if recording.base is None and leg.base_rows:
        return recording, late
    around = np.arange(-round(0.1 * rate), round(0.02 * rate) + 1)
    for foot, edges in _by_foot(leg, list(contacts)).items():
        links = [link for link in (foot, *edges) if link in contacts]
        down = np.logical_or.reduce([contacts[link] for link in links])
        starts = np.flatnonzero(down[1:] & ~down[:-1]) + 1
        starts = starts[(starts + around[0] > 0) & (starts + around[-1] < len(down))]
        starts = starts[~down[starts[:, np.newaxis] + around[around < 0]].any(axis=1)]
        if len(starts) < 4:  # too few to judge a switch by
            continue
        if leg.base_rows and recording.base is not None:
            force = recording.base.specific_force
            jolts = np.linalg.norm(np.diff(force, axis=0, prepend=np.nan), axis=1)
            size = np.median(jolts[starts[:, np.newaxis] + around], axis=0)
            first = -int(around[np.argmax(size)])
            sure = size.max() > max(1.5 * size[np.abs(around) <= 0.01 * rate].max(), 3.0 * np.median(size))
        else:
            height = link_placements(leg, recording.q, links[0]).translation @ leg.plane.up
            smooth = scipy.ndimage.uniform_filter1d(height, max(1, round(0.004 * rate)))
            size = np.median(np.abs(np.gradient(smooth, recording.time))[starts[:, np.newaxis] + around], axis=0)
            first = -int(around[np.flatnonzero((size > 0.5 * size.max()) & (around < 0))[-1:] + 1].sum())
            sure = size.max() > 0.1  # one that falls [m/s]
        if first >= 0.02 * rate and sure:
            late[foot] = first / rate
            contacts |= {link: np.convolve(contacts[link], np.ones(1 + first))[first:] > 0.5 for link in links}
    return replace(recording, contacts=contacts), late


def refuse_overdetermined(leg: Leg, recording: Recording) -> None:
    """Refuse a foot that is flat and on an edge at once, and one that more contacts hold than two points."""
    contacts, where = recording.contacts, recording.file_name
    for foot, edges in _by_foot(leg, list(contacts)).items():
        for edge in edges:
            both = int(np.count_nonzero(contacts[edge] & contacts[foot])) if foot in contacts else 0
            if both:
                what = f"{foot} rests flat and on {edge} at once, at {both} samples"
                remedy = f"say one of both; where {foot} is down by any switch, leave contact_{foot} out"
                raise BadArgumentError(what, where=where, remedy=remedy)
    if not leg.limbs:
        return
    held: dict[int, dict[str, BoolArray]] = {}
    for link, flags in contacts.items():
        held.setdefault(link_frame(leg.model, leg.description, link).body, {})[link] = flags
    for links in held.values():
        # in the plane a link has three directions; heel and toe hold four, one of which twice, and are flat together
        held_by = [(3 if leg.contact_kind(link) == "flat" else 2) * flags for link, flags in links.items()]
        if (np.sum(held_by, axis=0) > 4).any():
            what = f"contacts of {', '.join(links)} overdetermine one link of a planar leg"
            remedy = "give heel and toe alone, which say together that the foot is flat"
            raise BadArgumentError(what, where=where, remedy=remedy)
