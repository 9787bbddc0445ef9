"""The turn rate of vehicles on tracks, and roots that nothing holds."""

import math

import pytest

from cartwheel import World

PART = (
    '<link name="{name}"><pose>0 {y} 0.05 0 0 0</pose><inertial><mass>{mass}</mass><inertia>'
    "<ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial><collision name='c'>"
    "<geometry><box><size>{length} {width} {height}</size></box></geometry></collision></link>"
)
TRACKS = ("left", "right")


def vehicle(efficiency):
    """One with two tracks of 0.4 m x 0.2 m, 0.6 m apart."""
    parts = [PART.format(name="base", y=0, mass=5, length=0.3, width=0.3, height=0.05)]
    for name, y in zip(TRACKS, (0.3, -0.3), strict=True):
        parts.append(PART.format(name=name, y=y, mass=3, length=0.4, width=0.2, height=0.1))
        parts.append(
            f'<joint name="{name}_joint" type="fixed"><parent>base</parent><child>{name}</child>'
            f'</joint><plugin name="{name}" filename="gz-sim-track-controller-system">'
            f"<link>{name}</link></plugin>"
        )
    sides = "".join(f"<{each}_track><link>{each}</link></{each}_track>" for each in TRACKS)
    parts.append(
        f'<plugin name="v" filename="gz-sim-tracked-vehicle-system">{sides}<tracks_separation>0.6'
        f"</tracks_separation><steering_efficiency>{efficiency}</steering_efficiency></plugin>"
    )
    return f'<sdf version="1.9"><model name="tank">{"".join(parts)}</model></sdf>'


def test_a_vehicle_turns_as_fast_as_is_reported(bench):
    # Corners 0.2 m ahead and 0.2 and 0.4 m to the side: 0.3 (r1 + r2) / (r1^2 + r2^2).
    (finding,) = bench.find(vehicle(0.5), "skid-steering", "x.sdf")
    near, far = math.hypot(0.2, 0.2), math.hypot(0.2, 0.4)
    fits = 0.3 * (near + far) / (near**2 + far**2)
    assert finding.values["ratio"] == pytest.approx(fits / 0.5)
    with World("empty") as world:
        model = world.spawn(vehicle(0.5))
        world.publish("/model/tank/cmd_vel", {"angular": {"z": 0.5}})
        world.run(1.0)
        before = model.pose.yaw
        world.run(1.0)
        assert model.pose.yaw - before == pytest.approx(0.5 * fits / 0.5, rel=0.02)
    assert not bench.find(vehicle(round(fits, 3)), "skid-steering", "x.sdf")


def classic(efficiency):
    """The same vehicle for Gazebo Classic."""
    head = vehicle(efficiency).partition("<plugin")[0]
    other = PART.format(name="right", y=-0.3, mass=3, length=0.4, width=0.2, height=0.1)
    sides = "".join(f"<{each}_track>{each}</{each}_track>" for each in TRACKS)
    return (
        f'{head}{other}<joint name="right_joint" type="fixed"><parent>base</parent><child>right'
        '</child></joint><plugin name="v" filename="libSimpleTrackedVehiclePlugin.so"><body>base'
        f"</body>{sides}<tracks_separation>0.6</tracks_separation><steering_efficiency>{efficiency}"
        "</steering_efficiency></plugin></model></sdf>"
    )


def test_a_vehicle_of_gazebo_classic_turns_as_fast_as_is_reported(bench):
    # Points have the part of the speed along their circle: 0.3 (y1 + y2) / (r1^2 + r2^2).
    (finding,) = bench.find(classic(0.5), "skid-steering", "x.sdf")
    fits = 0.3 * (0.2 + 0.4) / (0.2**2 + 0.2**2 + 0.2**2 + 0.4**2)
    assert finding.values["ratio"] == pytest.approx(fits / 0.5)
    with World("empty") as world:
        model = world.spawn(classic(0.5))
        world.publish("/tank/cmd_vel", {"angular": {"z": 0.4}})
        world.run(1.0)
        before = model.pose.yaw
        world.run(1.0)
        assert model.pose.yaw - before == pytest.approx(0.4 * fits / 0.5, rel=0.02)
    assert not bench.find(classic(round(fits, 3)), "skid-steering", "x.sdf")


BASE = """<robot name="r">{world}<link name="root"><inertial><mass value="{mass}"/>
<inertia ixx="1e-6" iyy="1e-6" izz="1e-6" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="base"><inertial><mass value="70"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="0.5 0.5 0.1"/></geometry></collision></link>
<joint name="turn" type="continuous"><parent link="root"/><child link="base"/><axis xyz="0 0 1"/>
</joint>
<ros2_control name="s" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin>
</hardware><joint name="turn"><command_interface name="velocity"/></joint></ros2_control>
<gazebo><plugin name="c" filename="libgz_ros2_control-system.so"/></gazebo></robot>"""
HELD = (
    '<link name="world"/><joint name="held" type="fixed"><parent link="world"/>'
    '<child link="root"/></joint>'
)


@pytest.mark.parametrize(("world", "mass", "found"), [("", 0.001, 1), (HELD, 0.001, 0), ("", 5, 0)])
def test_a_light_root_that_nothing_holds_is_reported(bench, world, mass, found):
    findings = bench.find(BASE.format(world=world, mass=mass), "root-not-held")
    assert len(findings) == found
    assert all(each.values["joints"] == ("turn",) for each in findings)


def test_tracks_that_are_wheels_need_joints_on_both_sides(bench):
    text = vehicle(0.5).partition("<plugin")[0] + (
        '<plugin name="v" filename="libWheelTrackedVehiclePlugin.so"><left_joint>left_joint'
        "</left_joint></plugin></model></sdf>"
    )
    (finding,) = bench.find(text, "plugin-parameter-missing", "x.sdf")
    assert finding.values["parameter"] == "right_joint"
