"""Calls of a controller manager's services in launch files."""

import time

import pytest

from cartwheel.description.launches.controllers import by_service, by_spawner, shell_commands
from cartwheel.description.launches.effort import UNKNOWN

SWITCH = "/controller_manager/switch_controller"
LOAD = "/controller_manager/load_controller"


@pytest.mark.parametrize(
    ("request_", "started"),
    [
        ("{deactivate_controllers: ['a'], activate_controllers: ['b', c]}", ("b", "c")),
        ("{stop_controllers: [a], start_controllers: [b]}", ("b",)),
        ("{deactivate_controllers: ['a']}", ()),
    ],
)
def test_controllers_that_a_request_stops_do_not_start(request_, started):
    found = by_service([SWITCH, "controller_manager_msgs/srv/SwitchController", request_])
    assert found is not None
    assert (found.started, found.unsure) == (started, False)


@pytest.mark.parametrize(
    "words",
    [
        [SWITCH, "start_controllers: - 'a' stop_controllers: []"],
        [SWITCH, f"start_controllers: [{UNKNOWN}]"],
        [LOAD, f"name: '{UNKNOWN}'"],
        [LOAD, f"{{name: left{UNKNOWN}}}"],
        [LOAD, UNKNOWN],
        ["/controller_manager/load_and_start_controller", UNKNOWN],
    ],
)
def test_a_request_whose_controllers_are_unknown(words):
    found = by_service(words)
    assert found is not None
    assert (found.started, found.loaded, found.unsure) == ((), (), True)


@pytest.mark.parametrize("part", ["start_controllers:[", "start_controllers:", "[", "name "])
def test_a_long_request_takes_no_minutes(part):
    start = time.thread_time()
    by_service([SWITCH, part * 10_000])
    by_service([LOAD, part * 10_000])
    assert time.thread_time() - start < 1.0


@pytest.mark.parametrize("word", ["exec", "bash", "-x", "'"])
def test_a_long_command_takes_no_minutes(word):
    start = time.thread_time()
    assert [*shell_commands(["bash", *[word] * 50_000, "exec; true"])][-1] == ["true"]
    assert time.thread_time() - start < 1.0


def test_a_spawner_with_a_file_starts_controllers_whose_names_are_unknown():
    """ROS 1's spawner loads a YAML file and starts the controllers in it."""
    assert by_spawner(["/ws/config/joints.yaml"], "").unsure
    assert not by_spawner(["joint_state_controller"], "").unsure
