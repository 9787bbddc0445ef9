"""Each type that a topic or a service has in ROS 1 is known to ROS 1's own programs."""

import json
import re
from pathlib import Path

from cartwheel.errors import UnknownNameError
from cartwheel.messages.ros1 import ros1_service, ros1_type
from cartwheel.messages.store import DEFINITIONS, is_ros2_only

SOURCE = Path(__file__).parents[2] / "src" / "cartwheel"

# Why ROS 1's programs do not know a package. Nothing else may be unknown to them.
NOT_IN_DEBIAN = "Debian has no such package; the robot's own workspace has it"
UNKNOWN = dict.fromkeys(
    (
        "four_wheel_steering_msgs",
        "gazebo_grasp_plugin_ros",
        "gazebo_ros_link_attacher",
        "hector_gazebo_plugins",
        "hector_uav_msgs",
        "kobuki_msgs",
        "mav_msgs",
        "unitree_legged_msgs",
    ),
    NOT_IN_DEBIAN,
)

LOOK = """
import json, sys
import rosmsg
from roslib.message import get_message_class, get_service_class
found = {}
for kind, name in json.load(sys.stdin):
    get = get_message_class if kind == "msg" else get_service_class
    text = rosmsg.get_msg_text if kind == "msg" else rosmsg.get_srv_text
    try:
        made = get(name)
        text(name)
        found[name] = made._md5sum if made else "no class"
    except Exception as error:
        found[name] = "%s: %s" % (type(error).__name__, error)
print(json.dumps(found))
"""


def offered() -> dict[str, tuple[str, str]]:
    """Kind and md5 sum of the types that the sources name or define, by ROS 1's name."""
    named = {
        name
        for file in SOURCE.rglob("*.py")
        for name in re.findall(r'"(\w+/(?:msg|srv)/\w+)"', file.read_text())
    }
    named |= {
        str(file.relative_to(DEFINITIONS).with_suffix("")) for file in DEFINITIONS.glob("*/*/*.*")
    }
    found = {}
    for name in sorted(named):
        if name.startswith("builtin_interfaces/") or is_ros2_only(name):
            continue
        kind = name.split("/")[1]
        try:
            known = ros1_service(name) if kind == "srv" else ros1_type(name)
        except UnknownNameError:
            continue  # ROS 2's, or one half of a service.
        found[known.name] = (kind, known.md5)
    return found


def test_ros1s_programs_know_the_types(ros):
    types = offered()
    assert len(types) > 150
    assert {"gazebo_msgs/SpawnModel", "dynamic_reconfigure/Reconfigure"} <= set(types)
    asked = json.dumps([(kind, name) for name, (kind, _) in types.items()])
    found = json.loads(ros.run("/usr/bin/python3", "-c", LOOK, input=asked).stdout)
    packages = {name.split("/")[0] for name in types}
    assert set(UNKNOWN) <= packages
    missing = {
        name: found[name]
        for name, (_, md5) in types.items()
        if found[name] != md5 and name.split("/")[0] not in UNKNOWN
    }
    assert not missing, json.dumps(missing, indent=1)


def test_packages_that_are_named_as_unknown_are(ros):
    """A package that Debian gets is to be installed."""
    for package in UNKNOWN:
        done = ros.run("rospack", "find", package, status=None)
        assert done.returncode != 0, f"{package} is installed: take it from the list"


def test_reconfigure_works_with_rosservice_and_rostopic(ros):
    run = ros.start("rosrun", "gazebo_ros", "gzserver", "empty.world", stdout=-3, stderr=-3)
    ros.until(
        lambda: "/gazebo/set_parameters" in ros.services,
        "the service",
    )
    reported = ros.run("rostopic", "echo", "-n", "1", "/gazebo/parameter_updates").stdout
    assert "time_step" in reported
    answer = ros.run(
        *("rosservice", "call", "/gazebo/set_parameters"),
        "{config: {doubles: [{name: max_update_rate, value: 500.0}]}}",
    ).stdout
    assert re.search(r'name: "max_update_rate"\n\s+value: 500', answer)
    assert run.poll() is None
