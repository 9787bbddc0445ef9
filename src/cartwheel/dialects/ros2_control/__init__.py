"""Controllers of ROS 2: libgazebo_ros2_control.so and gz_ros2_control."""
