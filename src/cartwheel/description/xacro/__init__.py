"""Expansion of xacro files with ROS's implementation, the package `xacro`.

The package keeps its state in global variables, so each expansion runs in its own copy of the
module. Some of its functions are replaced in the copy; see `replacements`.
"""

from cartwheel.description.xacro.expansion import expand

__all__ = ["expand"]
