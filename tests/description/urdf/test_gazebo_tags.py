"""The meaning of each ``<gazebo>`` tag, and the reports of tags without effect."""

import pytest
from tests.coded import coded, named, placed

from cartwheel.codes.robot import REFERENCE_UNKNOWN
from cartwheel.description import load_text
from cartwheel.description import model as m
from cartwheel.errors import DescriptionError
from cartwheel.geometry import Pose

BODY = (
    '<inertial><mass value="1"/>'
    '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
)
SHAPE = '<geometry><box size="1 1 1"/></geometry>'
LINKS = (
    f'<link name="base">{BODY}<visual>{SHAPE}'
    f'<material name="own"><color rgba="0.5 0.5 0.5 1"/></material></visual>'
    f"<collision>{SHAPE}</collision></link>"
    f'<link name="arm">{BODY}</link><link name="tip">{BODY}<collision>{SHAPE}</collision></link>'
    '<joint name="hinge" type="continuous"><parent link="base"/><child link="arm"/></joint>'
    '<joint name="weld" type="fixed"><parent link="arm"/><child link="tip"/></joint>'
)


def load(*tags):
    """A robot whose tags begin in line 2."""
    text = f'<robot name="r">{LINKS}\n' + "\n".join(tags) + "\n</robot>"
    return load_text(text, file="robot.urdf")


def on(reference, *content):
    return f'<gazebo reference="{reference}">' + "".join(content) + "</gazebo>"


def reported(description):
    return [placed(each) for each in description.diagnostics]


@pytest.mark.parametrize(
    ("tag", "field", "value"),
    [
        ("<mu1>0.3</mu1>", "mu1", 0.3),
        ("<mu>0.3</mu>", "mu1", 0.3),
        ('<mu1 value="0.3"/>', "mu1", 0.3),
        ("<mu2>0.4</mu2>", "mu2", 0.4),
        ("<kp>1e6</kp>", "kp", 1e6),
        ("<kd>100.0</kd>", "kd", 100),
        ("<minDepth>0.001</minDepth>", "min_depth", 0.001),
        ("<maxVel>1.0</maxVel>", "max_vel", 1.0),
        ("<maxContacts>10</maxContacts>", "max_contacts", 10),
        ("<fdir1>1 0 0</fdir1>", "fdir1", (1, 0, 0)),
        ("<fdir1>0 0 0</fdir1>", "fdir1", None),
        (
            "<collision><surface><friction><ode><mu>0.7</mu></ode></friction></surface></collision>",
            "mu1",
            0.7,
        ),
        (
            "<collision><surface><contact><ode><max_vel>2</max_vel></ode></contact></surface>"
            "</collision>",
            "max_vel",
            2,
        ),
        ("<collision><max_contacts>3</max_contacts></collision>", "max_contacts", 3),
    ],
)
def test_surface(tag, field, value):
    robot = load(on("base", tag))
    assert getattr(robot.link("base").collisions[0].surface, field) == value
    assert robot.link("tip").collisions[0].surface == m.Surface()
    assert not robot.diagnostics


@pytest.mark.parametrize(
    ("tag", "field", "value"),
    [
        ("<selfCollide>true</selfCollide>", "self_collide", True),
        ("<self_collide>0</self_collide>", "self_collide", False),
        ("<turnGravityOff>true</turnGravityOff>", "gravity", False),
        ("<turnGravityOff>false</turnGravityOff>", "gravity", True),
        ("<gravity>0</gravity>", "gravity", False),
        ("<kinematic>1</kinematic>", "kinematic", True),
        ("<dampingFactor>0.01</dampingFactor>", "linear_damping", 0.01),
        ("<dampingFactor>0.01</dampingFactor>", "angular_damping", 0.01),
        ("<velocity_decay><linear>0.2</linear></velocity_decay>", "linear_damping", 0.2),
    ],
)
def test_link(tag, field, value):
    robot = load(on("base", tag))
    assert getattr(robot.link("base"), field) == value
    assert not robot.diagnostics


def test_laser_retro_holds_for_all_that_a_laser_may_meet():
    base = load(on("base", "<laserRetro>50</laserRetro>")).link("base")
    assert base.visuals[0].laser_retro == base.collisions[0].laser_retro == 50


def test_material_overrides_the_colour():
    robot = load(on("base", "<material>Gazebo/Blue</material>"))
    material = robot.link("base").visuals[0].material
    assert (material.name, material.diffuse) == ("Gazebo/Blue", (0, 0, 1, 1))
    assert not material.yields_to_mesh


def test_a_material_that_cannot_be_read_costs_no_more_than_itself():
    robot = load(on("base", "<material><diffuse>'1 0 0 1'</diffuse></material>"))
    assert robot.link("base").visuals[0].material.diffuse == (0.5, 0.5, 0.5, 1)
    (reported,) = robot.diagnostics
    assert placed(reported) == "robot.urdf:2 warning value-ignored"
    assert reported.values["stated"] == "'1"


