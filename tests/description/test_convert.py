"""URDF as text: complete, clean, stable."""

from tests.coded import raises

from cartwheel.codes.files import WRONG_KIND
from cartwheel.description import load_robot, load_text
from cartwheel.description.convert import to_urdf

SDF = '<sdf version="1.6"><model name="m"><link name="l"/></model></sdf>'


def test_the_cart_says_the_same_as_urdf():
    text = to_urdf("rosbots.xacro")
    again, cart = load_text(text, file="rosbots.urdf"), load_robot("rosbots.xacro")
    assert [link.name for link in again.links] == [link.name for link in cart.links]
    assert [link.pose for link in again.links] == [link.pose for link in cart.links]
    assert again.mass == cart.mass
    assert again.text == text == cart.text


def test_text_is_clean_and_stable():
    text = to_urdf("rosbots.xacro")
    assert text == to_urdf("rosbots.xacro")
    assert text.startswith('<?xml version="1.0"?>\n<robot name="rosbots">\n')
    assert "xacro" not in text
    assert "package://rosbots_description/meshes/" in text


def test_files_by_where_they_lie():
    text = to_urdf("rosbots.xacro", absolute=True)
    assert "package://" not in text
    assert "file:///" in text
    load_text(text)


def test_special_characters_survive(tmp_path):
    path = tmp_path / "r.urdf"
    path.write_text(
        '<robot name="a &amp; &quot;b&quot;"><link name="l"/><gazebo>'
        "<plugin name='p' filename='f'><x>1 &lt; 2</x></plugin></gazebo></robot>"
    )
    text = to_urdf(path)
    robot = load_text(text)
    assert robot.name == 'a & "b"'
    assert robot.plugins[0].element.find("x").text == "1 < 2"


def test_sdf_is_none(tmp_path):
    path = tmp_path / "m.sdf"
    path.write_text(SDF)
    with raises(WRONG_KIND, kind="sdf"):
        to_urdf(path)
