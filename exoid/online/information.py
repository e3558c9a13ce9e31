"""Square-root information filter: R factors that take rows in by QR factorisation, and forget.

Information A = Rᵀ R is never formed. New rows Φ with torques y, and forgetting by a factor λ, give

    [R' z'] = QR of [√λ R  √λ z; Φ  y],

which solves the same least-squares problem as all rows at once (Bierman 1977).

Directional forgetting (Kulhavý and Kárný 1984, Bittanti et al. 1990) forgets only in directions that the new rows
excite. In coordinates x = R β the information is the unit matrix, and that of the rows is Gᵀ G with
G = Φ R⁻¹ = U S Vᵀ. The factor I − (1 − √(1 − μ_i)) v_i v_iᵀ takes the share μ_i of direction v_i away from R and z
alike, which does not move the estimate. Here

    μ_i = 1 − λ  where s_i² ≥ ε (1 − λ),   otherwise min(1 − λ, s_i²):

a direction that is hardly excited loses no more than it gains.
"""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray
from exoid.regression.least_squares import RANK

from .rows import Rows
from .settings import Settings
from .state import Information

ROUNDING = 1e-11
"""Part of a column, or of an entry, that is left by rounding where nothing should be left."""


def absorb(settings: Settings, information: Information, rows: Rows, weights: FloatArray) -> Information:
    """Forget as the settings say, and take rows in."""
    table, counts = rows.table, rows.used.sum(axis=0)
    R, number = information
    if settings.memory < np.inf:  # else nothing is forgotten
        share = 1.0 - np.exp(-counts * settings.stride / settings.rate / settings.memory)
        R, number = R.copy(), number.copy()
        for slot in np.flatnonzero((share > 0.0) & (number[:-1] > 0.0)):
            R[slot] = _forgotten(R[slot], table[slot], float(share[slot]))
            number[slot] *= 1.0 - float(share[slot])
        if R[-1].any():
            weighted = (table * weights[:, None, None]).reshape(-1, table.shape[2])
            R[-1] = np.linalg.qr(_forgotten(R[-1], weighted, float(share.max())), mode="r")
    out = R.copy()
    out[:-1] = _without_rounding(np.asarray(np.linalg.qr(np.concatenate([R[:-1], table], axis=1), mode="r")))
    return Information(out, number + np.append(counts, 0))


def _without_rounding(R: FloatArray) -> FloatArray:
    """R factors of which rows without information are zero, as of Coulomb friction and offset before a reversal."""
    # Rounding has residuals end in such a row. They belong in the last row, of which a share is forgotten in
    # every block.
    size = ROUNDING * np.sqrt((R[:, :, :-1] ** 2).sum(axis=1, keepdims=True))
    empty = (np.abs(R[:, :-1, :-1]) <= size).all(axis=2)
    if not R[:, :-1, -1][empty].any():
        return R
    R[:, -1, -1] = np.sqrt(R[:, -1, -1] ** 2 + (R[:, :-1, -1] ** 2 * empty).sum(axis=1))
    R[:, :-1] *= ~empty[:, :, None]
    return R


def _forgotten(R: FloatArray, table: FloatArray, share: float) -> FloatArray:
    """One R factor of which a share is forgotten in the directions that rows excite."""
    root, rows = R[:-1, :-1], table[:, :-1]
    size = np.sqrt((root**2).sum(axis=0) + (rows**2).sum(axis=0))
    size[size == 0.0] = 1.0
    regular = root / size
    # where there is no information, as little as counts stands in: only the directions are used
    regular = regular + RANK * np.diag(np.where(np.diag(regular) < 0.0, -1.0, 1.0))
    G = np.linalg.solve(regular.T, (rows / size).T).T
    G[np.abs(G * np.diag(regular)) <= ROUNDING * np.abs(rows / size)] = 0.0
    _, s, V = np.linalg.svd(G, full_matrices=False)
    # ε: a direction is excited if its gain is this part of what balances forgetting
    lost = np.where(s**2 >= 0.05 * share, share, np.minimum(share, s**2))
    changed = R.copy()
    changed[:-1] -= V.T @ ((1.0 - np.sqrt(1.0 - lost))[:, None] * (V @ R[:-1]))
    changed[-1] *= np.sqrt(1.0 - share)
    return changed
