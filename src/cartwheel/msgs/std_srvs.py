"""Message types of std_srvs. Written by `make catalogue`; do not edit."""

from cartwheel.messages.modules import module_functions

__getattr__, __dir__ = module_functions("std_srvs")
