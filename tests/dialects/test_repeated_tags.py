"""Tags of plugins that are stated several times, of which Gazebo reads the first."""

import pytest
from tests.corpus.carts import cart, plugin, written

import cartwheel
from cartwheel.api import World
from cartwheel.codes.tags import TAG_REPEATED

RATE = "<updateRate>20</updateRate>\n<updateRate>{}</updateRate>"


@pytest.mark.parametrize(
    ("more", "repeated"),
    [
        (RATE.format(10), True),
        (RATE.format(" 20 "), False),
        (RATE.format("20.0"), False),
        ("<robotBaseFrame>base</robotBaseFrame>", False),
    ],
)
def test_a_tag_that_is_repeated_with_another_value_is_reported(tmp_path, more, repeated):
    path = written(tmp_path, cart(), "\n", plugin(separation=0.2, more=more))
    for found in (cartwheel.check(path).findings, spawned(path)):
        ours = [each for each in found if each.code is TAG_REPEATED]
        assert [each.origin.line for each in ours] == [3] * repeated
        assert [each.values["used"] for each in ours] == ["20"] * repeated


def test_tags_that_a_plugin_reads_several_times_are_not_reported(tmp_path):
    joints = "".join(f"<joint_name>{name}_joint</joint_name>" for name in ("left", "right"))
    publisher = (
        '<gazebo><plugin name="j" filename="gz-sim-joint-state-publisher-system">'
        f"{joints}</plugin></gazebo>"
    )
    path = written(tmp_path, cart(), publisher)
    assert not [each for each in cartwheel.check(path).findings if each.code is TAG_REPEATED]


def spawned(path):
    with World("empty", lenient=True) as world:
        world.spawn(path)
        return world.diagnostics