def test_unknown_material_keeps_the_colour_and_is_reported():
    robot = load(on("base", "<material>Gazebo/Bleu</material>"))
    assert robot.link("base").visuals[0].material.diffuse == (0.5, 0.5, 0.5, 1)
    assert reported(robot) == ["robot.urdf:2 warning material-unknown Gazebo/Blue"]


def test_visual_as_sdf_states_it():
    robot = load(
        on(
            "base",
            "<visual name='seen'><material><diffuse>1 0 0 1</diffuse></material>",
            "<transparency>0.5</transparency><cast_shadows>0</cast_shadows></visual>",
            "<collision name='felt'><laser_retro>3</laser_retro></collision>",
        )
    )
    assert reported(robot) == []
    (visual,) = robot.link("base").visuals
    assert visual.material.diffuse == (1, 0, 0, 1)
    assert visual.transparency == 0.5
    assert not visual.cast_shadows


def test_several_tags_of_one_link_add_up_and_the_last_wins():
    robot = load(on("base", "<mu1>1</mu1><kp>5</kp>"), on("base", "<mu1>2</mu1>"))
    surface = robot.link("base").collisions[0].surface
    assert (surface.mu1, surface.kp) == (2, 5)


@pytest.mark.parametrize(
    ("tag", "field", "value"),
    [
        ("<stopCfm>0.1</stopCfm>", "stop_cfm", 0.1),
        ("<stopErp>0.2</stopErp>", "stop_erp", 0.2),
        ("<provideFeedback>true</provideFeedback>", "provide_feedback", True),
        ("<implicitSpringDamper>1</implicitSpringDamper>", "implicit_spring_damper", True),
        ("<cfmDamping>1</cfmDamping>", "implicit_spring_damper", True),
        (
            "<physics><ode><implicit_spring_damper>1</implicit_spring_damper></ode></physics>",
            "implicit_spring_damper",
            True,
        ),
    ],
)
def test_joint(tag, field, value):
    robot = load(on("hinge", tag))
    assert getattr(robot.joint("hinge"), field) == value
    assert not robot.diagnostics


def test_springs():
    robot = load(
        on(
            "hinge",
            "<springStiffness>3</springStiffness><springReference>0.4</springReference>",
        )
    )
    axis = robot.joint("hinge").axis
    assert (axis.spring_stiffness, axis.spring_reference) == (3, 0.4)


@pytest.mark.parametrize("tag", ["preserveFixedJoint", "disableFixedJointLumping"])
def test_preserved_joints(tag):
    assert load(on("weld", f"<{tag}>true</{tag}>")).joint("weld").preserve_fixed
    assert not load(on("weld", f"<{tag}>false</{tag}>")).joint("weld").preserve_fixed


def test_robot():
    robot = load(
        "<gazebo><static>true</static><self_collide>1</self_collide>"
        '<plugin name="drive" filename="libgazebo_ros_diff_drive.so">'
        "<torque>20</torque></plugin></gazebo>"
    )
    assert robot.static
    assert robot.self_collide
    (plugin,) = robot.plugins
    assert (plugin.name, plugin.filename) == ("drive", "libgazebo_ros_diff_drive.so")
    assert plugin.element.find("torque").text == "20"
    assert str(plugin.origin) == "robot.urdf:2"
    assert not robot.diagnostics


def test_camera():
    robot = load(
        on(
            "tip",
            '<sensor type="camera" name="eye"><pose>1 0 0 0 0 0</pose>'
            "<update_rate>30</update_rate><always_on>1</always_on><visualize>true</visualize>"
            '<topic>pictures</topic><camera name="head"><horizontal_fov>1.5</horizontal_fov>'
            "<image><width>640</width><height>480</height><format>L8</format></image>"
            "<clip><near>0.2</near><far>9</far></clip>"
            "<noise><type>gaussian</type><mean>0.1</mean><stddev>0.007</stddev></noise>"
            "<distortion><k1>0.1</k1><k2>0.2</k2><k3>0.3</k3><p1>0.4</p1><p2>0.5</p2>"
            "<center>0.4 0.6</center></distortion></camera>"
            '<plugin name="c" filename="libgazebo_ros_camera.so"/></sensor>',
        )
    )
    (sensor,) = robot.link("tip").sensors  # which Gazebo would have merged into arm
    assert (sensor.name, sensor.type, sensor.link) == ("eye", "camera", "tip")
    assert (sensor.update_rate, sensor.always_on, sensor.visualize) == (30, True, True)
    assert sensor.topic == "pictures"
    assert sensor.pose == Pose((1, 0, 0))
    assert sensor.plugins[0].filename == "libgazebo_ros_camera.so"
    assert sensor.cameras == (
        m.CameraIntrinsics(
            name="head",
            horizontal_fov=1.5,
            width=640,
            height=480,
            format="L8",
            near=0.2,
            far=9,
            k1=0.1,
            k2=0.2,
            k3=0.3,
            p1=0.4,
            p2=0.5,
            distortion_center=(0.4, 0.6),
            noise_mean=0.1,
            noise_stddev=0.007,
        ),
    )
    assert not robot.diagnostics


