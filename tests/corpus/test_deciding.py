"""Verdicts on robots that fail because of a mistake in their files and for an unknown reason."""

import pytest
from tests.corpus.carts import cart, plugin, written

from cartwheel.codes.devices import (
    CONTROLLER_UNDEFINED,
    CONTROLLERS_NOT_FOUND,
    PLUGIN_UNKNOWN,
)
from cartwheel.codes.files import DESCRIPTION_NOT_EXPANDED, INCLUDE_ABSENT
from cartwheel.codes.robot import WHEEL_SEPARATION_MISMATCH
from cartwheel.codes.running import CONTROLLER_NOT_STARTED, PLUGIN_LEFT_OUT
from cartwheel.corpus import Fault, Verdict, try_robot

UNKNOWN = Fault(test="plugin", subject="mover", reason=PLUGIN_UNKNOWN.diagnostic("unsupported"))
HIDDEN = Fault(test="plugin", reason=INCLUDE_ABSENT.diagnostic("absent"), sure=False)
UNREAD = Fault(test="load")


def fault(test, code, **more):
    return Fault(test=test, subject="x", reason=code.diagnostic("a mistake"), **more)


@pytest.mark.parametrize(
    ("known", "decides"),
    [
        (fault("load", DESCRIPTION_NOT_EXPANDED), True),
        (fault("load", DESCRIPTION_NOT_EXPANDED, sure=False), False),
        (fault("controller", CONTROLLER_UNDEFINED), True),
        (fault("publish", PLUGIN_LEFT_OUT), True),
        # What is not supported may move the robot instead.
        (fault("controller", CONTROLLERS_NOT_FOUND), False),
        # Its hardware may be what is not supported.
        (fault("controller", CONTROLLER_NOT_STARTED), False),
        (fault("plugin", PLUGIN_LEFT_OUT), False),
        # It may drive otherwise with what is not supported.
        (fault("turn", WHEEL_SEPARATION_MISMATCH), False),
    ],
)
def test_a_mistake_that_does_not_depend_on_what_is_unknown_decides(tmp_path, known, decides):
    file = tmp_path / "robot.urdf"
    alone = Verdict(file=file, faults=(known,))
    both = Verdict(file=file, faults=(UNKNOWN, known))
    assert alone.outcome == ("file" if known.sure else "unknown")
    assert both.outcome == ("file" if decides else "unknown")
    for hidden in (HIDDEN, UNREAD):
        assert Verdict(file=file, faults=(hidden, known)).outcome == "unknown"


MOVER = '<gazebo><plugin name="m" filename="libmy_mover.so"/></gazebo>'
P3D = MOVER.replace("my_mover", "gazebo_ros_p3d").replace("/>", "><bodyName>{}</bodyName></plugin>")


@pytest.mark.parametrize(
    ("mover", "body", "outcome"),
    [
        (plugin(), "base", "good"),
        (plugin(), "bse", "file"),
        (MOVER, "base", "unknown"),
        (MOVER, "bse", "file"),
    ],
)
def test_a_plugin_that_measures_on_no_link_publishes_nothing(tmp_path, mover, body, outcome):
    verdict = try_robot(written(tmp_path, cart(), mover, P3D.format(body)), standing=0.5)
    assert verdict.outcome == outcome
    found = [each.subject for each in verdict.faults if each.test == "publish"]
    assert found == ["gazebo_ros_p3d"] * (body != "base")


def test_a_link_may_be_in_a_file_that_is_absent(tmp_path):
    include = (
        '<xacro:include xmlns:xacro="http://www.ros.org/wiki/xacro" '
        'filename="$(find my_absent_sensors)/sensor.xacro"/>'
    )
    robot = written(tmp_path, cart(), plugin(), include, P3D.format("sensor"))
    (found,) = (each for each in try_robot(robot, standing=0.5).faults if each.test == "publish")
    assert (found.code, found.source) == (PLUGIN_LEFT_OUT, "unknown")
