"""Bridges that connect the graph to ROS 1, ROS 2, Foxglove and recordings."""
