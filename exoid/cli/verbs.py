"""Verbs of the command line: name and help line of each; the file of a verb is imported when the verb is called."""

from __future__ import annotations

from importlib import import_module
from typing import Any

import typer
from typer.core import TyperGroup

VERBS = {
    "identify": (
        "Identify the parameters of LEG from the LOGs: columns time, q_<joint>, tau_<joint>, optionally v_ and a_."
    ),
    "check": (
        "Check the LOGs of LEG for late, frozen, clipped or swapped channels, wrong units and zeros, and straps."
    ),
    "select": "Select the friction of each joint of LEG by blocked cross-validation inside the LOGs.",
    "validate": "Predict the torque of the LOGs from their motion and compare it with the measured one.",
    "interaction": "Compute the torque between wearer and exoskeleton in the LOG, and test whether anything acts.",
    "compare": "Test whether B differs from A: left and right, one day and another, with and without a wearer.",
    "export": "Write an identified leg as a URDF, for MuJoCo with rotors, or in C.",
    "plan": "Find the motion that identifies LEG best, and predict the precision of its parameters; or --assess a log.",
    "reproduce": "Run a document's experiments on virtual rigs, identify, and print every table side by side.",
    "view": "Show LEG in a browser until Ctrl-C, on 127.0.0.1 only; or write it as a page that needs no network.",
    "track": "Run controllers on a rig and compare tracking error, torque, energy and chatter.",
    "coordinate": (
        "Run a day on the rig with ground: sit, rise, walk, stairs, sit; tell contacts by the identified model."
    ),
    "wear": ("Let a wearer walk in a leg: what is felt with the leg off, and with CAD, identified and true model."),
}
"""First paragraph of each verb's help. A verb is the function of that name in the file of that name."""


class LazyVerbs(TyperGroup):
    """A group whose verbs are imported when they are called: the group's own help needs none of them."""

    def resolve_command(self, ctx: Any, args: list[str]) -> tuple[str | None, Any, list[str]]:  # noqa: ANN401 - Click's
        """Find the verb that the arguments name, and import it."""
        name, found, rest = super().resolve_command(ctx, args)
        return name, found and load_verb(str(found.name)), rest


def load_verb(name: str) -> Any:  # noqa: ANN401 - Typer's or Click's Command, by Typer's version
    """Import a verb."""
    alone = typer.Typer(add_completion=False, pretty_exceptions_enable=False, rich_markup_mode=None)
    alone.command(name)(getattr(import_module(f".{name}", __package__), name))
    command = typer.main.get_command(alone)
    each: Any
    for each in command.params:
        if each.param_type_name == "argument":
            each.display_type_rich = lambda ctx: ""
    return command
