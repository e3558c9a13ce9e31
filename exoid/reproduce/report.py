"""Replays as tables for people and as JSON for programs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from exoid._typing import FloatArray
from exoid.estimate import Estimate
from exoid.tables import DataTable, to_text, with_error

from .bleex import BleexReplay, SideReplay
from .cuhk import FIVEFOLD, CuhkReplay
from .sequential import Known
from .torque_error import by_name

BLEEX_JOINTS = ("hip", "knee", "ankle")
CUHK_JOINTS = ("hip", "knee")


def bleex_text(replay: BleexReplay) -> str:
    """Every table of document 1, side by side, and what the figures mean."""
    return "\n\n".join(
        to_text(bleex_parameters(name, side), bleex_errors(side), *bleex_notes(side))
        for name, side in (("Left", replay.left), ("Right", replay.right))
    )


def bleex_json(replay: BleexReplay) -> dict[str, Any]:
    """Figures of a replay of document 1 by name."""
    return {"left": _side_json(replay.left), "right": _side_json(replay.right), "seed": replay.seed}


def cuhk_text(replay: CuhkReplay) -> str:
    """Table III and the validation of document 2, and what the figures mean."""
    return to_text(cuhk_parameters(replay), cuhk_errors(replay), *cuhk_notes(replay))


def cuhk_parameters(replay: CuhkReplay) -> DataTable:
    """Table III of document 2 beside the rig's truth."""
    ema, plain = replay.table_ii.as_dict(), replay.table_ii_zero_phase.as_dict()
    rows = [
        (
            name,
            f"{true:.4g}",
            _number(ema.get(name)),
            _error(ema.get(name), true),
            _number(plain.get(name)),
            *_estimated(replay.multisine, name),
            _error(_value(replay.multisine, name), true),
        )
        for name, true in replay.truth.items()
    ]
    headers = ("parameter", "truth", "Table II", "error", "no lag", "multisine", "± std", "error")
    return DataTable("CUHK-EXO, Tables II and III: truth of the rig and what was identified", headers, rows)


def cuhk_errors(replay: CuhkReplay) -> DataTable:
    """How well each model predicts the torque of a motion that document 2 does not have."""
    return _errors("an independent motion", replay.nrmse, CUHK_JOINTS)


def cuhk_notes(replay: CuhkReplay) -> list[str]:
    """What the figures of document 2 mean."""
    ema = replay.table_ii.as_dict()
    wrong = 100.0 * (ema["J1"] / replay.truth["J1"] - 1.0)
    return [
        f"Table II's J1 is {wrong:+.0f} % off: at 0.05 Hz, J1 makes {_inertial_torque(replay):.2f} N·m beside "
        f"{9.81 * replay.truth['X1']:.0f} N·m of gravity, and the moving average is late.",
        f"Leaving the rotor out raises the knee's error from {100 * replay.nrmse['multisine'][1]:.1f} to "
        f"{100 * replay.nrmse['no_rotor'][1]:.1f} %: the torque was the motor's, so Ia_knee belongs to the model.",
        f"J2 × {FIVEFOLD:g} raises the residual of the document's validation motion (θh = θk) only "
        f"{replay.blindness['document'].max():.2f} ×, that of an independent motion "
        f"{replay.blindness['multisine'].min():.0f} ×: the former is blind to J2.",
        "J1 contains the hip's rotor, which no motion can tell from it.",
    ]


def cuhk_json(replay: CuhkReplay) -> dict[str, Any]:
    """Figures of a replay of document 2 by name."""
    return {
        "truth": dict(replay.truth),
        "table_ii": _known_json(replay.table_ii),
        "table_ii_zero_phase": _known_json(replay.table_ii_zero_phase),
        "multisine": _estimate_json(replay.multisine),
        "no_rotor": _estimate_json(replay.no_rotor),
        "nrmse": _lists(replay.nrmse),
        "blindness": _lists(replay.blindness),
        "seed": replay.seed,
    }


