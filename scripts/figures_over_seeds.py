"""Options and table of studies whose figures are means over seeds."""

from __future__ import annotations

import argparse
from collections.abc import Callable

import numpy as np


def run_seeds(about: str, figures: Callable[..., dict[str, float]], **numbers: float) -> None:
    """Read the number of seeds, and other numbers, from the command line, and print the figures over them."""
    parser = argparse.ArgumentParser(description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=8)
    parser.add_argument("--first", type=int, default=1000, help="first seed; tune below 1000")
    for name, value in numbers.items():
        parser.add_argument(f"--{name}", type=float, default=value)
    options = parser.parse_args()
    seeds = range(options.first, options.first + options.seeds)
    given = {name: getattr(options, name) for name in numbers}
    others = "".join(f", {name} {value:g}" for name, value in given.items() if value != numbers[name])
    title = f"{options.seeds} seeds from {options.first}{others}"
    print_figures(title, [figures(seed, **given) for seed in seeds])


def print_figures(title: str, found: list[dict[str, float]]) -> None:
    """Print mean and extremes of figures over seeds."""
    print(title)
    for name in found[0]:
        values = np.array([each[name] for each in found])
        print(f"  {name}: mean {values.mean():.3g}, from {values.min():.3g} to {values.max():.3g}")
