"""CW301 to CW399: tags, attributes and materials."""

from cartwheel.errors import Code

TAG_IGNORED = Code(
    "CW301", "tag-ignored", "warning", "a tag or attribute is ignored, often because it is misspelt"
)
TAG_MISPLACED = Code(
    "CW302", "tag-misplaced", "warning", "a tag is in an element where it has no effect"
)
TAG_REPEATED = Code(
    "CW303", "tag-repeated", "warning", "a tag is repeated, and only the first one is used"
)
TAG_EMPTY = Code("CW304", "tag-empty", "warning", "a tag is empty, so its default is used")
TAG_MISSING = Code("CW305", "tag-missing", "error", "a required tag or attribute is missing")
TYPE_UNKNOWN = Code("CW306", "type-unknown", "error", "a type or keyword does not exist")
NOT_SIMULATED = Code("CW307", "not-simulated", "info", "a valid element has no effect in Cartwheel")
VALUE_IGNORED = Code("CW308", "value-ignored", "warning", "a value is corrected or ignored")
VALUE_INVALID = Code("CW309", "value-invalid", "error", "a value is malformed or out of range")
NAME_UNKNOWN = Code(
    "CW310", "name-unknown", "error", "a reference to a link, frame or model does not exist"
)
NAME_TAKEN = Code("CW311", "name-taken", "error", "two elements in one scope have the same name")
SENSOR_TWICE = Code(
    "CW312", "sensor-twice", "warning", "two sensors on one link have the same name"
)
MATERIAL_UNKNOWN = Code(
    "CW313", "material-unknown", "warning", "Gazebo has no material with this name"
)
MATERIAL_UNDEFINED = Code("CW314", "material-undefined", "warning", "a material is not defined")
MATERIAL_DIFFERS = Code(
    "CW315", "material-differs", "warning", "a material has two different definitions"
)
FRAMES_CIRCULAR = Code(
    "CW316", "frames-circular", "error", "poses or frame attachments form a cycle"
)
DEFAULT_USED = Code(
    "CW317",
    "default-used",
    "warning",
    "a tag is missing, and its default value is probably not intended",
)
ELEMENT_LEFT_OUT = Code(
    "CW318",
    "element-left-out",
    "warning",
    "an element is ignored because it needs a missing element or conflicts with another one",
)
MODEL_EMPTY = Code("CW319", "model-empty", "error", "a robot or model has no links")
TEXT_AFTER_NUMBER = Code(
    "CW320", "text-after-number", "warning", "text after a number is ignored, as in Gazebo"
)
GAZEBO_IGNORES = Code(
    "CW350", "gazebo-ignores", "warning", "Gazebo ignores a tag that Cartwheel reads"
)
LINK_CUT_SHORT = Code(
    "CW351", "link-cut-short", "error", "ROS and Gazebo stop reading a link before its end"
)
