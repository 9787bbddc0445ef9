"""Message types of four_wheel_steering_msgs. Written by `make catalogue`; do not edit."""

from cartwheel.messages.modules import module_functions

__getattr__, __dir__ = module_functions("four_wheel_steering_msgs")
