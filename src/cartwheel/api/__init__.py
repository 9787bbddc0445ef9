"""The Python API: worlds, models and simulation time."""

from cartwheel.api.built import Built, build
from cartwheel.api.calling import Goal
from cartwheel.api.exchange.actions import ActionServer, ReceivedGoal
from cartwheel.api.exchange.faults import Fault
from cartwheel.api.exchange.lockstep import Lockstep
from cartwheel.api.exchange.serving import ServiceServer
from cartwheel.api.joints import Joint, Joints
from cartwheel.api.launching import launch
from cartwheel.api.links import Link
from cartwheel.api.model import Model
from cartwheel.api.motion import Acceleration, Twist
from cartwheel.api.pictures import Picture
from cartwheel.api.plots import Plot
from cartwheel.api.properties.joint_values import JointValues
from cartwheel.api.properties.of_joints import Gains
from cartwheel.api.recordings import RecordedMessage, Recording
from cartwheel.api.surroundings.contacts import Contact
from cartwheel.api.surroundings.distances import Clearance, Hit
from cartwheel.api.surroundings.lights import Light
from cartwheel.api.surroundings.recorded_contacts import ContactRecord, RecordedContact
from cartwheel.api.timing import Timer
from cartwheel.api.topics import Hold, Topic
from cartwheel.api.world import World
from cartwheel.description.model import RobotDescription, WorldDescription
from cartwheel.graph import CheckedPublisher as Publisher
from cartwheel.graph import Mailbox, Subscription
from cartwheel.messages.times import Stamp, seconds
from cartwheel.saving import State

__all__ = [
    "Acceleration",
    "ActionServer",
    "Built",
    "Clearance",
    "Contact",
    "ContactRecord",
    "Fault",
    "Gains",
    "Goal",
    "Hit",
    "Hold",
    "Joint",
    "JointValues",
    "Joints",
    "Light",
    "Link",
    "Lockstep",
    "Mailbox",
    "Model",
    "Picture",
    "Plot",
    "Publisher",
    "ReceivedGoal",
    "RecordedContact",
    "RecordedMessage",
    "Recording",
    "RobotDescription",
    "ServiceServer",
    "Stamp",
    "State",
    "Subscription",
    "Timer",
    "Topic",
    "Twist",
    "World",
    "WorldDescription",
    "build",
    "launch",
    "seconds",
]
