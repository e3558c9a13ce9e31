"""``exoid export``: an estimate as a URDF, for MuJoCo, as C, or as a control law in C or for ROS 2."""

from __future__ import annotations

from exoid.errors import BadArgumentError

from .export_options import LawOptions, LinkOptions, Target
from .inputs import load_estimate
from .option_groups import expand_options
from .options import AsJson, EstimateName, given
from .outputs import check_outputs, print_result
from .refusals import refuse


@expand_options()
def export(
    estimate: EstimateName,
    target: Target = Target(),  # noqa: B008 - a tuple does not change
    links: LinkOptions = LinkOptions(),  # noqa: B008
    options: LawOptions = LawOptions(),  # noqa: B008
    as_json: AsJson = False,
) -> None:
    """Write an identified leg as a URDF, for MuJoCo with rotors, or in C.

    With --law, the C is a control law with this model: pd, gravity_friction_pd, feedforward_pd, computed_torque or lqr;
    for a leg with a wearer gravity_support, sensitivity_amplification or impedance; for a machine that stands, stance
    or coordinated, with a solver of yours (docs/stance-control.md); or momentum_observer, which gives the torque of the
    wearer. With --ros2, it is a package for ROS 2 around that C.

    Example: exoid export est.json -o leg.urdf
    """
    _refuse_without_effect(target, links, options)
    check_outputs(target.files, [estimate])
    if target.ros2 is not None:
        from exoid.codegen.ros2.folder import refuse_foreign  # noqa: PLC0415

        refuse_foreign(target.ros2)
    found = load_estimate(estimate)
    if target.law is not None:
        from .law_export import export_law  # noqa: PLC0415 - only a law needs the controllers

        print_result(export_law(found, target, options), as_json=as_json)
    elif target.c is not None:
        print_result(found.to_c(target.c, precision=target.precision or "double"), as_json=as_json)
    elif target.mjcf is not None:
        print_result(found.to_mjcf(target.mjcf, **links._asdict()), as_json=as_json)
    else:
        print_result(found.to_urdf(str(target.output), **links._asdict()), as_json=as_json)


def _refuse_without_effect(target: Target, links: LinkOptions, options: LawOptions) -> None:
    """Refuse options that have no effect on what is written."""
    output, c, mjcf, ros2, precision, law = target
    in_c = c is not None or ros2 is not None
    of_law = [name for name, value in given(options).items() if value is not None]
    refuse({"--precision": None if in_c else precision}, "nothing is written as C; give --c LEG.C")
    several = sum(each is not None for each in (output, c, mjcf, ros2)) != 1
    one = "give one of -o LEG.URDF, --c LEG.C and --mjcf LEG.XML, or --law NAME --ros2 DIR"
    rules = (
        (several, "one file is written at a time", one),
        (in_c and links != LinkOptions(), "--mass-factor and --pull have no effect on C", "write a URDF with -o"),
        (law is None and bool(of_law), f"{', '.join(of_law)}: only a control law has it", "name the law with --law"),
        (law is not None and not in_c, "--law has no effect on a URDF", "give --c LAW.C"),
        (law is None and ros2 is not None, "--ros2 writes a control law", "name the law with --law"),
    )
    for applies, what, remedy in rules:
        if applies:
            raise BadArgumentError(what, remedy=remedy)
