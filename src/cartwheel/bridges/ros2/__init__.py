"""The graph as a node of ROS 2."""

from cartwheel.bridges.ros2.bridge import Rmw, Ros2Bridge
from cartwheel.bridges.ros2.parameters import Parameter

__all__ = ["Parameter", "Rmw", "Ros2Bridge"]
