"""A control law as a package for ROS 2: a chainable controller and a node around its C."""

from .folder import refuse_foreign, write_folder
from .package import write_ros2

__all__ = ["refuse_foreign", "write_folder", "write_ros2"]
