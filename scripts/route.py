"""Route of a recording on its way to an estimate: which files of exoid it passes, and how deep calls are nested.

    python scripts/route.py             # exoid.identify on a recording of three joints in memory
    python scripts/route.py --files     # each file too, in the order of the first call, with the functions called

The first count is that of the method itself (check=False), the second that with the checks of log and fit, which run by
default. Files are counted whose functions run during the call; functions are nested as deep as frames of exoid stand on
the stack, comprehensions and lambdas left out. Imports are made before, so that they do not count.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from types import FrameType

import exoid

ROOT = Path(exoid.__file__).parent


class Route:
    """Profile function that notes each call of exoid's own functions.

    Attributes:
        functions: Functions called, by file, both in the order of the first call.
        deepest: Largest number of nested calls.
    """

    def __init__(self) -> None:
        """Begin with nothing."""
        self.functions: dict[str, dict[str, None]] = {}
        self.deepest = 0

    def __call__(self, frame: FrameType, event: str, _: object) -> None:
        """Note a call."""
        if event == "call" and _is_ours(frame):
            name = str(Path(frame.f_code.co_filename).relative_to(ROOT))
            function = getattr(frame.f_code, "co_qualname", frame.f_code.co_name)  # Python 3.10 has only the latter
            self.functions.setdefault(name, {})[function] = None
            self.deepest = max(self.deepest, _depth(frame))


def _is_ours(frame: FrameType) -> bool:
    """Whether a frame is a named function in a file of exoid."""
    return frame.f_code.co_filename.startswith(f"{ROOT}/") and not frame.f_code.co_name.startswith("<")


def _depth(frame: FrameType | None) -> int:
    """Count frames of exoid from this one outwards."""
    depth = 0
    while frame is not None:
        depth, frame = depth + _is_ours(frame), frame.f_back
    return depth


def route_of_a_recording(*, check: bool) -> Route:
    """Identify a leg from one recording in memory, with checks or without, and note the route."""
    data = exoid.datasets.bleex_swing()
    exoid.identify(data.leg, data.train, check=check)  # imports that wait for their first use are made now
    route = Route()
    sys.setprofile(route)
    try:
        exoid.identify(data.leg, data.train, check=check)
    finally:
        sys.setprofile(None)
    return route


def main() -> None:
    """Print the route."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--files", action="store_true", help="list files and functions")
    listed = parser.parse_args().files
    method, checked = route_of_a_recording(check=False), route_of_a_recording(check=True)
    print(f"a recording passes {len(method.functions)} files of exoid; calls are nested {method.deepest} deep")
    print(f"with its checks {len(checked.functions)} files; calls are nested {checked.deepest} deep")
    if listed:
        _list("files of the method", method.functions)
        _list("files of the checks", {k: v for k, v in checked.functions.items() if k not in method.functions})


def _list(heading: str, functions: dict[str, dict[str, None]]) -> None:
    """Print files with their functions."""
    print(f"{heading}:")
    for name, called in functions.items():
        print(f"  {name}: {', '.join(called)}")


if __name__ == "__main__":
    main()
