"""Route of a recording on its way to an estimate: which files of exoid it passes, and how deep calls are nested.

    python scripts/route.py             # exoid.identify with its defaults on a recording of three joints in memory
    python scripts/route.py --files     # each file too, in the order of the first call, with the functions called

Files are counted whose functions run during the call; functions are nested as deep as frames of exoid stand on the
stack, comprehensions and lambdas left out. Imports are made before, so that they do not count.
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


def route_of_a_recording() -> Route:
    """Identify a leg from one recording in memory, and note the route."""
    data = exoid.datasets.bleex_swing()
    exoid.identify(data.leg, data.train)  # imports that wait for their first use are made now
    route = Route()
    sys.setprofile(route)
    try:
        exoid.identify(data.leg, data.train)
    finally:
        sys.setprofile(None)
    return route


def main() -> None:
    """Print the route."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--files", action="store_true", help="list files and functions")
    listed = parser.parse_args().files
    route = route_of_a_recording()
    print(f"a recording passes {len(route.functions)} files of exoid; calls are nested {route.deepest} deep")
    if listed:
        for name, functions in route.functions.items():
            print(f"  {name}: {', '.join(functions)}")


if __name__ == "__main__":
    main()
