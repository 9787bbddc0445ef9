"""Drives of Gazebo Classic."""
