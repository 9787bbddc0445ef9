"""The base class of everything that acts in a simulation: devices, plugins and controllers."""

from cartwheel.component.component import Component, is_connection
from cartwheel.component.scope import Scope, Shared
from cartwheel.component.sharing import TopicSharing

__all__ = ["Component", "Scope", "Shared", "TopicSharing", "is_connection"]
