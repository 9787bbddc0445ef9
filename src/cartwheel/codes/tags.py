"""CW301 to CW399: tags, attributes and materials."""

from cartwheel.errors import Code

TAG_IGNORED = Code(
    "CW301",
    "tag-ignored",
    "warning",
    "a tag or attribute that is ignored, often because it is misspelt",
)
TAG_MISPLACED = Code(
    "CW302",
    "tag-misplaced",
    "warning",
    "a tag in a position where it has no effect",
)
TAG_REPEATED = Code(
    "CW303",
    "tag-repeated",
    "warning",
    "a repeated tag, of which only the first is used",
)
TAG_EMPTY = Code(
    "CW304",
    "tag-empty",
    "warning",
    "an empty tag, whose default is used",
)
TAG_MISSING = Code(
    "CW305",
    "tag-missing",
    "error",
    "a required tag or attribute that is missing",
)
TYPE_UNKNOWN = Code(
    "CW306",
    "type-unknown",
    "error",
    "a type or keyword that does not exist",
)
NOT_SIMULATED = Code(
    "CW307",
    "not-simulated",
    "info",
    "a valid element that Cartwheel does not simulate",
)
VALUE_IGNORED = Code(
    "CW308",
    "value-ignored",
    "warning",
    "a value that is corrected or ignored",
)
VALUE_INVALID = Code(
    "CW309",
    "value-invalid",
    "error",
    "a value that is malformed or out of range",
)
NAME_UNKNOWN = Code(
    "CW310",
    "name-unknown",
    "error",
    "a reference to a link, frame or model that does not exist",
)
NAME_TAKEN = Code(
    "CW311",
    "name-taken",
    "error",
    "two elements with the same name in one scope",
)
SENSOR_TWICE = Code(
    "CW312",
    "sensor-twice",
    "warning",
    "two sensors with the same name on one link",
)
MATERIAL_UNKNOWN = Code(
    "CW313",
    "material-unknown",
    "warning",
    "a material that Gazebo does not have",
)
MATERIAL_UNDEFINED = Code(
    "CW314",
    "material-undefined",
    "warning",
    "a material that is not defined",
)
MATERIAL_DIFFERS = Code(
    "CW315",
    "material-differs",
    "warning",
    "a material with two different definitions",
)
FRAMES_CIRCULAR = Code(
    "CW316",
    "frames-circular",
    "error",
    "frames whose poses or attachments refer to each other in a cycle",
)
DEFAULT_USED = Code(
    "CW317",
    "default-used",
    "warning",
    "a missing tag whose default is unlikely to be intended",
)
ELEMENT_LEFT_OUT = Code(
    "CW318",
    "element-left-out",
    "warning",
    "an element that is ignored because it depends on a missing or conflicting element",
)
MODEL_EMPTY = Code(
    "CW319",
    "model-empty",
    "error",
    "a robot or model without links",
)
GAZEBO_IGNORES = Code(
    "CW350", "gazebo-ignores", "warning", "a tag that Cartwheel reads and Gazebo ignores"
)