def test_sensor_of_a_joint():
    robot = load(on("hinge", '<sensor type="force_torque" name="ft"/>'))
    (sensor,) = robot.link("arm").sensors
    assert (sensor.joint, sensor.link) == ("hinge", "arm")


def test_a_sensor_of_a_name_that_is_a_link_and_a_joint_is_there_once():
    text = f'<robot name="r">{LINKS}'.replace('name="hinge"', 'name="arm"')
    tags = on("arm", '<sensor type="camera" name="c"/>', '<sensor type="force_torque" name="ft"/>')
    robot = load_text(f"{text}{tags}</robot>", file="robot.urdf")
    found = {sensor.name: sensor.joint for sensor in robot.link("arm").sensors}
    assert len(robot.link("arm").sensors) == 2
    assert found == {"c": None, "ft": "arm"}


def test_light():
    robot = load(on("tip", '<light type="spot" name="lamp"><pose>0 0 1 0 0 0</pose></light>'))
    (light,) = robot.link("tip").lights
    assert (light.name, light.type, light.pose) == ("lamp", "spot", Pose((0, 0, 1)))


@pytest.mark.parametrize(
    ("tags", "code"),
    [
        (
            on("base", "<maxContact>3</maxContact>"),
            "tag-ignored maxContacts",
        ),
        (on("base", "<min_depth>3</min_depth>"), "tag-ignored minDepth"),
        (
            on("base", "<canonicalBody>base</canonicalBody>"),
            "not-simulated",
        ),
        (on("base", "<projector/>x"), "tag-empty"),
        (on("base", '<projector name="p"/>'), "not-simulated"),
        (on("hinge", "<stopCfm></stopCfm>"), "tag-empty"),
        (
            on("base", "<preserveFixedJoint>1</preserveFixedJoint>"),
            "tag-misplaced",
        ),
        (
            on("hinge", "<mu1>1</mu1>"),
            "tag-misplaced",
        ),
        (
            "<gazebo><mu1>1</mu1></gazebo>",
            "tag-misplaced",
        ),
        ("<gazebo><gripper><a/></gripper></gazebo>", "not-simulated"),
        (on("base", "<mu1>-1</mu1>"), "value-ignored"),
        (on("base", "<mu1></mu1>"), "tag-empty"),
        (
            on("base", '<plugin name="p" filename="libp.so"/>'),
            "tag-misplaced",
        ),
        (
            on("base", '<sensor type="imu" name="i"/><sensor type="imu" name="i"/>'),
            "sensor-twice",
        ),
    ],
)
def test_warnings(tags, code):
    (diagnostic,) = load(tags).diagnostics
    assert placed(diagnostic) == f"robot.urdf:2 warning {code}"


def test_a_tag_for_nothing_is_left_out_and_reported():
    (diagnostic,) = load(on("bas", '<mu1>1</mu1><sensor name="a" type="imu"/>')).diagnostics
    assert placed(diagnostic) == "robot.urdf:2 warning reference-unknown base"


@pytest.mark.parametrize(
    ("tags", "code"),
    [
        (on("base", "<mu1>x</mu1>"), "value-invalid"),
        (on("base", "<selfCollide>perhaps</selfCollide>"), "value-invalid"),
        ('<gazebo><plugin name="a"/></gazebo>', "tag-missing"),
    ],
)
def test_errors(tags, code):
    with pytest.raises(DescriptionError) as caught:
        load(tags)
    assert str(caught.value.origin) == "robot.urdf:2"
    assert named(caught.value) == code


@pytest.mark.parametrize(
    ("tags", "meant"),
    [
        ("<mu1>1</mu1>", ""),
        ("<preserveFixedJoint>true</preserveFixedJoint>", "arm_joint"),
        ('<sensor name="a" type="imu"/>', "arm_joint"),
    ],
)
def test_a_link_is_suggested_for_tags_of_links_and_a_joint_for_those_of_joints(tags, meant):
    text = (
        '<robot name="r"><link name="base"/><link name="arm"/><joint name="arm_joint" type="fixed">'
        '<parent link="base"/><child link="arm"/></joint><gazebo reference="arm_jont">'
        f"{tags}</gazebo></robot>"
    )
    (diagnostic,) = coded(load_text(text), REFERENCE_UNKNOWN)
    assert diagnostic.values["meant"] == meant


@pytest.mark.parametrize("place", ["base", "hinge"])
def test_an_invalid_sensor_is_left_out(place):
    (error,) = [
        each
        for each in load(on(place, '<sensor name="a"/>')).diagnostics
        if each.severity == "error"
    ]
    assert placed(error) == "robot.urdf:2 error tag-missing"
    assert error.values["left_out"] == "sensor"


def test_a_fudge_factor_is_no_loss():
    (diagnostic,) = load(on("hinge", "<fudgeFactor>1</fudgeFactor>")).diagnostics
    assert placed(diagnostic) == "robot.urdf:2 info not-simulated"
