"""Message types of hector_gazebo_plugins. Written by `make catalogue`; do not edit."""

from cartwheel.messages.modules import module_functions

__getattr__, __dir__ = module_functions("hector_gazebo_plugins")
