"""Controllers of ros_control and ros2_control, and the managers that load them."""
