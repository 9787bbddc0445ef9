"""Message types of controller_manager_msgs_ros2. Written by `make catalogue`; do not edit."""

from cartwheel.messages.modules import module_functions

__getattr__, __dir__ = module_functions("controller_manager_msgs_ros2")
