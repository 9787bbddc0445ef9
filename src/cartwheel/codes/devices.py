"""CW401 to CW499: sensors, plugins and controllers, as described."""

from cartwheel.errors import Code

VIEW_BLOCKED = Code(
    "CW401", "view-blocked", "warning", "the robot itself blocks the view of a camera or lidar"
)
RATE_ABOVE_PHYSICS = Code(
    "CW402", "rate-above-physics", "warning", "a rate is higher than the physics rate"
)
SENSOR_TYPE_UNKNOWN = Code(
    "CW403", "sensor-type-unknown", "error", "a sensor has a type that Gazebo does not support"
)
SENSOR_RANGE_INVALID = Code(
    "CW404", "sensor-range-invalid", "error", "a sensor has an empty range, no rays or no pixels"
)
IMAGE_FORMAT_UNKNOWN = Code(
    "CW405", "image-format-unknown", "warning", "the image format of a camera is unknown"
)
CONTACT_COLLISION_UNKNOWN = Code(
    "CW406",
    "contact-collision-unknown",
    "error",
    "a contact sensor refers to a collision that does not exist",
)
CONTACT_NEVER_FIRES = Code(
    "CW407",
    "contact-never-fires",
    "warning",
    "Gazebo renames the collision that a contact sensor refers to",
)
LUMPED_JOINT = Code(
    "CW408", "lumped-joint", "warning", "a plugin measures a fixed joint that Gazebo removes"
)
LUMPED_LINK = Code(
    "CW409",
    "lumped-link",
    "info",
    "a plugin or tag refers to a link that Gazebo merges into another link",
)
BODY_UNKNOWN = Code(
    "CW410", "body-unknown", "error", "the body of a plugin is not a link of the robot"
)
FRAME_UNKNOWN = Code(
    "CW411",
    "frame-unknown",
    "warning",
    "the frame of a plugin's messages is not a link of the robot",
)
DUPLICATE_TOPIC = Code(
    "CW412", "duplicate-topic", "warning", "two plugins publish on the same topic"
)
TOPIC_INVALID = Code(
    "CW413", "topic-invalid", "error", "a topic or namespace is not a valid ROS name"
)
PLUGIN_UNKNOWN = Code(
    "CW414",
    "plugin-unknown",
    "info",
    "a plugin is not simulated by Cartwheel, or its name is misspelt",
)
PLUGIN_PARAMETER_OBSOLETE = Code(
    "CW416",
    "plugin-parameter-obsolete",
    "warning",
    "Gazebo 11 ignores a plugin parameter of older Gazebo versions",
)
PLUGIN_JOINT_UNKNOWN = Code(
    "CW417", "plugin-joint-unknown", "error", "a plugin refers to a joint that does not exist"
)
TRANSMISSION_JOINT_UNKNOWN = Code(
    "CW418",
    "transmission-joint-unknown",
    "error",
    "a transmission refers to a joint that does not exist",
)
ROS2_CONTROL_JOINT_UNKNOWN = Code(
    "CW419",
    "ros2-control-joint-unknown",
    "warning",
    "<ros2_control> refers to a joint that does not exist",
)
INTERFACE_UNKNOWN = Code(
    "CW420", "interface-unknown", "warning", "the interface of a joint is misspelt"
)
CONTROLLERS_FILE_UNREADABLE = Code(
    "CW421",
    "controllers-file-unreadable",
    "error",
    "a controller file is missing or is not valid YAML",
)
CONTROLLER_JOINT_UNKNOWN = Code(
    "CW422",
    "controller-joint-unknown",
    "error",
    "a controller refers to a joint that does not exist",
)
CONTROLLER_TYPE_UNKNOWN = Code(
    "CW423", "controller-type-unknown", "error", "a controller type is misspelt or not simulated"
)
CONTROLLER_INTERFACE_MISMATCH = Code(
    "CW424",
    "controller-interface-mismatch",
    "error",
    "a controller commands an interface that its joint does not offer",
)
CONTROLLER_GAINS_MISSING = Code(
    "CW425", "controller-gains-missing", "error", "a PID controller has no gains"
)
JOINT_CLAIMED_TWICE = Code(
    "CW426", "joint-claimed-twice", "info", "two controllers in one file command the same joint"
)
PLUGIN_PARAMETER_UNKNOWN = Code(
    "CW451", "plugin-parameter-unknown", "warning", "a plugin does not read a parameter"
)
PLUGIN_PARAMETER_INVALID = Code(
    "CW452",
    "plugin-parameter-invalid",
    "error",
    "the value of a plugin's or sensor's parameter is not allowed",
)
PLUGIN_PARAMETER_MISSING = Code(
    "CW453", "plugin-parameter-missing", "error", "a required plugin parameter is missing"
)
PLUGIN_PARAMETER_NOT_SINGLE = Code(
    "CW454",
    "plugin-parameter-not-single",
    "warning",
    "a parameter contains several numbers, but only one is used",
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
    "CW457", "controller-parameter-missing", "error", "a required controller parameter is missing"
)
PLUGIN_PARAMETER_IGNORED = Code(
    "CW458", "plugin-parameter-ignored", "warning", "a plugin parameter has no effect"
)
PLUGIN_PARAMETER_UNSUPPORTED = Code(
    "CW459",
    "plugin-parameter-unsupported",
    "error",
    "a parameter value is valid in Gazebo, but not supported by Cartwheel",
)
PLUGIN_RANGE_REVERSED = Code(
    "CW460",
    "plugin-range-reversed",
    "error",
    "the lower bound of a range is not below its upper bound",
)
WHEELS_UNPAIRED = Code(
    "CW461", "wheels-unpaired", "error", "a drive has different numbers of left and right wheels"
)
PLUGIN_IDLE = Code("CW462", "plugin-idle", "warning", "a plugin has nothing to act on")
PLUGIN_MISPLACED = Code(
    "CW463", "plugin-misplaced", "warning", "a plugin is inside the wrong element"
)
SENSOR_WITHOUT_PLUGIN = Code(
    "CW464", "sensor-without-plugin", "info", "a sensor has no plugin, so it publishes nothing"
)
SENSOR_INCOMPLETE = Code(
    "CW465", "sensor-incomplete", "error", "a required sensor element is missing"
)
SCAN_SAMPLES_INVALID = Code(
    "CW466",
    "scan-samples-invalid",
    "error",
    "the number of rays of a scan is zero, too large or not an integer",
)
SCAN_REVERSED = Code(
    "CW467", "scan-reversed", "info", "the maximum angle of a scan is below its minimum angle"
)
SENSOR_SETTING_IGNORED = Code(
    "CW468", "sensor-setting-ignored", "warning", "a sensor setting has no effect"
)
CAMERA_VIEW_NARROWED = Code(
    "CW469",
    "camera-view-narrowed",
    "warning",
    "a camera's field of view is wider than can be rendered",
)
COORDINATES_MISSING = Code(
    "CW470",
    "coordinates-missing",
    "info",
    "a world with a GPS sensor has no geographic coordinates",
)
CONTROLLERS_FILE_MISMATCH = Code(
    "CW471",
    "controllers-file-mismatch",
    "error",
    "a controller file and the robot are for different ROS versions",
)
CONTROLLERS_FILE_WITHOUT_CONTROLLERS = Code(
    "CW472",
    "controllers-file-without-controllers",
    "warning",
    "a controller file contains no controller",
)
CONTROLLERS_FILE_ARGUMENT = Code(
    "CW473",
    "controllers-file-argument",
    "error",
    "an expression in a controller file cannot be evaluated",
)
TRANSMISSION_IGNORED = Code(
    "CW474", "transmission-ignored", "warning", "a transmission drives no joint"
)
HARDWARE_NOT_SIMULATED = Code(
    "CW475",
    "hardware-not-simulated",
    "warning",
    "a hardware interface of ros_control or ros2_control is not simulated",
)
CONTROL_WITHOUT_JOINTS = Code(
    "CW476", "control-without-joints", "warning", "no joint is available to controllers"
)
EFFORT_LIMIT_TOO_LOW = Code(
    "CW477",
    "effort-limit-too-low",
    "warning",
    "a joint's effort limit is too low to hold the joint against gravity",
)
BRIDGE_FILE_INVALID = Code(
    "CW478",
    "bridge-file-invalid",
    "error",
    "a ros_gz_bridge configuration file is missing or invalid",
)
BRIDGE_ENTRY_IGNORED = Code(
    "CW479",
    "bridge-entry-ignored",
    "warning",
    "an entry in a ros_gz_bridge configuration file has no effect",
)
PLUGIN_FILE_INVALID = Code(
    "CW480",
    "plugin-file-invalid",
    "error",
    "a Python file with plugins is missing, fails or defines no plugin",
)
CONTROLLERS_NOT_FOUND = Code(
    "CW481",
    "controllers-not-found",
    "warning",
    "no file contains controllers for a controller manager, or nothing starts them",
)
PORT_USED_TWICE = Code(
    "CW482",
    "port-used-twice",
    "error",
    "two vehicles use the same port for their flight controllers",
)
HARDWARE_UNKNOWN = Code(
    "CW483",
    "hardware-unknown",
    "error",
    "a hardware interface is not in the package that its name states",
)
CONTROL_ELSEWHERE = Code(
    "CW484",
    "control-elsewhere",
    "info",
    "controllers use the joints that a model's URDF lists",
)
CONTROLLER_UNDEFINED = Code(
    "CW485",
    "controller-undefined",
    "warning",
    "a launch file starts a controller whose parameters no file contains",
)
CONTROLLER_UNDAMPED = Code(
    "CW486",
    "controller-undamped",
    "info",
    "a PID controller without a derivative gain moves a joint without damping",
)
CONTROLLER_GAIN_TOO_LOW = Code(
    "CW487",
    "controller-gain-too-low",
    "warning",
    "a proportional gain is too low for the friction of its joint or the weight on it",
)
CONTROLLER_ONLY_LOADED = Code(
    "CW488",
    "controller-only-loaded",
    "warning",
    "a launch file loads a controller, but does not start it",
)
CONTROLLER_PARAMETER_REPEATED = Code(
    "CW489",
    "controller-parameter-repeated",
    "warning",
    "a file of controllers repeats a key",
)
HARDWARE_WITHOUT_PLUGIN = Code(
    "CW490",
    "hardware-without-plugin",
    "warning",
    "no Gazebo plugin runs the hardware of <ros2_control> or of transmissions",
)
DERIVATIVE_GAIN_TOO_HIGH = Code(
    "CW491",
    "derivative-gain-too-high",
    "warning",
    "a derivative gain makes the velocity oscillate that a controller commands",
)
PLUGIN_OF_OTHER_ROS = Code(
    "CW492",
    "plugin-of-other-ros",
    "warning",
    "a plugin exists only in the version of ROS for which the package is not built",
)
ODOMETRY_FRAME_IS_LINK = Code(
    "CW493",
    "odometry-frame-is-link",
    "warning",
    "the odometry frame of a drive is a link of the robot",
)
NOISE_TYPE_UNKNOWN = Code(
    "CW494", "noise-type-unknown", "error", "the noise of a sensor has a type that does not exist"
)
SENSOR_SYSTEM_MISSING = Code(
    "CW495",
    "sensor-system-missing",
    "warning",
    "a world for gz-sim does not load the system that publishes a sensor",
)
PLUGIN_OF_OTHER_GAZEBO = Code(
    "CW496",
    "plugin-of-other-gazebo",
    "warning",
    "a plugin exists only in the Gazebo in which the robot is not started",
)
CONTROLLER_PARAMETER_TYPE = Code(
    "CW497",
    "controller-parameter-type",
    "error",
    "a parameter of ROS 2 has a value of another type, which ROS 2 does not convert",
)
MANAGER_STARTED_TWICE = Code(
    "CW498",
    "manager-started-twice",
    "warning",
    "a launch file starts a second controller manager with the same name",
)
SENSOR_REFUSED = Code(
    "CW499",
    "sensor-refused",
    "error",
    "a plugin does not accept the type of its sensor",
)
