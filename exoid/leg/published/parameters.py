"""Published numbers in the order and signs of this library: reduced parameters and joint resistances."""

from __future__ import annotations

from .document import bleex, cuhk

BLEEX_SETS = ("cad", "left", "right")
"""Parameter sets of document 1: Table V, and the two legs of Tables II and III."""


def bleex_parameters(which: str) -> dict[str, float]:
    """Return the reduced parameters of a BLEEX leg (doc. 1, eqs. (1)-(9)), with cumulative J.

    Args:
        which: Parameter set: ``"cad"`` for Table V (the same for both legs), ``"left"`` or ``"right"`` for the leg
            identified in Tables II and III.

    Returns:
        X1, Y1 [kg·m], J1 [kg·m²], X2, … J3 by name, in the order hip, knee, ankle.

    Raises:
        ExoidError: There is no parameter set of that name.
    """
    document = bleex()
    if which == "cad":
        printed = dict(document.tables["V"].values)
    else:
        printed = {**document.tables["II"].column(which), **document.tables["III"].column(which)}
    return {name: printed[name].value for name in ("X1", "Y1", "J1", "X2", "Y2", "J2", "X3", "Y3", "J3")}


def cuhk_parameters() -> dict[str, float]:
    """Return the reduced parameters of the assumed CUHK-EXO plant (doc. 2, Table I with J_t); J1 does not contain J2.

    They describe the hardware with the payload of a wearer (see the assumptions of :func:`exoid.leg.published.cuhk`).
    Table III of the document is not a physical leg; its values are in ``cuhk().tables["III"]``.

    Returns:
        X1, Y1 [kg·m], J1 [kg·m²], X2, Y2, J2 by name, in the order hip, knee.
    """
    return {name: cuhk().assumptions[name].value for name in ("X1", "Y1", "J1", "X2", "Y2", "J2")}


def cuhk_cad_parameters() -> dict[str, float]:
    """Return an assumed CAD model of the CUHK-EXO plant: document 2 prints none.

    The plant errs as BLEEX's design model does (doc. 1, Table V against the mean of both legs of Tables II and III).
    With the thigh as segment 1, and shank and foot as segment 2, of which J1 without J2:

        X' = X (X_cad / X_id),   J' = J (J_cad / J_id),   Y' = Y + X (Y_cad − Y_id) / X_id.

    Y is too small for a ratio. It errs by an angle of the centre of mass instead. Document 1 names no cause.

    Returns:
        X1, Y1 [kg·m], J1 [kg·m²], X2, Y2, J2 by name, as of :func:`cuhk_parameters`.
    """
    # the J1 of document 1 contains its J2
    sets = [bleex_parameters(which) for which in BLEEX_SETS]
    design, left, right = ({**one, "J1": one["J1"] - one["J2"]} for one in sets)
    found = {name: 0.5 * (left[name] + right[name]) for name in left}
    values = cuhk_parameters()
    for k in "12":
        X, Y, J = f"X{k}", f"Y{k}", f"J{k}"
        values[Y] += values[X] * (design[Y] - found[Y]) / found[X]
        values[X] *= design[X] / found[X]
        values[J] *= design[J] / found[J]
    return values


def bleex_resistances(side: str) -> dict[str, float]:
    """Return stiffness and kinetic friction of Tables I and IV (doc. 1) as resistances.

    In document 1 they act on the joint, A + B + C = RNEA (eq. (13)). Here τ = A = RNEA − B − C, so that every
    coefficient changes its sign. With the resistance r(θ, θ̇) = b2 θ² + b1 θ + b0 + c0 sgn θ̇

        τ = RNEA(θ, θ̇, θ̈) + r(θ, θ̇),

    and dissipative friction c0 is positive. The document did not identify the hip, which has no entry.

    Args:
        side: ``"left"`` or ``"right"``.

    Returns:
        ``b2_knee`` [N·m/rad²], ``b1_knee`` [N·m/rad], ``b0_knee``, ``c0_knee`` [N·m] by name, then those of the ankle.

    Raises:
        ExoidError: The side is neither left nor right.
    """
    stiffness, friction = bleex().tables["I"].column(side), bleex().tables["IV"].column(side)
    resistances = {}
    for index, joint in ((2, "knee"), (3, "ankle")):
        for power in (2, 1, 0):
            resistances[f"b{power}_{joint}"] = -stiffness[f"b{power}{index}"].value
        resistances[f"c0_{joint}"] = -friction[f"c0{index}"].value
    return resistances


def cuhk_resistances() -> dict[str, float]:
    """Return stiffness and friction of the assumed CUHK-EXO plant as resistances.

    τ = RNEA(θ, θ̇, θ̈) + b1 θ + c0 sgn θ̇ + d θ̇ (doc. 2, eq. (6)). The magnitudes are those of Table III, with the
    dissipative, positive sign and without the offsets.

    Returns:
        ``c0_hip`` [N·m], ``d_hip`` [N·m·s/rad], ``b1_knee`` [N·m/rad], ``c0_knee``, ``d_knee`` by name.
    """
    sources = {
        "c0_hip": "hip_coulomb",
        "d_hip": "hip_viscous",
        "b1_knee": "knee_stiffness",
        "c0_knee": "knee_coulomb",
        "d_knee": "knee_viscous",
    }
    return {name: cuhk().assumptions[source].value for name, source in sources.items()}
