"""Plugins of Gazebo Classic that apply forces."""
