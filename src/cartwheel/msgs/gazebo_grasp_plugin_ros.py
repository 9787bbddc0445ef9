"""Message types of gazebo_grasp_plugin_ros. Written by `make catalogue`; do not edit."""

from cartwheel.messages.modules import module_functions

__getattr__, __dir__ = module_functions("gazebo_grasp_plugin_ros")
