"""The graph as a node of ROS 1."""

from cartwheel.bridges.ros1.bridge import Ros1Bridge

__all__ = ["Ros1Bridge"]
