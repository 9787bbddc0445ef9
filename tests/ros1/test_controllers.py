"""The programs of the package controller_manager, against a robot of a running simulation."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from tests.ros1.conftest import PYTHON

URDF = """<robot name="arm"><link name="world"/>
  <link name="beam"><inertial><mass value="1"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="hinge" type="revolute"><parent link="world"/><child link="beam"/>
    <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="10" velocity="1"/></joint>
  <transmission name="t"><type>transmission_interface/SimpleTransmission</type>
    <joint name="hinge"><hardwareInterface>hardware_interface/PositionJointInterface
    </hardwareInterface></joint><actuator name="m"/></transmission>
  <gazebo><plugin name="control" filename="libgazebo_ros_control.so">
    <robotNamespace>/</robotNamespace></plugin></gazebo></robot>"""

HELD = "held: {type: position_controllers/JointPositionController, joint: hinge}\n"
TOLD = "reported: {type: joint_state_controller/JointStateController, publish_rate: 50}\n"
PARAMETERS = f"{HELD}{TOLD}controller_groups: {{both: [held, reported], quiet: [reported]}}\n"


WATCH = """
import json, sys, rospy
from controller_manager_msgs.srv import ListControllers
rospy.init_node("watch")
name = "/controller_manager/list_controllers"
rospy.wait_for_service(name)
ask = rospy.ServiceProxy(name, ListControllers, persistent=True)
for line in sys.stdin:
    print(json.dumps({each.name: each.state for each in ask().controller}), flush=True)
"""


class Programs:
    """Runs the programs, and asks for the states of controllers."""

    def __init__(self, ros: Any) -> None:
        self._ros = ros
        # A start of the first program for each question would take half a second.
        self.watch = ros.start(PYTHON, "-c", WATCH, stdin=subprocess.PIPE)

    def __call__(self, name: str, *words: str, status: int = 0) -> str:
        done = self._ros.run(self._path(name), *words, status=status)
        return str(done.stdout)

    def _path(self, name: str) -> Path:
        return Path(self._ros.overlay.program("controller_manager", name))

    def start(self, name: str, *words: str) -> subprocess.Popen[str]:
        process: subprocess.Popen[str] = self._ros.start(self._path(name), *words)
        return process

    def listed(self) -> dict[str, str]:
        """What the first program lists."""
        lines = [line for line in self("controller_manager", "list").splitlines() if "'" in line]
        return {line.split()[0].strip("'"): line.split()[-2] for line in lines}

    def until(self, **states: str) -> None:
        """Waits until these controllers are loaded, and no others."""

        def reached() -> bool:
            self.watch.stdin.write("\n")
            self.watch.stdin.flush()
            found: dict[str, str] = json.loads(self.watch.stdout.readline())
            return found == states

        self._ros.until(reached, f"{states} never came")


@pytest.fixture
def programs(ros: Any) -> Iterator[Programs]:
    ros.master()
    ros.run("rosparam", "set", "/", PARAMETERS)
    cartwheel = Path(sys.executable).with_name("cartwheel")
    ros.start(cartwheel, "run", "empty.world", "--headless", "--ros1",
              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)  # fmt: skip
    spawn = ros.overlay.program("gazebo_ros", "spawn_model")
    ros.run(spawn, "-urdf", "-stdin", "-model", "arm", input=URDF)
    made = Programs(ros)
    yield made
    # rospy leaves the end of a program to the program.
    made.watch.communicate(timeout=120)


def test_controllers_are_loaded_switched_and_taken_away(programs: Programs) -> None:
    assert programs("controller_manager", "load", "held") == "Loaded 'held'\n"
    programs.until(held="initialized")
    assert programs("controller_manager", "start", "held") == "Started 'held'\n"
    programs.until(held="running")
    programs("controller_group", "spawn", "quiet")
    programs.until(held="stopped", reported="running")
    assert programs.listed() == {"held": "stopped", "reported": "running"}
    programs("controller_group", "switch", "both")
    programs.until(held="running", reported="running")
    assert programs("controller_group", "list") == (
        "both (running): held, reported\nquiet (running): reported\n"
    )
    away = programs.start("unspawner", "held")
    programs.until(held="stopped", reported="running")
    end(away)
    programs.until(held="running", reported="running")
    programs("controller_manager", "kill", "held", "reported")
    programs.until()
    assert programs.listed() == {}
    spawner = programs.start("spawner", "held", "reported")
    programs.until(held="running", reported="running")
    end(spawner)
    programs.until()


def test_rosrun_finds_them(ros: Any) -> None:
    for name in ("controller_manager", "controller_group", "spawner", "unspawner"):
        shown = ros.run("rosrun", "--prefix", "echo", "controller_manager", name).stdout
        assert shown.strip() == str(ros.overlay.program("controller_manager", name))


def test_what_cannot_be_done_is_reported(programs: Programs) -> None:
    assert "could not load 'nothing'" in programs("controller_manager", "load", "nothing", status=1)
    programs("controller_manager", "juggle", status=1)
    programs("controller_group", "switch", "nobody", status=1)
    programs("spawner", status=2)


def end(process: subprocess.Popen[str]) -> None:
    """As roslaunch ends it."""
    time.sleep(0.2)
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=120)
