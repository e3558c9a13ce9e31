"""Replays as tables and as JSON."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from exoid._typing import FloatArray
from exoid.estimate import Estimate
from exoid.tools.tables import DataTable, to_text, with_error

from .bleex import BleexReplay, SideReplay
from .cuhk import J2_FACTOR, CuhkReplay
from .sequential import SequentialEstimate
from .torque_error import by_name, joint_errors

BLEEX_JOINTS = ("hip", "knee", "ankle")
CUHK_JOINTS = ("hip", "knee")


def bleex_text(replay: BleexReplay) -> str:
    """Print a replay of document 1: findings on both legs, then their tables.

    Args:
        replay: Replay of document 1.

    Returns:
        Text of several lines.
    """
    sides = (("Left", replay.left), ("Right", replay.right))
    findings = [
        part for name, side in sides for part in (f"{name} leg. {bleex_summary(side)}", *as_list(bleex_notes(side)), "")
    ]
    tables = [table for name, side in sides for table in (bleex_errors(side, name), bleex_parameters(name, side))]
    return to_text(*findings, *tables)


def as_list(lines: Sequence[str]) -> list[str]:
    """Mark lines as entries of a list."""
    return [f"- {line}" for line in lines]


def bleex_json(replay: BleexReplay) -> dict[str, Any]:
    """Convert a replay of document 1 to JSON types.

    Args:
        replay: Replay of document 1.

    Returns:
        Parameters and torque errors of both legs by name.
    """
    return {"left": _side_json(replay.left), "right": _side_json(replay.right), "seed": replay.seed}


def cuhk_text(replay: CuhkReplay) -> str:
    """Print a replay of document 2: findings, then torque errors and parameters.

    Args:
        replay: Replay of document 2.

    Returns:
        Text of several lines.
    """
    notes = as_list(cuhk_notes(replay))
    return to_text(cuhk_summary(replay), *notes, "", cuhk_errors(replay), cuhk_parameters(replay))


def cuhk_parameters(replay: CuhkReplay) -> DataTable:
    """Make a table of the parameters of Table III (doc. 2): truth of the rig and estimates."""
    ema, plain = replay.table_ii.as_dict(), replay.table_ii_zero_phase.as_dict()
    rows = [
        (
            name,
            f"{true:.4g}",
            _number(ema.get(name)),
            _error(ema.get(name), true),
            _number(plain.get(name)),
            *_estimate_cells(replay.multisine, name, true),
        )
        for name, true in replay.truth.items()
    ]
    headers = ("parameter", "truth", "Table II", "error", "no lag", "multisine", "± std", "error")
    return DataTable("CUHK-EXO, Tables II and III: truth of the rig and estimates", headers, rows)


def cuhk_errors(replay: CuhkReplay) -> DataTable:
    """Make a table of the torque error of each model on an independent multisine."""
    return _errors("an independent motion", replay.nrmse, CUHK_JOINTS)


def cuhk_summary(replay: CuhkReplay) -> str:
    """Say in one sentence how the errors of both estimates compare."""
    return (
        f"On an independent motion the NRMSE falls from {joint_errors(replay.nrmse['table_ii'])} (hip / knee) by the "
        f"document's procedure to {joint_errors(replay.nrmse['multisine'])} by one estimate from a multisine."
    )


def cuhk_notes(replay: CuhkReplay) -> list[str]:
    """Explain the errors of document 2's procedure."""
    ema = replay.table_ii.as_dict()
    error = 100.0 * (ema["J1"] / replay.truth["J1"] - 1.0)
    return [
        f"J1 of Table II is {error:+.0f} % off: at 0.05 Hz its torque is {_inertial_torque(replay):.2f} N·m beside "
        f"{9.81 * replay.truth['X1']:.0f} N·m of gravity, and the moving average adds delay.",
        f"Without the rotor term the NRMSE of the knee rises from {replay.nrmse['multisine'][1]:.3f} to "
        f"{replay.nrmse['no_rotor'][1]:.3f}: motor torque needs Ia_knee in the model.",
        f"With J2 × {J2_FACTOR:g} the residual of the document's validation motion (θh = θk) is "
        f"{replay.residual_ratio['document'].max():.2f} times as large, that of an independent motion "
        f"{replay.residual_ratio['multisine'].min():.0f} times: the validation motion does not excite J2.",
        "J1 includes the rotor of the hip, as no motion separates the two.",
    ]


def cuhk_json(replay: CuhkReplay) -> dict[str, Any]:
    """Convert a replay of document 2 to JSON types.

    Args:
        replay: Replay of document 2.

    Returns:
        Parameters, torque errors and residual ratios ("blindness") by name.
    """
    return {
        "truth": dict(replay.truth),
        "table_ii": _sequential_json(replay.table_ii),
        "table_ii_zero_phase": _sequential_json(replay.table_ii_zero_phase),
        "multisine": _estimate_json(replay.multisine),
        "no_rotor": _estimate_json(replay.no_rotor),
        "nrmse": _lists(replay.nrmse),
        "blindness": _lists(replay.residual_ratio),
        "seed": replay.seed,
    }


