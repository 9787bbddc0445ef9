"""Planes on links that can move, and settings that have no effect on the physics."""

import pytest

from cartwheel.checks import check
from cartwheel.codes.world import PHYSICS_SETTING_IGNORED, PLANE_NOT_STATIC

PLANE = '<collision name="c"><geometry><plane/></geometry></collision>'
MODEL = (
    '<sdf version="1.7"><model name="m">{0}<link name="frame">{1}</link><link name="floor">{2}'
    '</link><joint name="held" type="{3}"><parent>{4}</parent><child>frame</child></joint>'
    '<joint name="laid" type="{5}"><parent>frame</parent><child>floor</child>'
    "<axis><xyz>0 0 1</xyz></axis></joint></model></sdf>"
)
LOOSE = '<sdf version="1.7"><model name="m">{0}<link name="floor">{1}{2}</link></model></sdf>'


@pytest.fixture
def found(tmp_path):
    def run(text, code, name="m.sdf"):
        path = tmp_path / name
        path.write_text(text)
        return [each for each in check(path).findings if each.code is code]

    return run


@pytest.mark.parametrize(
    ("text", "link"),
    [
        (MODEL.format("", "", PLANE, "fixed", "world", "fixed"), None),
        (MODEL.format("", "", PLANE, "fixed", "world", "revolute"), "floor"),
        (MODEL.format("", PLANE, "", "fixed", "world", "revolute"), None),
        (MODEL.format("", PLANE, "", "revolute", "world", "fixed"), "frame"),
        (LOOSE.format("", "", PLANE), "floor"),
        (LOOSE.format("<static>true</static>", "", PLANE), None),
        (LOOSE.format("", "<kinematic>true</kinematic>", PLANE), None),
        (LOOSE.format("", "", PLANE.replace("<plane/>", "<sphere><radius>1</radius></sphere>")),
         None),
    ],
)  # fmt: skip
def test_a_plane_of_a_link_that_can_move_is_reported(found, text, link):
    reported = found(text, PLANE_NOT_STATIC)
    assert [each.values["link"] for each in reported] == ([] if link is None else [link])
    assert all(each.severity == "error" for each in reported)


def test_the_planes_of_each_model_of_a_world_are_looked_at(found):
    models = [LOOSE.format("", "", PLANE), LOOSE.format("<static>1</static>", "", PLANE)]
    inner = "\n".join(
        text.removeprefix('<sdf version="1.7">').removesuffix("</sdf>").replace('"m"', f'"m{n}"')
        for n, text in enumerate(models)
    )
    text = f'<sdf version="1.7"><world name="w">\n{inner}</world></sdf>'
    (each,) = found(text, PLANE_NOT_STATIC, "w.world")
    assert each.origin.line == 2


BOX = (
    '<collision name="{}"><geometry><box><size>1 1 1</size></box></geometry>'
    "<surface><friction><ode><slip1>0.1</slip1></ode></friction>"
    "<contact><ode><min_depth>0.001</min_depth><max_vel>0.1</max_vel></ode></contact></surface>"
    "</collision>"
)


def test_settings_without_effect_are_notes_each_once_in_a_world(found):
    models = "".join(
        f'<model name="m{n}"><link name="a"><velocity_decay><linear>0.1</linear></velocity_decay>'
        f"{BOX.format('c')}{BOX.format('d')}</link></model>"
        for n in range(2)
    )
    reported = found(
        f'<sdf version="1.6"><world name="w">{models}</world></sdf>',
        PHYSICS_SETTING_IGNORED,
        "w.world",
    )
    # The parameters of ODE's solver are left out.
    assert {each.values["setting"]: each.values["count"] for each in reported} == {
        "slip1": 4,
        "velocity decay": 2,
    }
    assert {each.severity for each in reported} == {"info"}


JOINT = (
    '<link name="arm"/><joint name="j" type="revolute"><parent link="base"/><child link="arm"/>'
    '<axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="5" velocity="2"/></joint>'
)


def test_the_velocity_limit_that_urdf_requires_is_not_reported(found):
    text = f'<robot name="r"><link name="base"/>{JOINT}</robot>'
    assert found(text, PHYSICS_SETTING_IGNORED, "r.urdf") == []
    tag = '<gazebo reference="base"><dampingFactor>0.1</dampingFactor></gazebo></robot>'
    (each,) = found(text.replace("</robot>", tag), PHYSICS_SETTING_IGNORED, "r.urdf")
    assert each.values["setting"] == "velocity decay"
