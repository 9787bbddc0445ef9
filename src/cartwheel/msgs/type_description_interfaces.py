"""Message types of type_description_interfaces. Written by `make catalogue`; do not edit."""

from cartwheel.messages.modules import module_functions

__getattr__, __dir__ = module_functions("type_description_interfaces")
