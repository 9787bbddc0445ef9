"""CW401 to CW499: sensors, plugins and controllers, as described."""

from cartwheel.errors import Code

PLUGIN_PARAMETER_UNKNOWN = Code(
    "CW451", "plugin-parameter-unknown", "warning", "a plugin does not read this parameter"
)
PLUGIN_PARAMETER_INVALID = Code(
    "CW452",
    "plugin-parameter-invalid",
    "error",
    "the value of a plugin's or sensor's parameter is not allowed",
)
PLUGIN_PARAMETER_MISSING = Code(
    "CW453", "plugin-parameter-missing", "error", "a plugin lacks a parameter that it needs"
)
PLUGIN_PARAMETER_NOT_SINGLE = Code(
    "CW454",
    "plugin-parameter-not-single",
    "warning",
    "a parameter states several numbers where one is read",
)
CONTROLLER_PARAMETER_UNKNOWN = Code(
    "CW455", "controller-parameter-unknown", "warning", "a controller does not read a parameter"
)
CONTROLLER_PARAMETER_INVALID = Code(
    "CW456",
    "controller-parameter-invalid",
    "error",
    "the value of a controller's parameter is not allowed",
)
CONTROLLER_PARAMETER_MISSING = Code(
    "CW457", "controller-parameter-missing", "error", "a controller lacks a parameter it needs"
)
