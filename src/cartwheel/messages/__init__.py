"""ROS messages in process: classes, names, parts."""

from cartwheel.messages.common import header, stamp
from cartwheel.messages.store import message_class, service_classes, store, type_name

__all__ = ["header", "message_class", "service_classes", "stamp", "store", "type_name"]
