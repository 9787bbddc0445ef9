"""The graph as a ROS 2 node."""

from cartwheel.bridges.ros2.bridge import Rmw, Ros2Bridge
from cartwheel.bridges.ros2.parameters import Parameter

__all__ = ["Parameter", "Rmw", "Ros2Bridge"]
