"""Unknown tags whose names are similar to valid ones."""

import pytest

import cartwheel
from cartwheel.codes.tags import TAG_IGNORED

INERTIA = '<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/>'
SIZES = 'm="1" x="0.1" y="0.1" z="0.1"'
XACRO = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'


def ignored(tmp_path, inertial, more="", *, shape="", name="robot.urdf.xacro"):
    path = tmp_path / name
    path.write_text(
        f'<robot name="robot" {XACRO}>{more}<link name="base"><inertial><mass value="1"/>{inertial}'
        '</inertial><collision><geometry><box size="0.3 0.3 0.3"/></geometry></collision>'
        f"{shape}</link></robot>"
    )
    return [each for each in cartwheel.check(path).findings if each.code is TAG_IGNORED]


@pytest.mark.parametrize(
    ("inertial", "fix"),
    [
        # There is a second <inertia>, and the attributes are others.
        (f"<box_inertia {SIZES}/>{INERTIA}", ""),
        (f"<box_inertia {SIZES}/>", ""),
        (INERTIA.replace("inertia ", "inerta ") + INERTIA, ""),
        (INERTIA.replace("inertia ", "inerta "), INERTIA),
    ],
)
def test_a_tag_is_renamed_only_if_its_attributes_fit_and_the_element_is_missing(
    tmp_path, inertial, fix
):
    (one,) = ignored(tmp_path, inertial)
    assert one.instead == fix


def test_a_second_collision_may_be_misspelt(tmp_path):
    shape = '<colision><geometry><box size="0.1 0.1 0.1"/></geometry></colision>'
    (one,) = ignored(tmp_path, INERTIA, shape=shape)
    assert one.instead == "<collision>"


def test_the_call_of_a_macro_without_prefixes_is_no_misspelt_tag(tmp_path):
    macro = f'<macro name="box_inertia" params="m x y z">{INERTIA}</macro>'
    (one,) = ignored(tmp_path, f"<box_inertia {SIZES}/>", macro)
    assert one.instead == f"<xacro:box_inertia {SIZES}/>"


@pytest.mark.parametrize("beside", [True, False])
def test_a_parameter_beside_its_plugin_is_said_to_belong_in_it(bench, beside):
    plugin = '<plugin name="c" filename="libgazebo_ros2_control.so"/>' * beside
    text = (
        f'<robot name="r"><link name="base"/><gazebo>{plugin}<parameters>c.yaml</parameters>'
        "</gazebo></robot>"
    )
    (found,) = [
        each for each in bench.find(text, "tag-ignored") if each.values["tag"] == "parameters"
    ]
    named = "libgazebo_ros2_control.so" if beside else None
    assert found.values.get("beside") == named
