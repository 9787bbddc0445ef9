"""Sensors and publishers of Gazebo Classic."""
