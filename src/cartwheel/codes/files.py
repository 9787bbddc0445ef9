"""CW101 to CW199: files, XML, xacro and YAML."""

from cartwheel.errors import Code

FILE_MISSING = Code(
    "CW101", "file-missing", "error", "a file, mesh, texture, model or package does not exist"
)
FILE_ON_NETWORK = Code(
    "CW102", "file-on-network", "error", "a file or model is on the network and is not downloaded"
)
FILE_UNREADABLE = Code(
    "CW103", "file-unreadable", "error", "a file is empty, binary, too large or not a regular file"
)
FILE_NOT_ALLOWED = Code(
    "CW104",
    "file-not-allowed",
    "error",
    "a file is outside the folders that a description may read",
)
XML_MALFORMED = Code("CW105", "xml-malformed", "error", "a file is not well-formed XML")
XML_ENTITY = Code("CW106", "xml-entity", "error", "a description declares an XML entity")
NOT_A_DESCRIPTION = Code(
    "CW107", "not-a-description", "error", "a file is not a robot, model or world"
)
WRONG_KIND = Code(
    "CW108",
    "description-kind",
    "error",
    "a file describes a world instead of a robot, or a robot instead of a world",
)
MESH_UNREADABLE = Code(
    "CW109", "mesh-unreadable", "error", "a mesh file is damaged, empty or in an unsupported format"
)
PICTURE_UNREADABLE = Code(
    "CW110", "picture-unreadable", "error", "a texture or heightmap cannot be read"
)
YAML_MALFORMED = Code("CW111", "yaml-malformed", "error", "xacro loads an invalid YAML file")
XACRO_NOT_EXPANDED = Code(
    "CW112", "xacro-not-expanded", "error", "a description from the network contains xacro"
)
XACRO_NOT_INSTALLED = Code(
    "CW113", "xacro-not-installed", "error", "the Python package xacro 2 is not installed"
)
XACRO_NAME_UNKNOWN = Code(
    "CW114",
    "xacro-name-unknown",
    "error",
    "a xacro property, macro, block, argument or command is not defined",
)
MACRO_CALL_INVALID = Code(
    "CW115",
    "macro-call-invalid",
    "error",
    "a macro call does not match the parameters or blocks of the macro",
)
EXPRESSION_INVALID = Code(
    "CW116", "expression-invalid", "error", "a xacro expression fails or is not allowed"
)
EXPANSION_TOO_LARGE = Code(
    "CW117", "expansion-too-large", "error", "the expansion of a xacro file exceeds a limit"
)
XACRO_INVALID = Code("CW118", "xacro-invalid", "error", "a xacro element is invalid")
XACRO_MESSAGE = Code(
    "CW119", "xacro-message", "warning", "xacro or the description prints a message"
)
XACRO_DEPRECATED = Code("CW120", "xacro-deprecated", "info", "the xacro syntax is deprecated")
XACRO_NAMESPACE = Code("CW121", "xacro-namespace", "warning", "the xacro namespace is not declared")
XACRO_PREFIX = Code("CW122", "xacro-prefix", "warning", "a xacro element has no prefix")
ARGUMENT_UNKNOWN = Code(
    "CW123", "argument-unknown", "warning", "the description does not declare an argument"
)
INCLUDE_RECURSIVE = Code("CW124", "include-recursive", "error", "a model or file includes itself")
SDF_VERSION = Code(
    "CW125", "sdf-version", "error", "the SDF version is missing, invalid, too old or too new"
)
ARGUMENT_UNUSED = Code("CW153", "argument-unused", "warning", "a xacro argument is never used")
PROPERTY_UNUSED = Code("CW154", "property-unused", "info", "a xacro property is never used")
PROPERTY_OVERWRITTEN = Code(
    "CW155", "property-overwritten", "info", "a xacro property is overwritten before it is used"
)
PARAMETER_UNUSED = Code(
    "CW156", "parameter-unused", "info", "a xacro macro never uses one of its parameters"
)
MACRO_UNUSED = Code("CW157", "macro-unused", "info", "a xacro macro is never called")
INCLUDE_ABSENT = Code(
    "CW158", "include-absent", "error", "an included xacro file does not exist and is left out"
)
MACRO_ABSENT = Code(
    "CW159",
    "macro-absent",
    "error",
    "a macro call is left out because the file that defines the macro was not found",
)
LINK_RECONNECTED = Code(
    "CW160",
    "link-reconnected",
    "warning",
    "a link is empty or attached elsewhere because a part of the robot is left out",
)
STAND_IN_USED = Code(
    "CW161",
    "stand-in-used",
    "info",
    "a package was not found, and Cartwheel's stand-in for it is used",
)
STAND_IN_PARAMETER = Code(
    "CW162",
    "stand-in-parameter",
    "warning",
    "a parameter of a macro is ignored because the package's stand-in does not support it",
)
FILE_ELSEWHERE = Code(
    "CW163",
    "file-elsewhere",
    "warning",
    "a file is not where the description says, and the file of the same package is used",
)
LAUNCH_VALUE_UNKNOWN = Code(
    "CW164",
    "launch-value-unknown",
    "warning",
    "a value in a launch file is unknown, a file in it was not found, or it takes too long to read",
)
LAUNCH_WORLD_ABSENT = Code(
    "CW165",
    "launch-world-absent",
    "warning",
    "the world of a launch file was not found, and the empty world is used",
)
DESCRIPTION_NOT_EXPANDED = Code(
    "CW166",
    "description-not-expanded",
    "warning",
    "a launch file passes the text of a xacro to ROS without expanding it",
)
ENVIRONMENT_ASSUMED = Code(
    "CW167",
    "environment-assumed",
    "info",
    "a file uses an environment variable that ROS sets, and no ROS is sourced",
)
LAUNCH_STOPS = Code(
    "CW170",
    "launch-stops",
    "error",
    "the launch file that starts the robot needs a file that does not exist",
)
PACKAGE_WITHOUT_MANIFEST = Code(
    "CW171",
    "package-without-manifest",
    "warning",
    "a folder without a package.xml is used as the package with a name",
)
PACKAGE_URI_IN_SDF = Code(
    "CW168",
    "package-uri-in-sdf",
    "warning",
    "Gazebo Classic does not find package:// URIs in SDF files",
)
PACKAGE_OF_NEIGHBOUR = Code(
    "CW169",
    "package-of-neighbour",
    "info",
    "a package was found in another repository near that of the robot",
)
