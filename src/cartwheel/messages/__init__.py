"""ROS messages in memory: classes, names, fields, and their external formats."""

from cartwheel.messages.cdr.encoding import CdrCache, decode_cdr
from cartwheel.messages.cdr.writing import encode_cdr
from cartwheel.messages.common import header, stamp
from cartwheel.messages.convert import checked, from_dict, from_flat, recast, to_dict, zero
from cartwheel.messages.echo import to_yaml
from cartwheel.messages.forms import Form
from cartwheel.messages.store import message_class, service_classes, store, type_name
from cartwheel.messages.times import nanoseconds

__all__ = [
    "CdrCache",
    "Form",
    "checked",
    "decode_cdr",
    "encode_cdr",
    "from_dict",
    "from_flat",
    "header",
    "message_class",
    "nanoseconds",
    "recast",
    "service_classes",
    "stamp",
    "store",
    "to_dict",
    "to_yaml",
    "type_name",
    "zero",
]
