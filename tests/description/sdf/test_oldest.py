"""SDF 1.0 to 1.2: attributes that became elements, and what has another name since."""

import pytest
from tests.coded import raises

import cartwheel as cw
from cartwheel.codes import tags
from cartwheel.description import load_text

_OLD = """<{root} version="{version}"><world name="w">
<physics type="ode" update_rate="500"><gravity xyz="0 0 -3"/>
  <ode><solver type="quick" dt="0.002" iters="10" sor="1.3"/>
  <constraints cfm="0" erp="0.2" contact_max_correcting_vel="100" contact_surface_layer="0"/></ode>
</physics>
<scene><ambient rgba="0.1 0.2 0.3 1"/><background rgba="0.4 0.5 0.6 1"/><shadows enabled="false"/>
</scene>
<light type="point" name="lamp" cast_shadows="false"><origin pose="0 0 7 0 0 0"/>
  <diffuse rgba="0.5 0.5 0.5 1"/><attenuation range="20" linear="0.1" constant="0.2" quadratic="0"/>
</light>
<model name="ground" static="true"><link name="l"><collision name="c">
  <geometry><plane normal="0 0 1"/></geometry>
  <surface><friction><ode mu="0.3" mu2="0.3" slip1="0" slip2="0"/></friction></surface></collision>
</link></model>
<model name="arm"><origin pose="1 2 0.5 0 0 0"/>
  <link name="base" gravity="true" self_collide="false">
    <inertial mass="4"><origin pose="0 0 0.1 0 0 0"/>
      <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.15"/></inertial>
    <collision name="c" laser_retro="7"><origin pose="0 0 0.2 0 0 0"/>
      <geometry><box size="0.5 0.5 0.5"/></geometry></collision>
    <visual name="v" cast_shadows="true"><geometry><cylinder radius="0.2" length="0.6"/></geometry>
      <material script="Gazebo/Red"/></visual>
    <sensor name="ranger" type="ray" always_on="1" update_rate="30">
      <origin pose="0 0 1 0 0 0"/>
      <ray><scan><horizontal samples="9" resolution="1" min_angle="-1" max_angle="1"/></scan>
        <range min="0.1" max="9" resolution="0.01"/></ray></sensor>
    <sensor name="eye" type="camera" update_rate="10"><camera>
      <horizontal_fov angle="1.2"/><image width="32" height="24" format="R8G8B8"/>
      <clip near="0.2" far="30"/></camera></sensor>
  </link>
  <link name="bar"><origin pose="0 0 0.5 0 0 0"/>
    <inertial mass="1"><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
  </link>
  <joint name="hinge" type="revolute"><parent link="base"/><child link="bar"/>
    <axis xyz="0 1 0"><dynamics damping="0.4" friction="0"/>
      <limit lower="-1" upper="2" effort="5" velocity="6"/></axis></joint>
  <plugin name="p" filename="libgazebo_ros_p3d.so"><bodyName>base</bodyName></plugin>
</model>
</world></{root}>"""


@pytest.mark.parametrize(("root", "version"), [("gazebo", "1.0"), ("sdf", "1.1"), ("sdf", "1.2")])
def test_a_world_of_attributes(root, version):
    world = load_text(_OLD.format(root=root, version=version), file="w")
    assert world.gravity == (0, 0, -3)
    assert world.physics.max_step_size == 0.002
    assert world.physics.real_time_update_rate == 500
    assert world.ambient[:3] == (0.1, 0.2, 0.3)
    assert world.background[:3] == (0.4, 0.5, 0.6)
    assert not world.shadows
    (lamp,) = world.lights
    assert (lamp.pose.position, lamp.range, lamp.attenuation) == ((0, 0, 7), 20, (0.2, 0.1, 0))
    ground, arm = world.models
    assert ground.static
    assert ground.links[0].collisions[0].surface.mu1 == 0.3
    assert arm.pose.position == (1, 2, 0.5)
    base, bar = arm.links
    assert (base.inertial.mass, base.inertial.iyy) == (4, 0.2)
    assert base.inertial.pose.position == (0, 0, 0.1)
    assert base.collisions[0].shape.size == (0.5, 0.5, 0.5)
    assert base.collisions[0].pose.position == (0, 0, 0.2)
    assert (base.visuals[0].shape.radius, base.visuals[0].shape.length) == (0.2, 0.6)
    assert base.visuals[0].material.diffuse[:3] == (1, 0, 0)
    assert bar.pose.position == (0, 0, 0.5)
    (hinge,) = arm.joints
    assert (hinge.parent, hinge.child, hinge.axis.xyz) == ("base", "bar", (0, 1, 0))
    assert (hinge.axis.lower, hinge.axis.upper, hinge.axis.damping) == (-1, 2, 0.4)
    ranger, eye = base.sensors
    assert (ranger.update_rate, ranger.pose.position) == (30, (0, 0, 1))
    assert (eye.cameras[0].horizontal_fov, eye.cameras[0].width, eye.cameras[0].near) == (
        1.2,
        32,
        0.2,
    )
    assert arm.plugins[0].element.find("bodyName").text == "base"
    # Nothing is left over that nobody understood.
    assert [str(each) for each in world.diagnostics if each.severity != "info"] == []


def test_it_runs():
    with cw.World(load_text(_OLD.format(root="gazebo", version="1.0"), file="w")) as world:
        world.run(0.1)
        assert world.models == ("ground", "arm")
        assert world.model("arm").pose.z < 0.5


def test_names_of_before():
    text = """<gazebo version="1.0"><model name="m"><body name="b">
    <collision name="c"><geom><sphere radius="0.3"/></geom></collision></body></model></gazebo>"""
    model = load_text(text, file="m")
    assert model.links[0].collisions[0].shape.radius == 0.3


def test_elements_are_taken_as_well():
    """SDF 1.2 has them already."""
    text = """<sdf version="1.2"><model name="m"><static>true</static><pose>0 0 3 0 0 0</pose>
    <link name="b"><collision name="c"><geometry><mesh><filename>x.stl</filename></mesh></geometry>
    </collision></link></model></sdf>"""
    model = load_text(text, file="m")
    assert model.static
    assert model.pose.position == (0, 0, 3)


def test_errors_say_the_line_that_was_written():
    link = '<link name="b">\n<inertial mass="x"/></link>'
    text = f'<sdf version="1.0"><model name="m">\n{link}</model></sdf>'
    with raises(tags.VALUE_INVALID) as got:
        load_text(text, file="m")
    assert str(got.value.origin) == "m:3"
