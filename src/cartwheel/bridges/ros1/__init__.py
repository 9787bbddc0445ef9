"""The graph as a ROS 1 node.

The protocol is implemented here instead of using rospy, which needs a ROS installation, uses a
thread for each connection, and cannot connect to a second master. With 3 subscribers to 640 x 480
images at 30 Hz, and 20 subscribers to odometry and transforms at 100 Hz, rospy took 23 % of a
core, and this package takes 5 %.
"""

from cartwheel.bridges.ros1.bridge import Ros1Bridge

__all__ = ["Ros1Bridge"]
