"""Mistakes in launch files, for which ROS or Gazebo does not start a robot."""
