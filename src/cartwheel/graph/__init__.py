"""Topics, services, actions and parameters within the process."""

from cartwheel.graph.action import Action, ActionListener, Goal, GoalState
from cartwheel.graph.actionlib import ActionTopics
from cartwheel.graph.graph import Graph
from cartwheel.graph.joint_inputs import JointInput
from cartwheel.graph.mailbox import Mailbox
from cartwheel.graph.names import (
    absolute_name,
    check_prefix,
    is_name,
    resolve_frame,
    resolve_name,
)
from cartwheel.graph.parameters import ParameterServer
from cartwheel.graph.reconfigure import ReconfigureParameter, ReconfigureServer, choices
from cartwheel.graph.renaming import TopicRenaming
from cartwheel.graph.responses import checked_handler, made_response
from cartwheel.graph.topic import (
    TWIST,
    TWIST_STAMPED,
    CheckedPublisher,
    Publisher,
    Qos,
    Service,
    Subscription,
    TakeValues,
    TopicInfo,
    made_message,
)

__all__ = [
    "TWIST",
    "TWIST_STAMPED",
    "Action",
    "ActionListener",
    "ActionTopics",
    "CheckedPublisher",
    "Goal",
    "GoalState",
    "Graph",
    "JointInput",
    "Mailbox",
    "ParameterServer",
    "Publisher",
    "Qos",
    "ReconfigureParameter",
    "ReconfigureServer",
    "Service",
    "Subscription",
    "TakeValues",
    "TopicInfo",
    "TopicRenaming",
    "absolute_name",
    "check_prefix",
    "checked_handler",
    "choices",
    "is_name",
    "made_message",
    "made_response",
    "resolve_frame",
    "resolve_name",
]
