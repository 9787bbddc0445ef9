"""The program spawn_model: spawns a model from a file, a ROS parameter or standard input."""

from __future__ import annotations

import argparse
import contextlib
import math
import signal
import sys
from pathlib import Path
from types import FrameType
from typing import Any
from urllib.parse import urlsplit
from xml.etree import ElementTree

XACRO = "xacro"
"""Part of the XML namespace of xacro elements."""

DATABASE_SDF = """\
<?xml version="1.0"?>
<sdf version="1.6">
  <world name="default">
    <include>
      <uri>model://{}</uri>
    </include>
  </world>
</sdf>
"""


class SpawnError(Exception):
    """The model cannot be spawned."""


def main() -> int:
    """Runs the program; returns its exit status."""
    # Before rospy is imported, which takes long, so that an invalid option is reported immediately.
    arguments = parse([word for word in sys.argv[1:] if ":=" not in word])
    import rospy

    # Flush each line, also to a pipe.
    sys.stdout.reconfigure(line_buffering=True)
    # Use wall time, because simulation time may be paused. Do not use rospy's signal handler: its
    # log call waits for a lock that the interrupted thread may hold.
    rospy.init_node("spawn_model", anonymous=True, disable_rostime=True, disable_signals=True)
    signal.signal(signal.SIGTERM, _interrupt)
    signal.signal(signal.SIGINT, _interrupt)
    try:
        run(arguments)
    except SpawnError as failure:
        rospy.logfatal(str(failure))
        return 1
    except (rospy.ROSInterruptException, KeyboardInterrupt):
        print("spawn_model was interrupted before the model was spawned", file=sys.stderr)
        return 1
    return 0


def _interrupt(_number: int, _frame: FrameType | None) -> None:
    raise KeyboardInterrupt


def parse(words: list[str]) -> argparse.Namespace:
    """Parses the same arguments as Gazebo's program. Exits with status 2 if they are invalid."""
    parser = argparse.ArgumentParser(
        prog="spawn_model",
        description="Spawns a model in the running simulation.",
        allow_abbrev=False,
    )
    kind = parser.add_mutually_exclusive_group(required=True)
    kind.add_argument("-urdf", action="store_true", help="spawn a URDF model")
    kind.add_argument("-sdf", action="store_true", help="spawn an SDF model")
    source = parser.add_mutually_exclusive_group(required=True)
    source.add_argument("-file", metavar="FILE", help="read the model from a file")
    source.add_argument("-param", metavar="NAME", help="read the model from a ROS parameter")
    source.add_argument(
        "-database",
        metavar="MODEL",
        help="spawn a model from the folders in GAZEBO_MODEL_PATH, or a model that is included "
        "with Cartwheel; nothing is downloaded",
    )
    source.add_argument("-stdin", action="store_true", help="read the model from standard input")
    add = parser.add_argument
    add("-model", required=True, metavar="NAME", help="name of the model in the world")
    add("-reference_frame", default="", metavar="NAME", help="model or link that the pose is"
        " relative to (default: the world)")  # fmt: skip
    add("-gazebo_namespace", default="/gazebo", metavar="NAME", help="namespace of the services")
    add(
        "-robot_namespace",
        metavar="NAME",
        help="namespace of the topics (default: that of the node)",
    )
    add("-unpause", action="store_true", help="resume the simulation after the model is spawned")
    add("-wait", metavar="MODEL", help="wait until this model is in the world")
    for name, what in (("x", "position in m"), ("y", None), ("z", None)):
        add("-" + name, type=_number, default=0.0, metavar="M", help=what)
    for name, what in (("R", "roll in rad"), ("P", "pitch in rad"), ("Y", "yaw in rad")):
        add("-" + name, type=_number, default=0.0, metavar="RAD", help=what)
    add("-J", dest="joints", nargs=2, action="append", default=[], metavar=("JOINT", "POSITION"),
        help="set a joint to a position in rad or m; can be repeated")  # fmt: skip
    add(
        "-package_to_model", action="store_true", help="replace package:// by model:// in mesh URIs"
    )
    add(
        "-b",
        dest="bond",
        action="store_true",
        help="keep running, and delete the model when interrupted",
    )
    arguments = parser.parse_args(words)
    try:
        arguments.joints = [(name, _number(position)) for name, position in arguments.joints]
    except ValueError as error:
        parser.error(f"argument -J: {error}")
    return arguments


def run(arguments: argparse.Namespace) -> None:
    """Spawns the model. The node must be initialized.

    Raises:
        SpawnError: The model cannot be spawned.
    """
    import rospy

    from gazebo_ros import gazebo_interface

    gazebo = arguments.gazebo_namespace.rstrip("/")
    if arguments.wait:
        _wait_for_model(gazebo, arguments.wait)
    text = checked(*_text(arguments))
    if arguments.package_to_model:
        text = with_model_uris(text)
    namespace = arguments.robot_namespace
    if namespace is None:
        namespace = rospy.get_namespace()
    spawn = (
        gazebo_interface.spawn_urdf_model_client
        if arguments.urdf
        else gazebo_interface.spawn_sdf_model_client
    )
    if not spawn(
        arguments.model, text, namespace, _pose(arguments), arguments.reference_frame, gazebo
    ):
        message = f"{arguments.model} was not spawned"
        if arguments.database:
            message += (
                ". -database searches the folders in the simulation's GAZEBO_MODEL_PATH and the "
                "models that are included with Cartwheel; nothing is downloaded"
            )
        raise SpawnError(message)
    if arguments.joints:
        names, positions = zip(*arguments.joints, strict=False)
        if not gazebo_interface.set_model_configuration_client(
            arguments.model, "", list(names), list(positions), gazebo
        ):
            raise SpawnError(f"{arguments.model} was spawned, but its joints were not set")
    if arguments.unpause:
        from std_srvs.srv._Empty import Empty

        rospy.loginfo("Resuming the simulation")
        if gazebo_interface.call(gazebo + "/unpause_physics", Empty) is None:
            raise SpawnError(f"{arguments.model} was spawned, but the simulation was not resumed")
    if arguments.bond:
        rospy.on_shutdown(lambda: _delete(gazebo, arguments.model))
        with contextlib.suppress(KeyboardInterrupt):
            rospy.loginfo(f"Press Ctrl-C to delete {arguments.model}")
            rospy.spin()
        rospy.signal_shutdown("interrupted")


