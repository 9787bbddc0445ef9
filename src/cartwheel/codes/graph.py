"""CW701 to CW799: topics, services and messages."""

from cartwheel.errors import Code

TOPIC_UNKNOWN = Code("CW701", "topic-unknown", "error", "a topic that does not exist")
TOPIC_TYPE_MISMATCH = Code(
    "CW702", "topic-type-mismatch", "error", "a topic that is used with two types"
)
SERVICE_UNKNOWN = Code("CW703", "service-unknown", "error", "a service that does not exist")
SERVICE_TAKEN = Code(
    "CW704", "service-name-taken", "error", "a service or action whose name is already in use"
)
SERVICE_TIMED_OUT = Code(
    "CW705", "service-timed-out", "error", "a service that does not respond in time"
)
SERVICE_FAILED = Code("CW706", "service-failed", "warning", "a service request that failed")
ACTION_GONE = Code("CW707", "action-gone", "error", "an action that no longer exists")
GRAPH_NAME_INVALID = Code(
    "CW708", "graph-name-invalid", "error", "a topic, service or namespace with an invalid name"
)
GRAPH_CLOSED = Code("CW709", "graph-closed", "error", "a call to a simulation that has ended")
MESSAGE_TYPE_UNKNOWN = Code(
    "CW710", "message-type-unknown", "error", "a message or service type that does not exist"
)
FIELD_UNKNOWN = Code("CW711", "field-unknown", "error", "a field that a message type does not have")
FIELD_VALUE_INVALID = Code(
    "CW712", "field-value-invalid", "error", "a value that a message's field cannot hold"
)
MESSAGE_NOT_ENCODABLE = Code(
    "CW713", "message-not-encodable", "error", "a message that cannot be encoded"
)
MESSAGE_NOT_DECODABLE = Code(
    "CW714",
    "message-not-decodable",
    "error",
    "bytes that cannot be decoded as a message of their type",
)
MESSAGE_TEXT_INVALID = Code(
    "CW715", "message-text-invalid", "error", "a message on the command line that is not YAML"
)
PARAMETER_UNKNOWN = Code("CW716", "parameter-unknown", "error", "a parameter that does not exist")
PARAMETER_VALUE_INVALID = Code(
    "CW717", "parameter-value-invalid", "error", "an invalid parameter value"
)
ENTITY_UNKNOWN = Code(
    "CW718",
    "entity-unknown",
    "error",
    "a model, link, joint, light or frame in a service request that does not exist",
)
ENTITY_AMBIGUOUS = Code(
    "CW719",
    "entity-ambiguous",
    "error",
    "a name in a service request that is ambiguous or belongs to a different kind of entity",
)
ENTITY_NAME_TAKEN = Code(
    "CW720", "entity-name-taken", "error", "a model or light that is spawned under a name in use"
)
ENTITY_FIXED = Code(
    "CW721", "entity-fixed", "error", "a request to move or push something that is fixed"
)
PROPERTY_INVALID = Code(
    "CW722", "property-invalid", "error", "a physical property with an impossible value"
)
SPAWN_INVALID = Code("CW723", "spawn-invalid", "error", "a spawn request without a model to spawn")
REQUEST_UNSUPPORTED = Code(
    "CW724",
    "request-unsupported",
    "error",
    "a service request that asks for something the simulation does not support",
)
REQUEST_INVALID = Code(
    "CW725", "request-invalid", "error", "a service request with inconsistent or invalid fields"
)
FRAMES_SHARED = Code(
    "CW727",
    "frames-shared",
    "warning",
    "a robot whose frames have the same names as another robot's frames",
)
