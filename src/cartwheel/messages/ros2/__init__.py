"""ROS 2's definitions, names and hashes of message types."""
