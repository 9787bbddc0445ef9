"""Controllers whose names programs and instructions contain."""

from cartwheel.dialects.ros_control.launched import mentions
from cartwheel.dialects.ros_control.launched.mentions import started_by_others

NAMES = ("arm_controller", "left/wheel")


def repository(folder, **texts):
    (folder / ".git").mkdir()
    for name, text in texts.items():
        (folder / f"{name}.md").write_text(text)
    return folder / "robot.urdf"


def test_names_in_instructions_that_start_controllers(tmp_path):
    robot = repository(
        tmp_path,
        one="ros2 control switch_controllers --activate arm_controller",
        two="rosservice call /controller_manager/load_controller wheel",
    )
    assert started_by_others(robot, NAMES) == {*NAMES}


def test_names_in_other_texts_and_within_words(tmp_path):
    robot = repository(
        tmp_path, one="The arm_controller has gains.", two="spawner my_arm_controller wheels"
    )
    assert started_by_others(robot, NAMES) == frozenset()


def test_the_number_of_bytes_is_limited(tmp_path, monkeypatch):
    robot = repository(tmp_path, a="spawner arm_controller", b="x" * 100, c="spawner wheel")
    monkeypatch.setattr(mentions, "_MOST_BYTES", 100)
    assert started_by_others(robot, NAMES) == {"arm_controller"}
