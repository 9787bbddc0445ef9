"""Plugins of Gazebo Classic and gazebo_ros_pkgs."""