def bleex_parameters(title: str, side: SideReplay) -> DataTable:
    """Make a table of the parameters of Tables I to V (doc. 1): truth of the rig, estimates and CAD."""
    sequential, std = side.sequential.as_dict(), side.sequential.std_as_dict()
    rows = [
        (
            name,
            f"{true:.4g}",
            *(with_error(sequential[name], std[name]) if name in sequential else ("0", "–")),
            _error(sequential.get(name, 0.0), true),
            *_estimate_cells(side.joint, name, true),
            _number(side.cad.get(name)),
        )
        for name, true in side.truth.items()
    ]
    headers = ("parameter", "truth", "document's", "± std", "error", "joint", "± std", "error", "CAD")
    caption = f"{title} leg, Tables I to V: truth of the rig, the document's sequential estimate, one joint estimate"
    return DataTable(caption, headers, rows)


def bleex_errors(side: SideReplay, title: str = "") -> DataTable:
    """Make a table of the torque error of each model on document 1's validation motion."""
    of_side = f", {title.lower()} leg" if title else ""
    return _errors(f"the validation motion (Fig. 7){of_side}", side.nrmse, BLEEX_JOINTS)


def bleex_summary(side: SideReplay) -> str:
    """Say in one sentence how the errors of CAD and both estimates compare."""
    return (
        f"On the validation motion the NRMSE (hip / knee / ankle) is {joint_errors(side.nrmse['cad'])} with CAD, "
        f"{joint_errors(side.nrmse['sequential'])} by the document's procedure, and "
        f"{joint_errors(side.nrmse['joint'])} by one joint estimate."
    )


def bleex_notes(side: SideReplay) -> list[str]:
    """Explain the errors of document 1's procedure."""
    truth, sequential = side.truth, side.sequential.as_dict()
    one_sided, coarse = side.one_sided.as_dict(), side.coarse.as_dict()
    change = {name: one_sided[name] - sequential[name] for name in ("b0_knee", "b0_ankle")}

    def error(values: Mapping[str, float], name: str) -> str:
        """Relative error of a parameter in percent."""
        return f"{100.0 * (values[name] / truth[name] - 1.0):+.0f} %"

    return [
        f"J3 {error(sequential, 'J3')}: the held ankle sticks, and static friction balances the inertial torque.",
        f"X1 {error(sequential, 'X1')}: the hip has stiffness, but the document takes it as zero.",
        f"Without averaging A⁺ and A⁻, b0 of knee and ankle change by {change['b0_knee']:+.2f} and "
        f"{change['b0_ankle']:+.2f} N·m: they absorb the friction.",
        "With 2¹² counts a turn, the noise of second differences shrinks "
        f"J1 ({error(coarse, 'J1')}) and J2 ({error(coarse, 'J2')}).",
        f"Hip stiffness is not identifiable upright: condition number {side.upright_condition:.0f}, "
        f"with torso tilts {side.joint.condition_number:.0f}.",
    ]


def _side_json(side: SideReplay) -> dict[str, Any]:
    return {
        "truth": dict(side.truth),
        "sequential": _sequential_json(side.sequential),
        "joint": _estimate_json(side.joint),
        "cad": dict(side.cad),
        "nrmse": _lists(side.nrmse),
        "one_sided": _sequential_json(side.one_sided),
        "coarse_encoder": _sequential_json(side.coarse),
        "upright_condition_number": side.upright_condition,
    }


def _sequential_json(estimate: SequentialEstimate) -> dict[str, Any]:
    return {"values": estimate.as_dict(), "std": estimate.std_as_dict()}


def _estimate_json(estimate: Estimate) -> dict[str, Any]:
    return {
        "values": by_name(estimate),
        "std": dict(zip(estimate.names, estimate.std.tolist(), strict=True)),
        "condition_number": estimate.condition_number,
    }


def _lists(arrays: Mapping[str, FloatArray]) -> dict[str, list[float]]:
    return {name: np.asarray(array).tolist() for name, array in arrays.items()}


def _errors(motion: str, nrmse: Mapping[str, FloatArray], joints: Sequence[str]) -> DataTable:
    rows = [(name.replace("_", " "), *(f"{error:.4f}" for error in errors)) for name, errors in nrmse.items()]
    return DataTable(f"NRMSE of the torque on {motion}", ("model", *joints), rows)


def _estimate_cells(estimate: Estimate, name: str, true: float) -> tuple[str, ...]:
    """Value, standard deviation and error of a parameter."""
    if name not in estimate.names:
        return "–", "–", "–"
    value = estimate.value(name)
    return *with_error(value, float(estimate.std[estimate.names.index(name)])), _error(value, true)


def _number(value: float | None) -> str:
    return "–" if value is None else f"{value:.4g}"


def _error(value: float | None, true: float) -> str:
    return "–" if value is None else f"{value - true:+.3g}"


def _inertial_torque(replay: CuhkReplay) -> float:
    """Largest torque of J1 in row 3 of Table II [N·m]."""
    return float(np.deg2rad(20.0) * (0.1 * np.pi) ** 2 * replay.truth["J1"])
