"""CW801 to CW899: ROS 1, ROS 2, Foxglove and network access."""

from cartwheel.errors import Code

ROS_ARGUMENT_INVALID = Code(
    "CW801",
    "ros-argument-invalid",
    "error",
    "a ROS argument is not `name:=value`, or contains an invalid name",
)
ROS_NODE_NAME_INVALID = Code(
    "CW802",
    "ros-node-name-invalid",
    "error",
    "ROS does not allow the name or namespace of the node",
)
ROS_URI_INVALID = Code(
    "CW803", "ros-uri-invalid", "error", "the address of the ROS master is invalid"
)
ROS_MASTER_UNAVAILABLE = Code(
    "CW804", "ros-master-unavailable", "error", "no ROS master responds, and none can be started"
)
ROS_MASTER_NOT_STARTED = Code(
    "CW805",
    "ros-master-not-started",
    "error",
    "the ROS master that Cartwheel started does not respond",
)
ROS_MASTER_LOST = Code("CW806", "ros-master-lost", "warning", "the ROS master stopped responding")
ROS_MASTER_BACK = Code("CW807", "ros-master-back", "warning", "a ROS master responds again")
ROS_NODE_ENDED = Code("CW808", "ros-node-ended", "warning", "ROS shut down the simulation's node")
ROS_CALL_FAILED = Code("CW809", "ros-call-failed", "error", "a call to a ROS master or node failed")
TYPE_UNSUPPORTED = Code(
    "CW810",
    "type-unsupported",
    "warning",
    "the type of a topic or service is not available through a bridge",
)
MALFORMED_MESSAGE = Code(
    "CW811",
    "malformed-message",
    "warning",
    "a message or request from another program cannot be decoded",
)
SLOW_SUBSCRIBER = Code(
    "CW812",
    "slow-subscriber",
    "warning",
    "a subscriber receives messages more slowly than they are published",
)
UNRESPONSIVE_SUBSCRIBER = Code(
    "CW813", "unresponsive-subscriber", "warning", "a subscriber no longer acknowledges messages"
)
PUBLISHED_TOO_FAST = Code(
    "CW814", "published-too-fast", "warning", "a topic is published faster than it can be sent"
)
INCOMING_DROPPED = Code(
    "CW815",
    "incoming-dropped",
    "warning",
    "messages arrive faster than the simulation processes them",
)
NETWORK_FULL = Code(
    "CW816", "network-full", "warning", "the operating system's send buffer is full"
)
PEER_LIMIT = Code(
    "CW817", "peer-limit", "warning", "there are too many connections, publishers or subscribers"
)
CALL_LIMIT = Code(
    "CW818",
    "call-limit",
    "warning",
    "too many service calls or result requests are waiting for a response",
)
PEER_ADDRESS_INVALID = Code(
    "CW819", "peer-address-invalid", "warning", "the address of a publisher is invalid"
)
PEER_TYPE_MISMATCH = Code(
    "CW820",
    "peer-type-mismatch",
    "warning",
    "another node uses a topic or service with a different type",
)
QOS_INCOMPATIBLE = Code(
    "CW821",
    "qos-incompatible",
    "warning",
    "a subscriber requests a stricter quality of service than is offered",
)
MESSAGE_NOT_SENT = Code(
    "CW822", "message-not-sent", "warning", "a message from the simulation cannot be encoded"
)
MESSAGE_TOO_LARGE = Code(
    "CW823", "message-too-large", "warning", "a message is too large for a bridge"
)
GOAL_REJECTED = Code("CW824", "goal-rejected", "warning", "an action goal was rejected")
ROS_VARIABLE_INVALID = Code(
    "CW825", "ros-variable-invalid", "error", "a ROS environment variable has an invalid value"
)
DOMAIN_FULL = Code(
    "CW826", "domain-full", "error", "the ROS domain has no free ports for another participant"
)
PACKAGE_MISSING = Code(
    "CW827", "package-missing", "error", "an option requires a Python package that is not installed"
)
ZENOH_NOT_OPENED = Code(
    "CW828",
    "zenoh-not-opened",
    "error",
    "Zenoh cannot open a session, or its configuration is invalid",
)
FOXGLOVE_NOT_STARTED = Code(
    "CW829", "foxglove-not-started", "error", "the Foxglove server does not start"
)
CLIENT_REQUEST_IGNORED = Code(
    "CW830",
    "client-request-ignored",
    "warning",
    "a request from a Foxglove client is malformed or exceeds a limit",
)
PARAMETER_REFUSED = Code(
    "CW831", "parameter-refused", "warning", "a client cannot set a parameter to this value"
)
MESSAGE_UNREAD = Code(
    "CW832", "message-unread", "warning", "a client publishes to a topic without subscribers"
)
SEEK_UNSUPPORTED = Code(
    "CW833", "seek-unsupported", "warning", "a running simulation cannot jump to a different time"
)
BRIDGE_FAULT = Code("CW834", "bridge-fault", "warning", "an unexpected error occurred in a bridge")
BRIDGE_ENDED = Code("CW835", "bridge-ended", "error", "a bridge process stopped unexpectedly")
BRIDGE_SLOW = Code(
    "CW836",
    "bridge-slow",
    "warning",
    "a bridge process does not respond or does not read its messages",
)
BRIDGE_RECOVERED = Code(
    "CW837", "bridge-recovered", "warning", "a bridge process has resumed reading its messages"
)
PAGE_REFUSED = Code(
    "CW838", "page-refused", "warning", "a web page from another origin was rejected"
)
ORIGIN_INVALID = Code(
    "CW839", "origin-invalid", "error", "the value of `--allow-origin` is not a valid origin"
)
ADDRESS_UNAVAILABLE = Code(
    "CW840", "address-unavailable", "error", "a server cannot listen on its host or port"
)
LOG_LEVEL_UNKNOWN = Code(
    "CW841", "log-level-unknown", "error", "ROS has no logger level with this name"
)
AUTOPILOT_PACKET_IGNORED = Code(
    "CW842", "autopilot-packet-ignored", "warning", "a packet is not from the connected autopilot"
)
AUTOPILOT_CONNECTED = Code("CW843", "autopilot-connected", "info", "an autopilot has connected")
AUTOPILOT_LOST = Code("CW844", "autopilot-lost", "warning", "an autopilot no longer sends packets")
AUTOPILOT_FRAMES_MISSED = Code(
    "CW845", "autopilot-frames-missed", "warning", "packets of an autopilot are missing"
)
