"""The interface for plugins in other packages.

A plugin is a subclass of `Plugin` with a dataclass of `tag` fields, found by the entry point group
``cartwheel.plugins``. Docs: ``docs/how-to/write-a-plugin.md``.
"""

from cartwheel.component import Component, Scope
from cartwheel.description.model import CameraIntrinsics
from cartwheel.dialects.plugin import NoTags, Plugin
from cartwheel.dialects.tags import tag
from cartwheel.graph import Action, Goal, Publisher

__all__ = [
    "Action",
    "CameraIntrinsics",
    "Component",
    "Goal",
    "NoTags",
    "Plugin",
    "Publisher",
    "Scope",
    "tag",
]
