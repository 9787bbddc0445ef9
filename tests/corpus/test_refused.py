"""Robots that Gazebo does not load, or only without parts of links."""

import pytest
from tests.corpus.carts import cart, plugin, written

from cartwheel.codes.robot import INERTIA_IMPOSSIBLE
from cartwheel.codes.tags import ELEMENT_LEFT_OUT, LINK_CUT_SHORT
from cartwheel.corpus import try_robot

GZ, CLASSIC = "gz-sim-joint-state-publisher-system", "libgazebo_ros_joint_state_publisher.so"
SHAPE = "<geometry><box><size>0.2 0.2 0.2</size></box></geometry>"
MODEL = (
    '<model name="m"><pose>0 0 0.1 0 0 0</pose><link name="base"><inertial><mass>1</mass><inertia>'
    "<ixx>0.01</ixx><iyy>0.01</iyy><izz>{}</izz></inertia></inertial>"
    f'<collision name="c">{SHAPE}</collision></link>'
    '<plugin name="p" filename="{}"/></model>'
)


@pytest.mark.parametrize("world", [False, True])
@pytest.mark.parametrize(
    ("izz", "plugin", "refused"),
    [(0.03, GZ, True), (0.03, CLASSIC, False), (0.01, GZ, False), (0.01, CLASSIC, False)],
)
def test_an_impossible_inertia_is_a_fault_only_for_gz_sim(tmp_path, world, izz, plugin, refused):
    model = MODEL.format(izz, plugin)
    path = tmp_path / "m.sdf"
    inner = f'<world name="w">{model}</world>' if world else model
    path.write_text(f'<sdf version="1.6">{inner}</sdf>')
    verdict = try_robot(path, standing=1.0, model="m" if world else "")
    assert verdict.loaded
    assert [(each.test, each.code) for each in verdict.faults] == (
        [("load", INERTIA_IMPOSSIBLE)] if refused else []
    )
    assert verdict.outcome == ("file" if refused else "good")


def test_a_urdf_for_gz_sim_is_refused_by_the_sum_of_merged_links(tmp_path):
    link = (
        '<link name="{}"><inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="{}" '
        'ixy="0" ixz="0" iyz="0"/></inertial>'
        '<collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>'
    )
    joint = '<joint name="j" type="fixed"><parent link="base"/><child link="lid"/></joint>'
    plugin = f'<gazebo><plugin name="p" filename="{GZ}"/></gazebo>'
    for base, faults in ((0.005, ["good"]), (0.015, ["file"])):
        path = tmp_path / "r.urdf"
        links = link.format("base", base) + link.format("lid", 0.03)
        path.write_text(f'<robot name="r">{links}{joint}{plugin}</robot>')
        assert [try_robot(path, standing=1.0).outcome] == faults


LID = (
    '<link name="lid">{}</link><joint name="lid_joint" type="fixed"><parent link="base"/>'
    '<child link="lid"/><origin xyz="0 0 0.1"/></joint>'
)
SMALL = '<geometry><box size="0.1 0.1 0.01"/></geometry>'
SHAPES = f"<visual>{SMALL}</visual><collision>{SMALL}</collision>"
POINT = '<mass value="0.01"/><inertia ixx="1e-5" iyy="1e-5" izz="1e-5"/>'


@pytest.mark.parametrize(
    ("lid", "code"),
    [
        (f"<inertial>{POINT}</inertial>{SHAPES}", LINK_CUT_SHORT),
        # Only the visual is lost.
        (f"<inertial>{POINT}</inertial><visual>{SMALL}</visual>", None),
        (SHAPES.replace("</visual>", "<material/></visual>"), ELEMENT_LEFT_OUT),
        (SHAPES, None),
    ],
)
def test_a_link_that_gazebo_loads_without_its_collisions_is_a_fault(tmp_path, lid, code):
    verdict = try_robot(written(tmp_path, cart(), LID.format(lid), plugin()), standing=1.0)
    assert [(each.test, each.code) for each in verdict.faults] == ([("load", code)] if code else [])
    assert verdict.outcome == ("file" if code else "good")
