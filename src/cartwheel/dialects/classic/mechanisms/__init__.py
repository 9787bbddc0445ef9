"""Mechanisms of Gazebo Classic."""
