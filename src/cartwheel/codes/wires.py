"""CW801 to CW899: ROS 1, ROS 2, Foxglove and network access."""

from cartwheel.errors import Code

ROS_ARGUMENT_INVALID = Code(
    "CW801",
    "ros-argument-invalid",
    "error",
    "a ROS argument that is not `name:=value`, or is not a name that ROS can remap",
)
ROS_NODE_NAME_INVALID = Code(
    "CW802", "ros-node-name-invalid", "error", "a node name or namespace that ROS does not allow"
)
ROS_URI_INVALID = Code(
    "CW803", "ros-uri-invalid", "error", "an address of a ROS master that is not `http://host:port`"
)
ROS_MASTER_UNAVAILABLE = Code(
    "CW804",
    "ros-master-unavailable",
    "error",
    "a ROS master that does not respond and cannot be started",
)
ROS_MASTER_NOT_STARTED = Code(
    "CW805",
    "ros-master-not-started",
    "error",
    "a ROS master that the simulation started and that does not respond",
)
ROS_MASTER_LOST = Code(
    "CW806", "ros-master-lost", "warning", "a ROS master that stopped responding"
)
ROS_MASTER_BACK = Code("CW807", "ros-master-back", "warning", "a ROS master that responds again")
ROS_NODE_ENDED = Code(
    "CW808",
    "ros-node-ended",
    "warning",
    "a shutdown of the simulation's ROS node by ROS or by another node",
)
ROS_CALL_FAILED = Code(
    "CW809", "ros-call-failed", "error", "a call to a ROS master or node that got no valid response"
)
TYPE_UNSUPPORTED = Code(
    "CW810",
    "type-unsupported",
    "warning",
    "a topic or service whose type the other side does not support",
)
MALFORMED_MESSAGE = Code(
    "CW811",
    "malformed-message",
    "warning",
    "a message or request from another program that cannot be decoded",
)
SLOW_SUBSCRIBER = Code(
    "CW812",
    "slow-subscriber",
    "warning",
    "a subscriber that reads more slowly than messages are published",
)
UNRESPONSIVE_SUBSCRIBER = Code(
    "CW813",
    "unresponsive-subscriber",
    "warning",
    "a subscriber that no longer acknowledges messages",
)
PUBLISHED_TOO_FAST = Code(
    "CW814", "published-too-fast", "warning", "a topic that is published faster than it can be sent"
)
INCOMING_DROPPED = Code(
    "CW815",
    "incoming-dropped",
    "warning",
    "messages from other programs that arrive faster than the simulation processes them",
)
NETWORK_FULL = Code(
    "CW816",
    "network-full",
    "warning",
    "messages dropped because the operating system's send buffer is full",
)
PEER_LIMIT = Code(
    "CW817", "peer-limit", "warning", "more connections, publishers or subscribers than the limit"
)
CALL_LIMIT = Code(
    "CW818",
    "call-limit",
    "warning",
    "more concurrent service calls or result requests than the limit",
)
PEER_ADDRESS_INVALID = Code(
    "CW819", "peer-address-invalid", "warning", "a publisher whose address is invalid"
)
PEER_TYPE_MISMATCH = Code(
    "CW820",
    "peer-type-mismatch",
    "warning",
    "another node that uses a topic or service with a different type",
)
QOS_INCOMPATIBLE = Code(
    "CW821",
    "qos-incompatible",
    "warning",
    "another node that requests a quality of service that is not offered",
)
MESSAGE_NOT_SENT = Code(
    "CW822", "message-not-sent", "warning", "a message that cannot be encoded for the other side"
)
MESSAGE_TOO_LARGE = Code(
    "CW823", "message-too-large", "warning", "a message larger than a bridge can pass on"
)
GOAL_REJECTED = Code(
    "CW824", "goal-rejected", "warning", "an action goal that the simulation rejected"
)
ROS_VARIABLE_INVALID = Code(
    "CW825", "ros-variable-invalid", "error", "a ROS environment variable with an invalid value"
)
DOMAIN_FULL = Code(
    "CW826", "domain-full", "error", "a ROS domain without a free port for another participant"
)
PACKAGE_MISSING = Code(
    "CW827",
    "package-missing",
    "error",
    "an option that requires a Python package that is not installed",
)
ZENOH_NOT_OPENED = Code(
    "CW828",
    "zenoh-not-opened",
    "error",
    "a Zenoh session that cannot be opened, or its invalid configuration",
)
FOXGLOVE_NOT_STARTED = Code(
    "CW829", "foxglove-not-started", "error", "a Foxglove server that does not start"
)
CLIENT_REQUEST_IGNORED = Code(
    "CW830",
    "client-request-ignored",
    "warning",
    "a request or message from a Foxglove client that is malformed or exceeds a limit",
)
PARAMETER_REFUSED = Code(
    "CW831", "parameter-refused", "warning", "a parameter that a client may not set to this value"
)
MESSAGE_UNREAD = Code(
    "CW832", "message-unread", "warning", "a message to a topic without subscribers"
)
SEEK_UNSUPPORTED = Code(
    "CW833",
    "seek-unsupported",
    "warning",
    "a jump in time that a running simulation does not support",
)
BRIDGE_FAULT = Code("CW834", "bridge-fault", "warning", "an unexpected error inside a bridge")
BRIDGE_ENDED = Code("CW835", "bridge-ended", "error", "a bridge process that ended by itself")
BRIDGE_SLOW = Code(
    "CW836",
    "bridge-slow",
    "warning",
    "a bridge process that does not respond or does not read its messages",
)
BRIDGE_RECOVERED = Code(
    "CW837",
    "bridge-recovered",
    "warning",
    "a bridge process that reads again, after messages were dropped",
)
PAGE_REFUSED = Code(
    "CW838", "page-refused", "warning", "a web page of another origin that tried to connect"
)
ORIGIN_INVALID = Code(
    "CW839", "origin-invalid", "error", "an `--allow-origin` that is not an origin"
)
ADDRESS_UNAVAILABLE = Code(
    "CW840", "address-unavailable", "error", "a host or port on which a server cannot listen"
)
LOG_LEVEL_UNKNOWN = Code(
    "CW841", "log-level-unknown", "error", "a logger level that ROS does not have"
)
