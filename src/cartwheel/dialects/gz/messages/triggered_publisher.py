"""``gz-sim-triggered-publisher-system``: publishes messages when another one arrives."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, ClassVar

from cartwheel.description.model import Element
from cartwheel.devices.triggers.trigger import (
    Match,
    Trigger,
    TriggerConfig,
    TriggeredMessage,
    part_of,
)
from cartwheel.dialects.gz.bridge_file import namespaced
from cartwheel.dialects.gz.messages.text_format import TextFormatError, parse_text_format
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import invalid, missing, number, required, tag
from cartwheel.errors import CartwheelError, PluginError
from cartwheel.messages import from_dict

TYPES = {
    "Actuators": "actuator_msgs/msg/Actuators",
    "Boolean": "std_msgs/msg/Bool",
    "Color": "std_msgs/msg/ColorRGBA",
    "Double": "std_msgs/msg/Float64",
    "Empty": "std_msgs/msg/Empty",
    "Float": "std_msgs/msg/Float32",
    "Int32": "std_msgs/msg/Int32",
    "Int64": "std_msgs/msg/Int64",
    "Pose": "geometry_msgs/msg/Pose",
    "Quaternion": "geometry_msgs/msg/Quaternion",
    "StringMsg": "std_msgs/msg/String",
    "Twist": "geometry_msgs/msg/Twist",
    "UInt32": "std_msgs/msg/UInt32",
    "UInt64": "std_msgs/msg/UInt64",
    "Vector3d": "geometry_msgs/msg/Vector3",
    "Wrench": "geometry_msgs/msg/Wrench",
}
"""ROS's types of Gazebo's messages with the same fields, as in ros_gz_bridge."""
_TOLERANCE = 1e-8
_LONGEST_DELAY = 1e9
"""ms."""


@dataclass(frozen=True, kw_only=True, slots=True)
class TriggeredPublisherParameters:
    input: str = tag(
        "input",
        nested=True,
        doc="Message that triggers the others, with the attributes `type`, such as "
        "`gz.msgs.Twist`, and `topic`. It may contain `<match>` tags, all of which must match: a "
        "message in text format, or the value of the field in the attribute `field`. `tol` is the "
        'tolerance of numbers, and `logic_type="negative"` negates.',
    )
    output: tuple[str, ...] = tag(
        "output",
        default=(),
        nested=True,
        doc="Message that is published, in text format such as `linear: {x: 0.5}`, with the "
        "attributes `type` and `topic`. Repeat the tag for several.",
    )
    delay: float = tag(
        "delay_ms",
        default=0.0,
        unit="ms",
        least=0.0,
        most=_LONGEST_DELAY,
        doc="Simulation time between the input and the outputs.",
    )


class TriggeredPublisher(Plugin[TriggeredPublisherParameters]):
    """Publishes messages when a message arrives that matches.

    It belongs in a model or in a world. Of Gazebo's message types, those are supported whose fields
    are the same in ROS. `<service>` is not supported. Original plugin: ``TriggeredPublisher`` in
    gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-triggered-publisher-system",)
    also_in_world: ClassVar[bool] = True

    def configure(self) -> None:
        element = self.tag.element
        source = required(element, "input")
        topic, kind = self._ends(source)
        outputs = []
        for each in element.find_all("output"):
            to, made = self._ends(each)
            outputs.append(TriggeredMessage(topic=to, type=made, message=_message(made, each)))
        self.add(
            Trigger(
                self.scope,
                TriggerConfig(
                    topic=topic,
                    type=kind,
                    matches=tuple(_matches(kind, source)),
                    outputs=tuple(outputs),
                    delay=self.config.delay * 1e-3,
                ),
            )
        )

    def _ends(self, element: Element) -> tuple[str, str]:
        """The topic and ROS's type of an input or output.

        Raises:
            PluginError: The topic is missing, or the type is not supported.
        """
        topic, kind = (element.attribute(name) or "" for name in ("topic", "type"))
        if not topic.strip():
            raise missing(element.tag, "topic", element.origin)
        words = kind.strip().split(".")
        if words[-1] not in TYPES or words[:-1] not in ([], ["gz", "msgs"], ["ignition", "msgs"]):
            names = ", ".join(f"gz.msgs.{name}" for name in TYPES)
            raise invalid(element.tag, kind, f"a message of a type such as {names}", element.origin)
        return namespaced(topic, self.part.namespace), TYPES[words[-1]]


def _matches(kind: str, source: Element) -> Iterator[Match]:
    """The conditions on a message.

    Raises:
        PluginError: A message or a field does not fit the type.
    """
    for each in source.find_all("match"):
        field = (each.attribute("field") or "").strip()
        path = tuple(field.split(".")) if field else ()
        tolerance = each.attribute("tol")
        yield Match(
            path=path,
            wanted=_field(kind, path, each) if path else _message(kind, each),
            negated=(each.attribute("logic_type") or "").strip() == "negative",
            tolerance=_TOLERANCE
            if tolerance is None
            else number(replace(each, text=tolerance), least=0.0),
        )


def _message(kind: str, element: Element) -> Any:
    """Returns the message in an element.

    Raises:
        PluginError: The text is not a message of this type.
    """
    try:
        return from_dict(kind, parse_text_format(element.text.strip()))
    except (TextFormatError, CartwheelError) as error:
        raise _unfit(kind, element, str(error)) from None


def _field(kind: str, path: tuple[str, ...], element: Element) -> Any:
    """Returns the value of a field in an element; a list for repeated fields.

    Raises:
        PluginError: The type has no such field, or the text is not a value of it.
    """
    text = element.text.strip()
    failure = ""
    for written in (f"value: {text}", f"value {{ {text} }}"):
        try:
            value = parse_text_format(written)["value"]
        except TextFormatError as error:
            failure = failure or str(error)
            continue
        # Of a repeated field, it is one of the values.
        for candidate in (value, [value]):
            nested: Any = candidate
            for name in reversed(path):
                nested = {name: nested}
            try:
                return part_of(from_dict(kind, nested), path)
            except CartwheelError as error:
                failure = failure or error.message
    raise _unfit(kind, element, failure)


def _unfit(kind: str, element: Element, why: str) -> PluginError:
    return invalid(
        element.tag, element.text.strip(), f"in text format and fit {kind}: {why}", element.origin
    )
