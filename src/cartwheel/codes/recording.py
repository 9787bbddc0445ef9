"""CW901 to CW999: recording, playback and the web interface."""

from cartwheel.errors import Code

RECORDING_UNREADABLE = Code(
    "CW901", "recording-unreadable", "error", "a recording cannot be read from the disk"
)
NOT_A_RECORDING = Code("CW902", "not-a-recording", "error", "a file or folder is not a recording")
RECORDING_DAMAGED = Code("CW903", "recording-damaged", "error", "a recording is damaged")
RECORDING_VERSION_UNKNOWN = Code(
    "CW904",
    "recording-version-unknown",
    "error",
    "the version of a recording's format is not supported",
)
RECORDING_NOT_WRITABLE = Code(
    "CW905", "recording-not-writable", "error", "a recording cannot be written"
)
RECORDING_EXISTS = Code(
    "CW906",
    "recording-exists",
    "error",
    "a file or folder with the name of the recording already exists",
)
RECORDING_NAME_INVALID = Code(
    "CW907",
    "recording-name-invalid",
    "error",
    "the file extension does not select a recording format",
)
ENCODING_UNFIT = Code(
    "CW908", "encoding-unfit", "error", "the recording format does not support a message encoding"
)
RECORDING_BROKE_OFF = Code(
    "CW909", "recording-broke-off", "error", "the recording ended before the simulation did"
)
TOPIC_PATTERN_INVALID = Code(
    "CW910", "topic-pattern-invalid", "error", "a topic pattern is not a valid regular expression"
)
TOPIC_PATTERN_UNMATCHED = Code(
    "CW911", "topic-pattern-unmatched", "warning", "a topic pattern matches no topic"
)
DISK_SLOW = Code("CW912", "disk-slow", "warning", "the disk is slower than the simulation")
MESSAGE_NOT_RECORDED = Code(
    "CW913",
    "message-not-recorded",
    "warning",
    "messages cannot be written in the recording's encoding",
)
RECORDING_SPLIT = Code(
    "CW914",
    "recording-split",
    "info",
    "simulation time went back, so the recording continues in a new file",
)
RECORDED_TYPE_UNUSABLE = Code(
    "CW915", "recorded-type-unusable", "error", "the type of a recorded topic cannot be used"
)
RECORDED_TOPIC_LEFT_OUT = Code(
    "CW916", "recorded-topic-left-out", "warning", "a recorded topic is not played"
)
RECORDING_EMPTY = Code("CW917", "recording-empty", "error", "a recording contains no messages")
PLAYBACK_READ_ONLY = Code(
    "CW918", "playback-read-only", "error", "models cannot be spawned or deleted during playback"
)
RECORDED_ROBOT_NOT_SHOWN = Code(
    "CW919", "recorded-robot-not-shown", "warning", "a recorded robot cannot be shown"
)
VIEWER_NOT_STARTED = Code("CW920", "viewer-not-started", "error", "the web interface did not start")
UPLOAD_REFUSED = Code(
    "CW921", "upload-refused", "error", "a file that was uploaded to the web interface was rejected"
)
VIEWER_FAULT = Code(
    "CW922", "viewer-fault", "error", "an unexpected error occurred in the web interface"
)
SCAN_NOT_SHOWN = Code(
    "CW923", "scan-not-shown", "warning", "the frame of a laser scan or point cloud is not a link"
)
