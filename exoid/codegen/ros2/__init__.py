"""A control law as a package for ROS 2: a chainable controller and a node around its C."""

from .folder import refuse_foreign, write_folder
from .package import Ros2Package, ros2_package

__all__ = ["Ros2Package", "refuse_foreign", "ros2_package", "write_folder"]
