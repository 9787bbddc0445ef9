"""Message types from the definitions in ROS packages."""
