"""Report of a replay of document 2: its findings, figures 3 and 6, and Tables II and III."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from exoid.experiments import healthy_gait
from exoid.tools.json_values import attributes, json_value
from exoid.tools.tables import DataTable
from exoid.view.colours import IDENTIFIED
from exoid.view.experiments import plot_reference, plot_torques

from .cuhk import J2_FACTOR, CuhkReplay
from .report import LABELS, Drawing, ReplayReport, errors_table, estimate_cells, estimate_json
from .torque_error import joint_errors

JOINTS = ("hip", "knee")


def cuhk_report(replay: CuhkReplay) -> ReplayReport:
    """Report a replay of document 2: findings, torque errors, parameters and figures.

    Args:
        replay: Replay of document 2.

    Returns:
        The report.
    """
    return ReplayReport(
        title=f"CUHK-EXO, document 2 replayed (seed {replay.seed})",
        about="The experiments of document 2 and a faster motion on a virtual rig with known parameters.",
        findings=[_findings(replay)],
        tables=[errors_table("an independent motion", replay.nrmse, JOINTS), _parameters(replay)],
        data={
            "truth": dict(replay.truth),
            "table_ii": estimate_json(replay.table_ii),
            "table_ii_zero_phase": estimate_json(replay.table_ii_zero_phase),
            "multisine": estimate_json(replay.multisine, "condition_number"),
            "no_rotor": estimate_json(replay.no_rotor, "condition_number"),
            "blindness": json_value(replay.residual_ratio),
            **attributes(replay, "nrmse", "seed"),
        },
        drawings={
            "doc2_fig3_validation": Drawing(
                "Fig. 3: measured and predicted torque of the validation motion",
                lambda figure: _draw_validation(figure, replay),
                height=1.1,
            ),
            "doc2_fig6_reference": Drawing("Fig. 6: hip and knee angles of two strides", _draw_gait),
        },
    )


def _findings(replay: CuhkReplay) -> list[str]:
    """Compare both estimates, and explain the errors of document 2's procedure."""
    error = 100.0 * (replay.table_ii.as_dict()["J1"] / replay.truth["J1"] - 1.0)
    inertial = np.deg2rad(20.0) * (0.1 * np.pi) ** 2 * replay.truth["J1"]  # largest in row 3 of Table II [N·m]
    return [
        f"On an independent motion the NRMSE falls from {joint_errors(replay.nrmse['table_ii'])} (hip / knee) by the "
        f"document's procedure to {joint_errors(replay.nrmse['multisine'])} by one estimate from a multisine.",
        f"J1 of Table II is {error:+.0f} % off: at 0.05 Hz its torque is {inertial:.2f} N·m beside "
        f"{9.81 * replay.truth['X1']:.0f} N·m of gravity, and the moving average adds delay.",
        f"Without the rotor term the NRMSE of the knee rises from {replay.nrmse['multisine'][1]:.3f} to "
        f"{replay.nrmse['no_rotor'][1]:.3f}: motor torque needs Ia_knee in the model.",
        f"With J2 × {J2_FACTOR:g} the residual of the document's validation motion (θh = θk) is "
        f"{replay.residual_ratio['document'].max():.2f} times as large, that of an independent motion "
        f"{replay.residual_ratio['multisine'].min():.0f} times: the validation motion does not excite J2.",
        "J1 includes the rotor of the hip, as no motion separates the two.",
    ]


def _parameters(replay: CuhkReplay) -> DataTable:
    """Make a table of the parameters of Table III (doc. 2): truth of the rig and estimates."""
    delayed, plain = replay.table_ii.as_dict(), replay.table_ii_zero_phase.as_dict()
    rows = [
        (
            name,
            replay.multisine[name].unit,
            f"{true:.4g}",
            *((f"{delayed[name]:.4g}", f"{delayed[name] - true:+.3g}") if name in delayed else ("–", "–")),
            f"{plain[name]:.4g}" if name in plain else "–",
            *estimate_cells(replay.multisine, name, true),
        )
        for name, true in replay.truth.items()
    ]
    document = LABELS["table_ii"]
    headers = ("parameter", "unit", "truth", document, "error", f"{document}, no lag", "multisine", "± std", "error")
    return DataTable("CUHK-EXO, Tables II and III: truth of the rig and estimates", headers, rows)


def _draw_validation(figure: Figure, replay: CuhkReplay) -> None:
    time = np.arange(len(replay.measured)) / replay.validation.sample_rate
    shown = time < 16.0  # a period is 20 s; more would hide the noise
    identified = ("multisine estimate", replay.predicted[shown], IDENTIFIED)
    axes = figure.subplots(2, 1, sharex=True)
    plot_torques(axes, time[shown], replay.measured[shown], [identified], JOINTS)


def _draw_gait(figure: Figure) -> None:
    motion, time = healthy_gait(), np.linspace(0.0, 20.0, 600)
    q = np.array([motion.at(t).q[:, 0] for t in time])
    plot_reference(figure.add_subplot(), time, q, JOINTS)
