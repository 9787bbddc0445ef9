"""Classes of all built-in message types, by ROS package, with static types.

>>> from cartwheel.msgs.nav_msgs import Odometry

The requests and responses of services have names such as ``std_srvs.SetBool_Request``.
"""
