"""Robots for gz-sim that gz-sim does not load, because no body can have the inertia of a link."""

import pytest

from cartwheel.codes.robot import INERTIA_IMPOSSIBLE
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
