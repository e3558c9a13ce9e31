"""URDFs of example-robot-data."""

from pathlib import Path

from example_robot_data.robots_loader import ROBOTS, getModelPath


def urdf_of(robot: str) -> Path:
    loader = ROBOTS[robot]
    inside = Path(loader.path) / loader.urdf_subpath / loader.urdf_filename
    return Path(getModelPath(str(inside))) / inside
