"""CW101 to CW199: files, XML, xacro and YAML."""

from cartwheel.errors import Code

FILE_MISSING = Code(
    "CW101",
    "file-missing",
    "error",
    "a file, mesh, texture, model or package that does not exist",
)
FILE_ON_NETWORK = Code(
    "CW102",
    "file-on-network",
    "error",
    "a file on the network that was not downloaded",
)
FILE_UNREADABLE = Code(
    "CW103",
    "file-unreadable",
    "error",
    "a file that is empty, binary, too large or not a regular file",
)
FILE_NOT_ALLOWED = Code(
    "CW104",
    "file-not-allowed",
    "error",
    "a file outside of the folders that a description may read",
)
XML_MALFORMED = Code(
    "CW105",
    "xml-malformed",
    "error",
    "text that is not well-formed XML",
)
XML_ENTITY = Code(
    "CW106",
    "xml-entity",
    "error",
    "an entity that is declared in a description",
)
NOT_A_DESCRIPTION = Code(
    "CW107",
    "not-a-description",
    "error",
    "a file that is not a robot, model or world",
)
WRONG_KIND = Code(
    "CW108",
    "description-kind",
    "error",
    "a world where a robot is expected, or a robot where a world is expected",
)
MESH_UNREADABLE = Code(
    "CW109",
    "mesh-unreadable",
    "error",
    "a mesh file that is damaged, empty, or of an unknown format",
)
PICTURE_UNREADABLE = Code(
    "CW110",
    "picture-unreadable",
    "error",
    "a texture or heightmap that cannot be read",
)
YAML_MALFORMED = Code(
    "CW111",
    "yaml-malformed",
    "error",
    "an invalid YAML file that xacro loads",
)
XACRO_NOT_EXPANDED = Code(
    "CW112",
    "xacro-not-expanded",
    "error",
    "xacro in text received over the network",
)
XACRO_NOT_INSTALLED = Code(
    "CW113",
    "xacro-not-installed",
    "error",
    "the Python package xacro 2 is not installed",
)
XACRO_NAME_UNKNOWN = Code(
    "CW114",
    "xacro-name-unknown",
    "error",
    "an unknown xacro property, macro, block, argument or command",
)
MACRO_CALL_INVALID = Code(
    "CW115",
    "macro-call-invalid",
    "error",
    "a macro call whose parameters or blocks do not match the macro",
)
EXPRESSION_INVALID = Code(
    "CW116",
    "expression-invalid",
    "error",
    "a xacro expression that fails or is not allowed",
)
EXPANSION_TOO_LARGE = Code(
    "CW117",
    "expansion-too-large",
    "error",
    "a xacro file whose expansion exceeds a limit",
)
XACRO_INVALID = Code(
    "CW118",
    "xacro-invalid",
    "error",
    "a xacro element that cannot be expanded",
)
XACRO_MESSAGE = Code(
    "CW119",
    "xacro-message",
    "warning",
    "a xacro warning, or a message that the description prints",
)
XACRO_DEPRECATED = Code(
    "CW120",
    "xacro-deprecated",
    "info",
    "a deprecated xacro spelling",
)
XACRO_NAMESPACE = Code(
    "CW121",
    "xacro-namespace",
    "warning",
    "the xacro namespace declaration is missing",
)
XACRO_PREFIX = Code(
    "CW122",
    "xacro-prefix",
    "warning",
    "a xacro element without its prefix",
)
ARGUMENT_UNKNOWN = Code(
    "CW123",
    "argument-unknown",
    "warning",
    "an argument that the description does not declare",
)
INCLUDE_RECURSIVE = Code(
    "CW124",
    "include-recursive",
    "error",
    "a model that includes itself",
)
SDF_VERSION = Code(
    "CW125",
    "sdf-version",
    "error",
    "an SDF version that is missing, too old or newer than supported",
)
ARGUMENT_UNUSED = Code("CW153", "argument-unused", "warning", "a xacro argument has no effect")
PROPERTY_UNUSED = Code("CW154", "property-unused", "info", "a xacro property is never used")
PROPERTY_OVERWRITTEN = Code(
    "CW155", "property-overwritten", "info", "a xacro property is overwritten before it is used"
)
PARAMETER_UNUSED = Code(
    "CW156", "parameter-unused", "info", "a parameter of a xacro macro has no effect"
)
MACRO_UNUSED = Code("CW157", "macro-unused", "info", "a xacro macro is never called")
