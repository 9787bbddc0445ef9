"""Numbers with text after them, as libsdformat reads them."""

import pytest

from cartwheel.codes.tags import TEXT_AFTER_NUMBER
from cartwheel.description import load_robot
from cartwheel.errors import DescriptionError

BOX = "<geometry><box><size>1 1 1</size></box></geometry>"


def loaded(tmp_path, link: str):
    file = tmp_path / "model.sdf"
    file.write_text(
        f'<sdf version="1.7"><model name="m"><link name="l">{link}</link></model></sdf>'
    )
    return load_robot(file)


def stated(robot) -> list[str]:
    return [
        str(each.values["used"]) for each in robot.diagnostics if each.code is TEXT_AFTER_NUMBER
    ]


@pytest.mark.parametrize(
    ("text", "color"),
    [
        ("0.05 0.35. 1. 1", (0.05, 0.35, 1.0, 1.0)),
        ("0.3a .5 0.25b", (0.3, 0.5, 0.25, 1.0)),
        ("1e 0,5 0 1", (1.0, 0.0, 0.0, 1.0)),
        ("0x0.8 0 0 1", (0.5, 0.0, 0.0, 1.0)),
    ],
)
def test_each_word_of_a_color_is_read_by_itself(tmp_path, text, color):
    material = f"<material><diffuse>{text}</diffuse></material>"
    robot = loaded(tmp_path, f'<visual name="v">{BOX}{material}</visual>')
    assert robot.links[0].visuals[0].material.diffuse == color
    assert len(stated(robot)) == 1


@pytest.mark.parametrize(
    ("text", "mass"), [("0x10", 16.0), ("1e", 1.0), ("5kg", 5.0), ("2.5.1", 2.5), ("0x1p3", 8.0)]
)
def test_a_single_number_may_be_hexadecimal_or_have_an_incomplete_exponent(tmp_path, text, mass):
    robot = loaded(tmp_path, f"<inertial><mass>{text}</mass></inertial>")
    assert robot.links[0].inertial.mass == mass
    assert len(stated(robot)) == 1


@pytest.mark.parametrize("text", ["1. 0.5. 2 0 0 0k", "1e 0x0.8 2,5 0 0 0"])
def test_each_word_of_a_pose_is_read_by_itself(tmp_path, text):
    robot = loaded(tmp_path, f"<pose>{text}</pose>")
    assert robot.links[0].pose.position == (1.0, 0.5, 2.0)
    assert len(stated(robot)) == 1


def test_numbers_without_text_after_them_are_not_reported(tmp_path):
    robot = loaded(
        tmp_path,
        "<pose>1 2 3 0 0 0</pose><inertial><mass>2e0</mass></inertial>"
        f'<visual name="v">{BOX}<material><diffuse>1 0 .5</diffuse></material></visual>',
    )
    assert not stated(robot)


@pytest.mark.parametrize("text", ["1. 0.5. 1", "0x10 1 1", "1 1 1e"])
def test_the_words_of_a_vector_are_not_read_by_themselves(tmp_path, text):
    box = f"<geometry><box><size>{text}</size></box></geometry>"
    with pytest.raises(DescriptionError):
        loaded(tmp_path, f'<collision name="c">{box}</collision>')


@pytest.mark.parametrize("text", ["a 0 0 1", "0 0", "1e400 0 0 1"])
def test_a_word_that_begins_with_no_number_is_an_error(tmp_path, text):
    material = f"<material><diffuse>{text}</diffuse></material>"
    with pytest.raises(DescriptionError):
        loaded(tmp_path, f'<visual name="v">{BOX}{material}</visual>')
