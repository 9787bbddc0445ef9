"""CW501 to CW599: sensors, plugins and controllers, as they run."""

from cartwheel.errors import Code

UNKNOWN_LINK = Code(
    "CW501", "unknown-link", "error", "the model does not have a link with this name"
)
UNKNOWN_SENSOR = Code(
    "CW502", "unknown-sensor", "error", "the robot does not have a sensor with this name"
)
STATIC_MODEL_DRIVEN = Code(
    "CW503", "static-model-driven", "error", "a plugin drives a joint of a static model"
)
MODEL_NOT_MOVABLE = Code(
    "CW504", "model-not-movable", "error", "a plugin moves a model that is fixed or has no mass"
)
NOT_A_WHEEL = Code(
    "CW505", "not-a-wheel", "error", "the radius or axle of a wheel cannot be determined"
)
JOINT_DRIVEN_TWICE = Code(
    "CW506", "joint-driven-twice", "warning", "two plugins drive the same joint or wheel"
)
JOINT_WITHOUT_STATE = Code(
    "CW507", "joint-without-state", "info", "a joint has no state to publish"
)
PLUGIN_LEFT_OUT = Code(
    "CW508", "plugin-left-out", "error", "a plugin or sensor has an error and is not loaded"
)
PLUGIN_FAILED = Code(
    "CW509", "plugin-failed", "error", "a plugin raised an exception and is disabled"
)
SERVICE_TAKEN = Code(
    "CW510", "service-taken", "warning", "two plugins offer a service with the same name"
)
RECONFIGURE_UNAVAILABLE = Code(
    "CW511",
    "reconfigure-unavailable",
    "warning",
    "the parameters of a plugin cannot be changed with dynamic_reconfigure",
)
COMMAND_NOT_SIMULATED = Code(
    "CW512",
    "command-not-simulated",
    "warning",
    "a command contains a number that cannot be simulated",
)
COMMAND_IGNORED = Code(
    "CW513", "command-ignored", "warning", "the contents of a command are invalid"
)
TRAJECTORY_INVALID = Code(
    "CW514", "trajectory-invalid", "warning", "a trajectory cannot be followed"
)
ATTACHMENT_FAILED = Code(
    "CW515", "attachment-failed", "warning", "links cannot be attached or detached"
)
BATTERY_EMPTY = Code("CW516", "battery-empty", "warning", "a battery is empty")
CAMERA_WITHOUT_RATE = Code(
    "CW517", "camera-without-rate", "error", "a triggered camera has no rate to change"
)
IMAGE_COMPRESSION_UNKNOWN = Code(
    "CW518", "image-compression-unknown", "error", "images cannot be compressed in this format"
)
CONTROLLER_NOT_STARTED = Code(
    "CW519", "controller-not-started", "warning", "a controller cannot be started"
)
CONTROLLER_STATE = Code(
    "CW520", "controller-state", "error", "a request is not possible in the state of a controller"
)
CONTROLLER_CONFLICT = Code(
    "CW521",
    "controller-conflict",
    "error",
    "a controller cannot run at the same time as another controller",
)
CONTROLLER_TYPE_MISSING = Code(
    "CW522", "controller-type-missing", "error", "the type of a controller to load is not specified"
)
HARDWARE_COMPONENT = Code(
    "CW523", "hardware-component", "error", "a request is not possible for a hardware component"
)
WHEELS_WITHOUT_ROLLERS = Code(
    "CW524",
    "wheels-without-rollers",
    "warning",
    "the wheels of a mecanum drive roll like ordinary wheels",
)
SIMULATION_UNRESPONSIVE = Code(
    "CW525", "simulation-unresponsive", "error", "the simulation does not respond to a request"
)
CONTROLLERS_NOT_NAMED = Code(
    "CW526",
    "controllers-not-named",
    "warning",
    "a robot has a controller manager, but no controllers",
)
JOINT_SHARED = Code(
    "CW527",
    "joint-shared",
    "warning",
    "two controllers command a joint by different interfaces, and it follows one of them",
)
