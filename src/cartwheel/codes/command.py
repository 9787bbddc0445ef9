"""CW001 to CW099: the command line."""

from cartwheel.errors import Code

UNKNOWN_CODE = Code("CW001", "unknown-code", "error", "a diagnostic code that does not exist")
USAGE = Code("CW010", "usage", "error", "a command, option or argument that is unknown or missing")
OPTION_INVALID = Code(
    "CW011", "option-invalid", "error", "an option or argument whose value is not allowed"
)
OPTIONS_CONFLICT = Code(
    "CW012", "options-conflict", "error", "options or arguments that exclude each other"
)
OUTPUT_NOT_WRITTEN = Code(
    "CW013", "output-not-written", "error", "a file that a command cannot write"
)
SIMULATION_NOT_RUNNING = Code(
    "CW014",
    "simulation-not-running",
    "error",
    "a command that requires a running simulation, but none is running",
)
SIMULATION_AMBIGUOUS = Code(
    "CW015",
    "simulation-ambiguous",
    "error",
    "a command for one simulation while several are running",
)
SIMULATION_SILENT = Code(
    "CW016", "simulation-silent", "error", "a running simulation that does not respond"
)
SIMULATION_ENDED = Code(
    "CW017", "simulation-ended", "error", "a simulation that ended before the command completed"
)
CONTROL_MISMATCH = Code(
    "CW018",
    "control-mismatch",
    "error",
    "control socket messages from a different version",
)
CONTROL_REQUEST_INVALID = Code(
    "CW019",
    "control-request-invalid",
    "error",
    "a request on the control socket with invalid parameters",
)
REQUEST_REFUSED = Code(
    "CW020", "request-refused", "error", "a request that the simulation rejected without a code"
)
CONTROL_LIMIT = Code(
    "CW021", "control-limit", "error", "more clients or messages than the control socket allows"
)
CONTROL_FOLDER_UNUSABLE = Code(
    "CW022",
    "control-folder-unusable",
    "error",
    "a runtime folder in which no control socket can be created",
)
PORT_TAKEN = Code("CW023", "port-taken", "error", "a port that another program uses")
NOTHING_TO_DRIVE = Code(
    "CW024", "nothing-to-drive", "error", "a teleop command when no robot can be driven"
)
DRIVE_AMBIGUOUS = Code(
    "CW025", "drive-ambiguous", "error", "a teleop command when several robots can be driven"
)
WORLD_NOT_FOUND = Code(
    "CW026", "world-not-found", "error", "a world that does not exist in any searched folder"
)
GAZEBO_OPTION_UNSUPPORTED = Code(
    "CW027",
    "gazebo-option-unsupported",
    "warning",
    "a Gazebo command-line option that has no effect in Cartwheel",
)
NO_ROBOTS = Code("CW028", "no-robots", "error", "a folder without robot descriptions")
OTHER_SIMULATION_RUNNING = Code(
    "CW029", "other-simulation-running", "warning", "a second simulation started by the same user"
)
OUTPUT_SLOW = Code(
    "CW030", "output-slow", "warning", "messages that arrive faster than they are printed"
)
RECORDING_UNFINISHED = Code(
    "CW031", "recording-unfinished", "warning", "a recording whose writer was interrupted"
)
SYSTEM_LIMIT = Code("CW032", "system-limit", "error", "a resource that the operating system denied")
INTERNAL_FAULT = Code("CW033", "internal-fault", "error", "an unexpected error in Cartwheel")
FILE_TOO_DEEP = Code(
    "CW034", "file-too-deep", "error", "a file that is nested too deeply to be read"
)
NO_PAGE = Code(
    "CW035", "no-page", "error", "a request for the web interface of a simulation that has none"
)
SETTINGS_INVALID = Code(
    "CW050", "settings-invalid", "error", "a settings file with an unknown or wrong entry"
)
BASELINE_INVALID = Code("CW051", "baseline-invalid", "error", "a baseline file that cannot be read")
SUPPRESSION_UNUSED = Code(
    "CW052", "suppression-unused", "info", "a comment that suppresses nothing"
)
