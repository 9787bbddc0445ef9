"""Controller files with arguments, whose values the launch file of the robot would set."""

import pytest
from tests.corpus.carts import cart, controlled, written

from cartwheel.checks.checking import check
from cartwheel.codes.robot import WHEEL_SEPARATION_MISMATCH
from cartwheel.corpus import try_robot


@pytest.mark.parametrize("argument", ["$(arg prefix)", "$(var prefix)"])
def test_the_joints_of_a_controller_are_found_by_the_prefix_of_the_robot(tmp_path, argument):
    control = controlled(tmp_path, separation=0.4)
    path = written(
        tmp_path, cart().replace('"left', '"my_left'), control.replace('"left', '"my_left')
    )
    file = tmp_path / "base.yaml"
    file.write_text(file.read_text().replace("[left_joint]", f'["{argument}left_joint"]'))
    (found,) = [each for each in check(path).findings if each.code is WHEEL_SEPARATION_MISMATCH]
    assert found.values["joint"] == "my_left_joint"
    assert found.instead == "wheel_separation: 0.2"
    (fault,) = try_robot(path, standing=1.0).faults
    assert fault.code is WHEEL_SEPARATION_MISMATCH
