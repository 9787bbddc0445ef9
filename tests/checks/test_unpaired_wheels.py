"""Drives with different numbers of left and right wheels."""

import pytest
from tests.coded import coded
from tests.corpus.carts import cart, controlled, plugin, written

import cartwheel
from cartwheel.codes.devices import WHEELS_UNPAIRED

GZ = (
    '<gazebo><plugin name="d" filename="gz-sim-diff-drive-system"><left_joint>left_joint'
    "</left_joint>{more}<right_joint>right_joint</right_joint></plugin></gazebo>"
)
ANOTHER = "<left_joint>right_joint</left_joint>"


@pytest.mark.parametrize(("more", "number"), [("", 0), (ANOTHER, 1)])
def test_a_plugin_with_unpaired_wheels_is_reported_as_when_it_runs(tmp_path, more, number):
    path = written(tmp_path, cart(), GZ.format(more=more))
    found = coded(cartwheel.check(path).findings, WHEELS_UNPAIRED)
    with cartwheel.World("empty", lenient=True) as world:
        world.spawn(path)
        said = [each for each in world.diagnostics if each.values.get("left") == 2]
    assert len(said) == number
    assert [each.values["left"] for each in found] == [2] * number


def test_a_controller_with_unpaired_wheels_is_reported(tmp_path):
    text = controlled(tmp_path)
    file = tmp_path / "base.yaml"
    file.write_text(file.read_text().replace("[left_joint]", "[left_joint, front_joint]"))
    (found,) = coded(cartwheel.check(written(tmp_path, cart(), text)).findings, WHEELS_UNPAIRED)
    assert (found.values["left"], found.values["right"]) == (2, 1)
    assert found.origin is not None
    assert found.origin.file.endswith("base.yaml")
    sound = written(tmp_path, cart(), plugin())
    assert not coded(cartwheel.check(sound).findings, WHEELS_UNPAIRED)
