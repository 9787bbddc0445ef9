"""ROS messages in process: classes, names, parts."""

from cartwheel.messages.common import header, stamp
from cartwheel.messages.store import message_class, store, type_name

__all__ = ["header", "message_class", "stamp", "store", "type_name"]
