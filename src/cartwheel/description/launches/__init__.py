"""Reads launch files: the descriptions, xacro arguments and controller files that they name."""

from cartwheel.description.launches.search import chosen, controllers_for, launches_near, root_of
from cartwheel.description.launches.use import LaunchUse

__all__ = ["LaunchUse", "chosen", "controllers_for", "launches_near", "root_of"]
