"""CDR, ROS 2's binary format."""
