"""CW001 to CW099: the command line."""

from cartwheel.errors import Code

UNKNOWN_CODE = Code("CW001", "unknown-code", "error", "no diagnostic code has this number or name")
USAGE = Code("CW010", "usage", "error", "a command, option or argument is unknown or missing")
OPTION_INVALID = Code(
    "CW011", "option-invalid", "error", "the value of an option or argument is not allowed"
)
OPTIONS_CONFLICT = Code(
    "CW012", "options-conflict", "error", "options or arguments cannot be used together"
)
OUTPUT_NOT_WRITTEN = Code(
    "CW013", "output-not-written", "error", "the output file cannot be written"
)
SIMULATION_NOT_RUNNING = Code(
    "CW014", "simulation-not-running", "error", "a command requires a running simulation"
)
SIMULATION_AMBIGUOUS = Code(
    "CW015",
    "simulation-ambiguous",
    "error",
    "several simulations are running, and none is selected",
)
SIMULATION_SILENT = Code("CW016", "simulation-silent", "error", "the simulation does not respond")
SIMULATION_ENDED = Code(
    "CW017", "simulation-ended", "error", "the simulation ended before the command completed"
)
CONTROL_MISMATCH = Code(
    "CW018",
    "control-mismatch",
    "error",
    "messages on the control socket are from a different protocol version",
)
CONTROL_REQUEST_INVALID = Code(
    "CW019",
    "control-request-invalid",
    "error",
    "a request on the control socket has invalid parameters",
)
REQUEST_REFUSED = Code(
    "CW020", "request-refused", "error", "an older release of Cartwheel refused the request"
)
CONTROL_LIMIT = Code(
    "CW021",
    "control-limit",
    "error",
    "the control socket has too many clients, or a message is too large",
)
CONTROL_FOLDER_UNUSABLE = Code(
    "CW022", "control-folder-unusable", "error", "the folder for control sockets cannot be used"
)
PORT_TAKEN = Code("CW023", "port-taken", "error", "another program is using the port")
NOTHING_TO_DRIVE = Code(
    "CW024", "nothing-to-drive", "error", "no robot subscribes to velocity commands"
)
DRIVE_AMBIGUOUS = Code(
    "CW025", "drive-ambiguous", "error", "several robots can be driven, and none is selected"
)
WORLD_NOT_FOUND = Code(
    "CW026", "world-not-found", "error", "the world is not in any searched folder"
)
GAZEBO_OPTION_UNSUPPORTED = Code(
    "CW027",
    "gazebo-option-unsupported",
    "warning",
    "a Gazebo command-line option has no effect in Cartwheel",
)
NO_ROBOTS = Code("CW028", "no-robots", "error", "a folder contains no robot descriptions")
OTHER_SIMULATION_RUNNING = Code(
    "CW029", "other-simulation-running", "warning", "another simulation of the same user is running"
)
OUTPUT_SLOW = Code(
    "CW030", "output-slow", "warning", "messages arrive faster than they can be printed"
)
RECORDING_UNFINISHED = Code(
    "CW031",
    "recording-unfinished",
    "warning",
    "the recording is incomplete because the program that wrote it was interrupted",
)
SYSTEM_LIMIT = Code("CW032", "system-limit", "error", "the operating system refused a resource")
INTERNAL_FAULT = Code(
    "CW033", "internal-fault", "error", "an unexpected error occurred in Cartwheel"
)
FILE_TOO_DEEP = Code("CW034", "file-too-deep", "error", "a file is nested too deeply")
NO_PAGE = Code("CW035", "no-page", "error", "the simulation has no web interface")
SCENARIO_INVALID = Code(
    "CW036", "scenario-invalid", "error", "a scenario has an unknown key or an invalid value"
)
SCENARIO_EXPRESSION = Code(
    "CW037",
    "scenario-expression-invalid",
    "error",
    "an expression in a scenario cannot be evaluated",
)
NO_CASES = Code("CW038", "no-cases", "error", "no scenario, or no case of one, is selected")
LAUNCH_NOT_ALLOWED = Code(
    "CW039",
    "launch-not-allowed",
    "error",
    "a scenario starts a program or executes a plugin file, which requires permission",
)
LAUNCH_FAILED = Code(
    "CW040",
    "launch-failed",
    "error",
    "a program of a scenario cannot be started, or ended before the case",
)
COMMAND_LATE = Code(
    "CW041", "command-late", "warning", "a stack under test in lockstep sent a command too late"
)
COMMAND_EXTRA = Code(
    "CW044",
    "command-extra",
    "warning",
    "a stack under test in lockstep sent several commands in a period",
)
COMMAND_MISSING = Code(
    "CW045", "command-missing", "error", "a stack under test in lockstep has sent no command"
)
NO_TEST_ROBOT = Code(
    "CW042", "no-test-robot", "error", "a test uses the fixture robot, but names no robot"
)
RESULTS_INVALID = Code(
    "CW043", "results-invalid", "error", "the results of an earlier run cannot be read"
)
SETTINGS_INVALID = Code(
    "CW050", "settings-invalid", "error", "a settings file contains an unknown or invalid entry"
)
BASELINE_INVALID = Code("CW051", "baseline-invalid", "error", "the baseline file cannot be read")
SUPPRESSION_UNUSED = Code("CW052", "suppression-unused", "info", "a comment suppresses no finding")
