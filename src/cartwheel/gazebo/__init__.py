"""Gazebo's own topics and services under ``/gazebo``, acting on a session."""

from cartwheel.gazebo.api import GazeboApi

__all__ = ["GazeboApi"]
