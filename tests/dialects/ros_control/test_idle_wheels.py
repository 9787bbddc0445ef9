"""Wheels that no controller commands: braked by their motor, or free without one."""

import pytest
from tests.dialects.ros_control.arms import ros2_plugin
from tests.dialects.ros_control.cars import RADIUS, car, four_wheels


@pytest.mark.parametrize(("effort", "turns"), [("0", True), ("5", False)])
def test_a_wheel_without_effort_is_not_braked_before_its_controller_starts(
    make, tmp_path, effort, turns
):
    """As in gz-sim, whose joints apply no more than the stated effort."""
    limit = f'<limit effort="{effort}" velocity="50"/>'
    text = car(four_wheels(), ros2_plugin(tmp_path / "none.yaml"), "front_left_joint").replace(
        '<axis xyz="0 1 0"/></joint>', f'<axis xyz="0 1 0"/>{limit}</joint>'
    )
    (tmp_path / "none.yaml").write_text("controller_manager: {ros__parameters: {update_rate: 100}}")
    (tmp_path / "car.urdf").write_text(text)
    world = make.world()
    model = world.spawn(tmp_path / "car.urdf", z=RADIUS)
    model.push(force=(20.0, 0, 0), seconds=0.5)
    world.run(0.5)
    assert (abs(model.joint("front_left_joint")) > 0.5) == turns
