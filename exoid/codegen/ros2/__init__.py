"""A control law as a package for ROS 2: a chainable controller and a node around its C."""

from .package import write_ros2

__all__ = ["write_ros2"]
