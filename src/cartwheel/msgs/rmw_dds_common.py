"""Message types of rmw_dds_common. Written by `make catalogue`; do not edit."""

from cartwheel.messages.modules import module_functions

__getattr__, __dir__ = module_functions("rmw_dds_common")
