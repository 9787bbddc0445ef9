"""Message types of simulation_interfaces_v1. Written by `make catalogue`; do not edit."""

from cartwheel.messages.modules import module_functions

__getattr__, __dir__ = module_functions("simulation_interfaces_v1")