def checked(text: str, place: str) -> str:
    """Returns the text of a description unchanged.

    Args:
        text: Text of the description.
        place: File or source of the text, for error messages.

    Raises:
        SpawnError: The text is empty, is not valid XML, or contains xacro elements.
    """
    if not text.strip():
        raise SpawnError(f"{place} is empty")
    try:
        root = _parsed(text)
    except ElementTree.ParseError as error:
        line, column = error.position
        raise SpawnError(f"{place}:{line}:{column + 1}: invalid XML: {error}") from None
    for element in root.iter():
        if element.tag.startswith("{") and XACRO in element.tag.partition("}")[0]:
            raise SpawnError(
                f"{place} is a xacro file, which must be expanded first: "
                "rosrun xacro xacro FILE | rosrun gazebo_ros spawn_model -stdin …"
            )
    return text


def with_model_uris(text: str) -> str:
    """Replaces ``package://`` by ``model://`` in mesh URIs."""
    root = _parsed(text)
    for mesh in root.iter("mesh"):
        uri = mesh.get("filename")
        if uri is not None and urlsplit(uri).scheme == "package":
            mesh.set("filename", "model" + uri[len("package") :])
    return ElementTree.tostring(root, encoding="unicode")


def quaternion(roll: float, pitch: float, yaw: float) -> tuple[float, float, float, float]:
    """Returns (x, y, z, w) of rotations about the fixed x, y and z axes, in this order."""
    cr, sr = math.cos(roll / 2), math.sin(roll / 2)
    cp, sp = math.cos(pitch / 2), math.sin(pitch / 2)
    cy, sy = math.cos(yaw / 2), math.sin(yaw / 2)
    return (
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    )


def _parsed(text: str) -> ElementTree.Element:
    # The text is already decoded, so the encoding in its XML declaration must not be used.
    return ElementTree.fromstring(text.encode(), ElementTree.XMLParser(encoding="utf-8"))  # noqa: S314


def _number(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(f"{text} is not a finite number")
    return value


def _text(arguments: argparse.Namespace) -> tuple[str, str]:
    import rospy

    if arguments.file:
        rospy.loginfo(f"Loading the model from the file {arguments.file}")
        return _read(Path(arguments.file)), arguments.file
    if arguments.param:
        name = rospy.resolve_name(arguments.param)
        rospy.loginfo(f"Loading the model from the parameter {name}")
        value = rospy.get_param(arguments.param, None)
        if value is None:
            raise SpawnError(f"the parameter {name} does not exist")
        if not isinstance(value, str):
            raise SpawnError(f"the parameter {name} must be a string")
        return value, name
    if arguments.database:
        rospy.loginfo(f"Loading the model {arguments.database} from the simulation's models")
        return DATABASE_SDF.format(arguments.database), "-database"
    rospy.loginfo("Loading the model from standard input")
    return sys.stdin.read(), "standard input"


def _read(path: Path) -> str:
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        raise SpawnError(f"{path}: no such file in {Path.cwd()}") from None
    except OSError as error:
        raise SpawnError(f"{path}: {error.strerror}") from None
    encoding = "utf-8"
    head = data[:200].partition(b"?>")[0]
    if head.lstrip().startswith(b"<?xml") and b"encoding" in head:
        quoted = head.partition(b"encoding")[2].replace(b"'", b'"').split(b'"')
        encoding = quoted[1].decode("ascii", "replace") if len(quoted) > 1 else encoding
    try:
        return data.decode(encoding)
    except (LookupError, UnicodeDecodeError) as error:
        raise SpawnError(f"{path}: {error}") from None


def _pose(arguments: argparse.Namespace) -> Any:
    from geometry_msgs.msg import Point, Pose, Quaternion

    return Pose(
        position=Point(arguments.x, arguments.y, arguments.z),
        orientation=Quaternion(*quaternion(arguments.R, arguments.P, arguments.Y)),
    )


def _wait_for_model(gazebo: str, model: str) -> None:
    import rospy
    from gazebo_msgs.srv._GetWorldProperties import GetWorldProperties

    from gazebo_ros import gazebo_interface

    rospy.loginfo(f"Waiting for the model {model}")
    while not rospy.is_shutdown():
        world = gazebo_interface.call(gazebo + "/get_world_properties", GetWorldProperties)
        if world is not None and model in world.model_names:
            return
        # Wall time, because the simulation may be paused.
        rospy.rostime.wallsleep(0.1)
    raise rospy.ROSInterruptException


def _delete(gazebo: str, model: str) -> None:
    import rospy
    from gazebo_msgs.srv._DeleteModel import DeleteModel

    rospy.loginfo(f"Deleting the model {model}")
    try:
        answer = rospy.ServiceProxy(gazebo + "/delete_model", DeleteModel)(model)
    except rospy.ServiceException as error:
        rospy.logerr(f"{model} was not deleted: {error}")
        return
    if not answer.success:
        rospy.logerr(f"{model} was not deleted: {answer.status_message}")
