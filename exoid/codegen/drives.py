"""Commands of drives as expressions in C: from torques at the joints to currents, forces or motor angles."""

from __future__ import annotations

from exoid.actuators import Actuators, Attachments, Drive, LinearActuator, Motor, SeriesElastic
from exoid.actuators.attachments import SHORTEST, SquaredLength
from exoid.errors import ExoidError, NotSupportedError
from exoid.torques.terms import SIGN_WIDTH

from .dialect import ABSURD, Dialect


def commands_in_c(actuators: Actuators, dialect: Dialect) -> list[str]:
    """Write the command of each joint as an expression in q[j], v[j], tau[j] and the template's within(x, limit)."""
    names = actuators.joint_names
    commands = [_limited(f"tau[{joint}]", None, dialect) for joint in range(len(names))]
    for name, drive in actuators.drives.items():
        joint = names.index(name)
        commands[joint] = _command(drive, f"tau[{joint}]", f"q[{joint}]", f"v[{joint}]", dialect)
    for coupling in actuators.couplings.values():
        places = [names.index(name) for name in coupling.joints]
        for k, place in enumerate(places):
            shares = [(row[k], j) for row, j in zip(coupling.matrix, places, strict=True)]
            torque = " + ".join(f"{dialect.number(share)} * tau[{j}]" for share, j in shares)
            commands[place] = _limited(torque, None, dialect)
    return commands


def with_form_in_c(actuators: Actuators | None) -> tuple[Actuators | None, tuple[str, ...]]:
    """Leave out drives without a form in C."""
    if actuators is None:
        return None, ()
    try:
        commands_in_c(actuators, Dialect())
    except ExoidError as error:
        return None, (f"no function for commands of the drives: {error.what}",)
    return actuators, ()


def _command(drive: Drive, tau: str, q: str, v: str, dialect: Dialect) -> str:
    number = dialect.number
    if isinstance(drive, Motor):
        current = f"{tau} / {number(drive.ratio * drive.known('torque_constant'))}"
        if drive.needs_velocity:
            driving, driven = drive.gear_factors
            mean, half = number(0.5 * (driving + driven)), number(0.5 * (driving - driven))
            sign = f"{dialect.function('copysign')}({number(1.0)}, {tau})"
            known = f"within({v}, {number(ABSURD)})"  # a safe torque is made also while the velocity is unknown
            current += f" / ({mean} + {half} * {dialect.function('tanh')}({sign} * {known} / {number(SIGN_WIDTH)}))"
        return _limited(current, drive.max_current, dialect)
    if isinstance(drive, SeriesElastic):
        return f"{number(drive.ratio)} * ({q} + {tau} / {number(drive.stiffness)})"
    arm = drive.moment_arm if isinstance(drive, LinearActuator) else None
    if isinstance(drive, LinearActuator) and isinstance(arm, Attachments) and arm.squared_length is not None:
        gain = "" if drive.gain == 1.0 else f"{number(drive.known('gain'))} * "
        gain += _arm(arm.squared_length, q, dialect)  # its fmax() drops a NaN
        return _limited(f"isfinite({q}) ? {tau} / ({gain}) : {number(0.0)}", drive.max_force, dialect)
    what = f"{type(drive).__name__}{' with a table of moment arms' if arm else ''} has no form in C"
    remedy = "describe the actuator by its attachment points, or turn torques into commands in your own code"
    raise NotSupportedError(what, remedy=remedy)


def _arm(squared: SquaredLength, q: str, dialect: Dialect) -> str:
    """Moment arm, at least a millimetre."""
    c0, c1, c2 = (dialect.number(value) for value in squared)
    root, cos, sin = (dialect.function(name) for name in ("sqrt", "cos", "sin"))
    slope, square = f"{c2} * {cos}({q}) - {c1} * {sin}({q})", f"{c0} + {c1} * {cos}({q}) + {c2} * {sin}({q})"
    exact = f"{dialect.number(0.5)} * ({slope}) / {root}({square})"
    largest, fabs = dialect.function("fmax"), dialect.function("fabs")
    return f"{dialect.function('copysign')}({largest}({fabs}({exact}), {dialect.number(SHORTEST)}), {exact})"


def _limited(command: str, limit: float | None, dialect: Dialect) -> str:
    """Limit a command to both sides; zero where it is not finite."""
    return f"within({command}, {dialect.number(ABSURD if limit is None else limit)})"
