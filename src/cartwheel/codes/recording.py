"""CW901 to CW999: recording, playback and the web interface."""

from cartwheel.errors import Code

RECORDING_UNREADABLE = Code(
    "CW901", "recording-unreadable", "error", "a recording that cannot be read from the disk"
)
NOT_A_RECORDING = Code(
    "CW902", "not-a-recording", "error", "a file or folder that is not a recording"
)
RECORDING_DAMAGED = Code(
    "CW903", "recording-damaged", "error", "a recording whose contents are damaged"
)
RECORDING_VERSION_UNKNOWN = Code(
    "CW904",
    "recording-version-unknown",
    "error",
    "a recording of a format version that is not supported",
)
RECORDING_NOT_WRITABLE = Code(
    "CW905", "recording-not-writable", "error", "a recording that cannot be written to its location"
)
RECORDING_EXISTS = Code(
    "CW906", "recording-exists", "error", "a recording whose file already exists"
)
RECORDING_NAME_INVALID = Code(
    "CW907",
    "recording-name-invalid",
    "error",
    "a file name without the extension of a recording format",
)
ENCODING_UNFIT = Code(
    "CW908",
    "encoding-unfit",
    "error",
    "a message encoding that a recording's format does not support",
)
RECORDING_BROKE_OFF = Code(
    "CW909", "recording-broke-off", "error", "a recording that ended before the simulation did"
)
TOPIC_PATTERN_INVALID = Code(
    "CW910", "topic-pattern-invalid", "error", "a topic pattern that is not a regular expression"
)
TOPIC_PATTERN_UNMATCHED = Code(
    "CW911", "topic-pattern-unmatched", "warning", "a topic pattern that matched no topic"
)
DISK_SLOW = Code("CW912", "disk-slow", "warning", "a disk that is slower than the simulation")
MESSAGE_NOT_RECORDED = Code(
    "CW913",
    "message-not-recorded",
    "warning",
    "messages that cannot be recorded in the recording's encoding",
)
RECORDING_SPLIT = Code(
    "CW914",
    "recording-split",
    "info",
    "a recording that continues in a new file because simulation time jumped back",
)
RECORDED_TYPE_UNUSABLE = Code(
    "CW915", "recorded-type-unusable", "error", "a recorded topic whose type cannot be used"
)
RECORDED_TOPIC_LEFT_OUT = Code(
    "CW916", "recorded-topic-left-out", "warning", "a recorded topic that is not played"
)
RECORDING_EMPTY = Code("CW917", "recording-empty", "error", "a recording without messages")
PLAYBACK_READ_ONLY = Code(
    "CW918", "playback-read-only", "error", "a change to the world during playback"
)
RECORDED_ROBOT_NOT_SHOWN = Code(
    "CW919", "recorded-robot-not-shown", "warning", "a recorded robot that cannot be shown"
)
VIEWER_NOT_STARTED = Code("CW920", "viewer-not-started", "error", "a viewer that did not start")
UPLOAD_REFUSED = Code(
    "CW921", "upload-refused", "error", "a file that was uploaded to the web interface and rejected"
)
VIEWER_FAULT = Code(
    "CW922", "viewer-fault", "error", "an unexpected error inside the web interface"
)
SCAN_NOT_SHOWN = Code(
    "CW923", "scan-not-shown", "warning", "sensor data whose frame is not a link of its robot"
)
