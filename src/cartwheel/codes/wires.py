"""CW801 to CW899: ROS 1, ROS 2, Foxglove and network access."""
