"""CW701 to CW799: topics, services and messages."""

from cartwheel.errors import Code

TOPIC_UNKNOWN = Code("CW701", "topic-unknown", "error", "the topic does not exist")
TOPIC_TYPE_MISMATCH = Code(
    "CW702", "topic-type-mismatch", "error", "a topic is used with two types"
)
SERVICE_UNKNOWN = Code("CW703", "service-unknown", "error", "the service does not exist")
SERVICE_TAKEN = Code(
    "CW704", "service-name-taken", "error", "the name of a service or action is already in use"
)
SERVICE_TIMED_OUT = Code("CW705", "service-timed-out", "error", "a service did not respond in time")
SERVICE_FAILED = Code("CW706", "service-failed", "warning", "a service request failed")
ACTION_GONE = Code("CW707", "action-gone", "error", "an action no longer exists")
GRAPH_NAME_INVALID = Code(
    "CW708", "graph-name-invalid", "error", "the name of a topic, service or namespace is invalid"
)
GRAPH_CLOSED = Code("CW709", "graph-closed", "error", "the simulation has ended")
MESSAGE_TYPE_UNKNOWN = Code(
    "CW710", "message-type-unknown", "error", "a message or service type does not exist"
)
FIELD_UNKNOWN = Code(
    "CW711", "field-unknown", "error", "a message type does not have a field with this name"
)
FIELD_VALUE_INVALID = Code(
    "CW712", "field-value-invalid", "error", "a value does not match its message field"
)
MESSAGE_NOT_ENCODABLE = Code(
    "CW713", "message-not-encodable", "error", "a message cannot be encoded"
)
MESSAGE_NOT_DECODABLE = Code(
    "CW714", "message-not-decodable", "error", "a message cannot be decoded"
)
MESSAGE_TEXT_INVALID = Code(
    "CW715", "message-text-invalid", "error", "a message on the command line is not valid YAML"
)
PARAMETER_UNKNOWN = Code("CW716", "parameter-unknown", "error", "a parameter does not exist")
PARAMETER_VALUE_INVALID = Code(
    "CW717", "parameter-value-invalid", "error", "the value of a parameter is invalid"
)
ENTITY_UNKNOWN = Code(
    "CW718",
    "entity-unknown",
    "error",
    "a model, link, joint, light or frame in a service request does not exist",
)
ENTITY_AMBIGUOUS = Code(
    "CW719",
    "entity-ambiguous",
    "error",
    "a name in a service request is ambiguous, or is the name of a different kind of entity",
)
ENTITY_NAME_TAKEN = Code(
    "CW720", "entity-name-taken", "error", "the name of a new model or light is already in use"
)
ENTITY_FIXED = Code(
    "CW721", "entity-fixed", "error", "a request moves a link or joint that cannot move"
)
PROPERTY_INVALID = Code(
    "CW722",
    "property-invalid",
    "error",
    "a request sets a physical property to an impossible value",
)
SPAWN_INVALID = Code(
    "CW723", "spawn-invalid", "error", "a spawn request does not contain exactly one model"
)
REQUEST_UNSUPPORTED = Code(
    "CW724", "request-unsupported", "error", "a service request uses an unsupported feature"
)
REQUEST_INVALID = Code(
    "CW725",
    "request-invalid",
    "error",
    "the fields of a service request are invalid or contradict each other",
)
FRAMES_SHARED = Code(
    "CW727", "frames-shared", "warning", "two robots have frames with the same names"
)
MESSAGE_DEFINITION_INVALID = Code(
    "CW728", "message-definition-invalid", "error", "a .msg, .srv or .action file is invalid"
)
MESSAGE_TYPE_BUILT_IN = Code(
    "CW729",
    "message-type-built-in",
    "warning",
    "a package defines a built-in message type with other fields",
)
MESSAGE_DEFINITIONS_DIFFER = Code(
    "CW730",
    "message-definitions-differ",
    "warning",
    "two packages with the same name define a message type differently",
)
MESSAGE_TYPE_IN_USE = Code(
    "CW731",
    "message-type-in-use",
    "error",
    "the process already uses a message type with the same name and other fields",
)
NO_MESSAGE = Code("CW732", "no-message", "error", "a topic has no message yet")
ARRAY_INVALID = Code(
    "CW733", "array-invalid", "error", "the data of a message cannot be converted to an array"
)
ACTION_UNKNOWN = Code("CW734", "action-unknown", "error", "an action does not exist")
TOPICS_SHARED = Code(
    "CW735", "topics-shared", "warning", "two models publish on or subscribe to the same topics"
)
FRAME_UNKNOWN = Code(
    "CW736", "transform-frame-unknown", "error", "a frame of a transform does not exist"
)
FRAMES_NOT_CONNECTED = Code(
    "CW737", "frames-not-connected", "error", "no transforms connect two frames"
)
TRANSFORM_TIME = Code(
    "CW738", "transform-time", "error", "a transform is not known at the requested time"
)
DELAYED_LOST = Code(
    "CW739", "delayed-messages-lost", "warning", "more messages are delayed than can be held"
)
