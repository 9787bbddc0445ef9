"""Gazebo's topics and services under ``/gazebo``, for a session."""

from cartwheel.gazebo.api import GazeboApi

__all__ = ["GazeboApi"]