def bleex_parameters(title: str, side: SideReplay) -> DataTable:
    """Tables II to IV of document 1 beside the rig's truth."""
    sequential, std = side.sequential.as_dict(), side.sequential.std_as_dict()
    rows = [
        (
            name,
            f"{true:.4g}",
            *(with_error(sequential[name], std[name]) if name in sequential else ("0", "–")),
            _error(sequential.get(name, 0.0), true),
            *_estimated(side.joint, name),
            _error(_value(side.joint, name), true),
            _number(side.cad.get(name)),
        )
        for name, true in side.truth.items()
    ]
    headers = ("parameter", "truth", "document's", "± std", "error", "joint", "± std", "error", "CAD")
    caption = f"{title} leg, Tables I to V: truth of the rig, the document's sequential estimate, one joint estimate"
    return DataTable(caption, headers, rows)


def bleex_errors(side: SideReplay) -> DataTable:
    """How well each model predicts the torque of document 1's validation motion."""
    return _errors("the validation motion (Fig. 7)", side.nrmse, BLEEX_JOINTS)


def bleex_notes(side: SideReplay) -> list[str]:
    """Where the document's procedure goes wrong, and why."""
    truth, sequential = side.truth, side.sequential.as_dict()
    one_sided, coarse = side.one_sided.as_dict(), side.coarse.as_dict()
    moved = {name: one_sided[name] - sequential[name] for name in ("b0_knee", "b0_ankle")}

    def percent(values: Mapping[str, float], name: str) -> str:
        return f"{100.0 * (values[name] / truth[name] - 1.0):+.0f} %"

    return [
        f"J3 {percent(sequential, 'J3')}: the held ankle sticks, and its static friction carries what J3 should.",
        f"X1 {percent(sequential, 'X1')}: the hip's stiffness is there, though the document takes it as zero.",
        f"Without averaging A⁺ and A⁻, b0 of knee and ankle move by {moved['b0_knee']:+.2f} and "
        f"{moved['b0_ankle']:+.2f} N·m: they absorb the friction.",
        f"With 2¹² counts a turn, second differences drown J1 ({percent(coarse, 'J1')}), J2 ({percent(coarse, 'J2')}).",
        f"Hip stiffness is not identifiable upright: condition number {side.upright_condition:.0f}, "
        f"with torso tilts {side.joint.condition_number:.0f}.",
    ]


def _side_json(side: SideReplay) -> dict[str, Any]:
    return {
        "truth": dict(side.truth),
        "sequential": _known_json(side.sequential),
        "joint": _estimate_json(side.joint),
        "cad": dict(side.cad),
        "nrmse": _lists(side.nrmse),
        "one_sided": _known_json(side.one_sided),
        "coarse_encoder": _known_json(side.coarse),
        "upright_condition_number": side.upright_condition,
    }


def _known_json(known: Known) -> dict[str, Any]:
    return {"values": known.as_dict(), "std": known.std_as_dict()}


def _estimate_json(estimate: Estimate) -> dict[str, Any]:
    return {
        "values": by_name(estimate),
        "std": dict(zip(estimate.names, estimate.std.tolist(), strict=True)),
        "condition_number": estimate.condition_number,
    }


def _lists(arrays: Mapping[str, FloatArray]) -> dict[str, list[float]]:
    return {name: np.asarray(array).tolist() for name, array in arrays.items()}


def _errors(motion: str, nrmse: Mapping[str, FloatArray], joints: Sequence[str]) -> DataTable:
    rows = [(name.replace("_", " "), *(f"{100.0 * error:.1f}" for error in errors)) for name, errors in nrmse.items()]
    return DataTable(f"Torque error on {motion}, NRMSE in %", ("model", *joints), rows)


def _value(estimate: Estimate, name: str) -> float | None:
    return estimate.value(name) if name in estimate.names else None


def _estimated(estimate: Estimate, name: str) -> tuple[str, ...]:
    if name not in estimate.names:
        return "–", "–"
    return with_error(estimate.value(name), float(estimate.std[estimate.names.index(name)]))


def _number(value: float | None) -> str:
    return "–" if value is None else f"{value:.4g}"


def _error(value: float | None, true: float) -> str:
    return "–" if value is None else f"{value - true:+.3g}"


def _inertial_torque(replay: CuhkReplay) -> float:
    """Largest torque of J1 in row 3 of Table II [N·m]."""
    return float(np.deg2rad(20.0) * (0.1 * np.pi) ** 2 * replay.truth["J1"])
