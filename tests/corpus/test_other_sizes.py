"""Wrong sizes of several drives, of which one receives the commands on a topic."""

import pytest
from tests.corpus.carts import cart, controlled, plugin, written

from cartwheel.codes.robot import UNBALANCED, WHEEL_DIAMETER_MISMATCH, WHEEL_SEPARATION_MISMATCH
from cartwheel.codes.running import JOINT_DRIVEN_TWICE
from cartwheel.corpus import try_robot
from cartwheel.corpus.causes.drives import cause_of_drive
from cartwheel.corpus.drive_topics import without_other_sizes
from cartwheel.description import load_robot

OWN = {"stated": 0.4, "measured": 0.2}


def test_a_size_in_a_file_that_nothing_loads_does_not_explain_a_plugin(tmp_path):
    (tmp_path / "package.xml").write_text("<package><name>cart</name></package>")
    path = written(tmp_path, cart(), plugin(0.4))
    controlled(tmp_path, 0.4)
    verdict = try_robot(path, standing=1.0)
    (fault,) = verdict.faults
    assert (fault.test, fault.code) == ("turn", WHEEL_SEPARATION_MISMATCH)
    assert fault.reason is not None
    assert fault.reason.origin.file == str(path)


def test_each_topic_has_the_sizes_of_its_own_drive(tmp_path):
    robot = load_robot(written(tmp_path, cart(), plugin(0.4), controlled(tmp_path)))
    drive = next(tag for tag in robot.plugins if tag.name == "drive")
    of_plugin = WHEEL_SEPARATION_MISMATCH.diagnostic("", origin=drive.origin, values=OWN)
    of_base, of_other = (
        WHEEL_SEPARATION_MISMATCH.diagnostic("", values={**OWN, "controller": name})
        for name in ("base", "other")
    )
    tilts = UNBALANCED.diagnostic("")
    found = [of_plugin, of_base, of_other, tilts]
    chosen = {
        topic: without_other_sizes(found, topic, robot, ["base"])
        for topic in ("/cmd_vel", "/base/cmd_vel", "/other_topic")
    }
    assert chosen["/cmd_vel"] == [of_plugin, tilts]
    assert chosen["/base/cmd_vel"] == [of_base, tilts]
    assert chosen["/other_topic"] == found
    # The file of a single controller does not state its name.
    unnamed = [of_plugin, of_other, tilts]
    assert without_other_sizes(unnamed, "/base/cmd_vel", robot, ["base"]) == [of_other, tilts]


WHEEL = WHEEL_DIAMETER_MISMATCH.diagnostic("", values={"stated": 0.2, "measured": 0.0325})
TILTS = UNBALANCED.diagnostic("")
TWICE = JOINT_DRIVEN_TWICE.diagnostic("")


@pytest.mark.parametrize(
    ("found", "ratio", "reason"),
    [
        ([TILTS, WHEEL], 0.122, WHEEL),
        # The size explains the smaller part.
        ([TILTS, WHEEL], 0.03, TILTS),
        ([TILTS, WHEEL], 0.7, TILTS),
        ([TILTS, WHEEL], 0.0, TILTS),
        ([WHEEL], 0.122, None),
        ([TWICE, WHEEL], 0.122, TWICE),
    ],
)
def test_a_size_that_explains_most_of_an_error_comes_first(found, ratio, reason):
    assert cause_of_drive(found, ratio) is reason
