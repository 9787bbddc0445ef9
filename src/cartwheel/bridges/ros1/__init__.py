"""The graph as a ROS 1 node."""

from cartwheel.bridges.ros1.bridge import Ros1Bridge

__all__ = ["Ros1Bridge"]
