"""The sliders of an arm's joints in a real browser."""

import pytest
import yaml
from tests.dialects.ros_control.arms import ROS1, beam, robot, transmission
from tests.viewer.conftest import eventually

from cartwheel.description import load_text
from cartwheel.geometry import Pose


@pytest.fixture
def arm(page, arena, tmp_path):
    parameters = tmp_path / "arm.yaml"
    parameters.write_text(
        yaml.safe_dump(
            {
                "arm_controller": {
                    "type": "position_controllers/JointTrajectoryController",
                    "joints": ["beam_joint"],
                }
            }
        )
    )
    urdf = robot(beam("beam", "world", axis="0 0 1") + transmission("beam_joint", "Position"), ROS1)
    description = load_text(urdf, file=str(tmp_path / "arm.urdf"))

    def spawn():
        arena.session.spawn(description, pose=Pose((-2.0, 0.0, 0.0)), controllers=[parameters])

    arena.ask(spawn)
    yield lambda: arena.ask(lambda: arena.simulation.joint_position("arm", "beam_joint"))
    arena.ask(lambda: arena.simulation.delete("arm"))


def test_a_slider_moves_its_joint_and_follows_it(page, arena, arm):
    page.get_by_role("tab", name="Joints").click()
    slider = page.get_by_role("slider")
    slider.wait_for()
    assert page.get_by_text("arm_controller").is_visible()

    def shown():
        return float(slider.get_attribute("aria-valuenow"))

    def pressed():
        slider.press("End")
        return shown() > 0.2

    # The first key may come before the page listens to the slider.
    eventually(pressed, what="the slider's way")
    eventually(lambda: arm() > 0.2 and abs(arm() - shown()) < 0.01, what="the joint")
    (taker,) = arena.graph.joint_inputs.all()
    arena.ask(lambda: taker.put({"beam_joint": -1.0}, 1.0))
    eventually(lambda: abs(shown() + 1.0) < 0.02, what="the slider")
    page.get_by_text("World", exact=True).click()


def test_without_an_arm_the_page_says_so(page):
    page.get_by_role("tab", name="Joints").click()
    page.get_by_text("No controller accepts joint positions.").wait_for()
    assert page.get_by_role("slider").count() == 0
    page.get_by_text("World", exact=True).click()
