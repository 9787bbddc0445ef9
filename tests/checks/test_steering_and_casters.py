"""Axes of steering joints, and casters that are spheres of the body."""

import pytest

import cartwheel
from cartwheel.codes.robot import (
    CASTER_FRICTION,
    PLANAR_FRICTION,
    STEERING_REVERSED,
    WHEEL_WITHOUT_COLLISION,
    WHEELS_TOED,
)

INERTIAL = (
    '<inertial><mass value="{m}"/>'
    '<inertia ixx="{i}" iyy="{i}" izz="{i}" ixy="0" ixz="0" iyz="0"/></inertial>'
)
WHEEL = (
    '<link name="{name}">' + INERTIAL.format(m=0.5, i=0.002) + "<collision>"
    '<origin rpy="1.5707963 0 0"/><geometry><cylinder radius="0.1" length="0.03"/></geometry>'
    '</collision></link><joint name="{name}_joint" type="continuous"><parent link="{parent}"/>'
    '<child link="{name}"/><origin xyz="{place}"/><axis xyz="0 1 0"/></joint>'
)
BODY = (
    '<link name="base">' + INERTIAL.format(m=5, i=0.1) + "<collision><geometry>"
    '<box size="0.4 0.2 0.1"/></geometry></collision>{more}</link>'
)
REAR = WHEEL.format(name="left", parent="base", place="-0.2 0.15 0") + WHEEL.format(
    name="right", parent="base", place="-0.2 -0.15 0"
)
FORK = (
    '<link name="{name}">' + INERTIAL.format(m=0.2, i=0.001) + "</link>"
    '<joint name="{name}_joint" type="continuous"><parent link="base"/><child link="{name}"/>'
    '<origin xyz="{place}" rpy="{rpy}"/><axis xyz="{axis}"/></joint>'
)


def found(tmp_path, text, code):
    path = tmp_path / "robot.urdf"
    path.write_text(f'<robot name="robot">{text}</robot>')
    return [each for each in cartwheel.check(path).findings if each.code is code]


def tricycle(rpy, axis):
    fork = FORK.format(name="fork", place="0.2 0 0", rpy=rpy, axis=axis)
    plugin = (
        '<gazebo><plugin name="drive" filename="libgazebo_ros_tricycle_drive.so">'
        "<steeringJoint>fork_joint</steeringJoint><actuatedWheelJoint>front_joint"
        "</actuatedWheelJoint><encoderWheelLeftJoint>left_joint</encoderWheelLeftJoint>"
        "<encoderWheelRightJoint>right_joint</encoderWheelRightJoint></plugin></gazebo>"
    )
    front = WHEEL.format(name="front", parent="fork", place="0 0 0")
    return BODY.format(more="") + REAR + fork + front + plugin


@pytest.mark.parametrize(
    ("rpy", "axis", "meant"),
    [
        ("0 0 0", "0 0 1", None),
        ("0 0 0", "0 0 -1", 'xyz="0 0 1"'),
        ("-1.5708 0 0", "0 1 0", 'xyz="0 -1 0"'),
        ("-1.5708 0 0", "0 -1 0", None),
        ("0.2 0 0", "0 0 1", None),
    ],
)
def test_a_steering_axis_that_points_down_is_reported(tmp_path, rpy, axis, meant):
    findings = found(tmp_path, tricycle(rpy, axis), STEERING_REVERSED)
    if meant is None:
        assert findings == []
        return
    (finding,) = findings
    assert finding.values["joint"] == "fork_joint"
    assert finding.instead == meant


@pytest.mark.parametrize(("axis", "meant"), [("0 0 1", 'xyz="0 0 -1"'), ("0 0 -1", None)])
def test_a_steering_axis_behind_the_fixed_wheels_must_point_down(tmp_path, axis, meant):
    text = tricycle("0 0 0", axis).replace('xyz="0.2 0 0"', 'xyz="-0.5 0 0"')
    findings = found(tmp_path, text, STEERING_REVERSED)
    assert [each.instead for each in findings] == ([] if meant is None else [meant])


@pytest.mark.parametrize(("axis", "wrong"), [("0 0 1", True), ("0 0 -1", False)])
def test_a_car_that_faces_backward_steers_behind(tmp_path, axis, wrong):
    """Its left wheels are at negative y, and all roll along negative x."""
    forks = "".join(
        FORK.format(name=name, place=f"0.2 {y} 0", rpy="0 0 0", axis=axis)
        + WHEEL.format(name=f"{name}_wheel", parent=name, place="0 0 0")
        for name, y in (("one", -0.15), ("two", 0.15))
    )
    plugin = (
        '<gazebo><plugin name="drive" filename="gz-sim-ackermann-steering-system">'
        "<left_joint>right_joint</left_joint><right_joint>left_joint</right_joint>"
        "<left_steering_joint>one_joint</left_steering_joint>"
        "<right_steering_joint>two_joint</right_steering_joint></plugin></gazebo>"
    )
    text = (BODY.format(more="") + REAR + forks + plugin).replace('"0 1 0"', '"0 -1 0"')
    findings = found(tmp_path, text, STEERING_REVERSED)
    assert {each.values["joint"] for each in findings} == (
        {"one_joint", "two_joint"} if wrong else set()
    )


def test_both_steering_joints_of_a_car_are_examined(tmp_path):
    forks = "".join(
        FORK.format(name=name, place=f"0.2 {y} 0", rpy="0 0 0", axis=axis)
        + WHEEL.format(name=f"{name}_wheel", parent=name, place="0 0 0")
        for name, y, axis in (("one", 0.15, "0 0 1"), ("two", -0.15, "0 0 -1"))
    )
    plugin = (
        '<gazebo><plugin name="drive" filename="gz-sim-ackermann-steering-system">'
        "<left_joint>left_joint</left_joint><right_joint>right_joint</right_joint>"
        "<left_steering_joint>one_joint</left_steering_joint>"
        "<right_steering_joint>two_joint</right_steering_joint></plugin></gazebo>"
    )
    (finding,) = found(tmp_path, BODY.format(more="") + REAR + forks + plugin, STEERING_REVERSED)
    assert finding.values["joint"] == "two_joint"


DRIVE = (
    '<gazebo><plugin name="drive" filename="libgazebo_ros_diff_drive.so">'
    "<leftJoint>left_joint</leftJoint><rightJoint>right_joint</rightJoint>"
    "<wheelSeparation>0.3</wheelSeparation><wheelDiameter>0.2</wheelDiameter></plugin></gazebo>"
)


@pytest.mark.parametrize(
    ("z", "mu", "reported"),
    [(-0.08, None, True), (-0.08, 0.8, True), (-0.08, 0.1, False), (-0.04, None, False)],
)
def test_a_sphere_of_the_body_beside_the_wheels_is_a_caster(tmp_path, z, mu, reported):
    """The wheels have a radius of 0.1 m, and the ball of 0.02 m."""
    ball = (
        f'<collision><origin xyz="0.15 0 {z}"/><geometry><sphere radius="0.02"/></geometry>'
        "</collision>"
    )
    friction = "" if mu is None else f'<gazebo reference="base"><mu1>{mu}</mu1></gazebo>'
    text = BODY.format(more=ball) + REAR + DRIVE + friction
    findings = found(tmp_path, text, CASTER_FRICTION)
    assert [each.values["link"] for each in findings] == ["base"] * reported


@pytest.mark.parametrize(
    ("dynamics", "reported"),
    [
        # The wheel carries half of the weight of 6.7 kg, with a grip of 33 N. At 0.02 m/s, the
        # damping d brakes it by 2 d N, as its radius is 0.1 m.
        ('damping="14"', False),
        ('damping="20"', True),
        ('friction="3"', False),
        ('friction="3.6"', True),
        ('damping="10" friction="2"', True),
    ],
)
def test_a_wheel_on_a_swivel_that_the_ground_cannot_turn_is_reported(tmp_path, dynamics, reported):
    swivel = FORK.format(name="fork", place="0.2 0 0", rpy="0 0 0", axis="0 0 1")
    caster = WHEEL.format(name="front", parent="fork", place="0 0 0").replace(
        '<axis xyz="0 1 0"/>', f'<axis xyz="0 1 0"/><dynamics {dynamics}/>'
    )
    findings = found(
        tmp_path, BODY.format(more="") + REAR + DRIVE + swivel + caster, CASTER_FRICTION
    )
    assert [each.values["link"] for each in findings] == ["front"] * reported
    for each in findings:
        assert each.severity == "warning"
        assert 0.0 < each.values["ratio"] < 0.95


MOVE = '<gazebo><plugin name="move" filename="libgazebo_ros_planar_move.so"/></gazebo>'


@pytest.mark.parametrize(
    ("parts", "mu", "reported"),
    [
        (BODY.format(more=""), None, ["base"]),
        (BODY.format(more=""), 0.05, []),
        # It stands on wheels that roll.
        (BODY.format(more="") + REAR, None, []),
        (BODY.format(more="") + REAR.replace("continuous", "fixed"), None, ["left", "right"]),
    ],
)
def test_a_robot_that_is_moved_over_the_ground_is_braked_by_its_friction(
    tmp_path, parts, mu, reported
):
    friction = "" if mu is None else f'<gazebo reference="base"><mu1>{mu}</mu1></gazebo>'
    findings = found(tmp_path, parts + MOVE + friction, PLANAR_FRICTION)
    assert [each.values["link"] for each in findings] == reported


def test_friction_brakes_nothing_without_a_plugin_that_moves_the_robot(tmp_path):
    assert found(tmp_path, BODY.format(more=""), PLANAR_FRICTION) == []


def test_the_steering_joints_of_a_controller_are_examined(tmp_path):
    """Joints without limits that turn about the vertical are not wheels of the controller."""
    forks = "".join(
        FORK.format(name=name, place=f"0.2 {y} 0", rpy="-1.5708 0 0", axis="0 1 0")
        + WHEEL.format(name=f"{name}_wheel", parent=name, place="0 0 0").replace("0 1 0", "0 0 1")
        for name, y in (("one", 0.15), ("two", -0.15))
    )
    (tmp_path / "car.yaml").write_text("""controller_manager:
  ros__parameters:
    car:
      type: ackermann_steering_controller/AckermannSteeringController
car:
  ros__parameters:
    wheelbase: 0.4
    traction_track_width: 0.3
    steering_track_width: 0.3
    traction_wheels_radius: 0.1
    traction_joints_names: [right_joint, left_joint]
    steering_joints_names: [two_joint, one_joint]
""")
    joints = "".join(
        f'<joint name="{name}_joint"><command_interface name="{kind}"/></joint>'
        for name, kind in (
            ("left", "velocity"),
            ("right", "velocity"),
            ("one", "position"),
            ("two", "position"),
        )
    )
    control = (
        '<ros2_control name="s" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem'
        f'</plugin></hardware>{joints}</ros2_control><gazebo><plugin name="c" filename='
        '"gz_ros2_control-system"><parameters>car.yaml</parameters></plugin></gazebo>'
    )
    text = BODY.format(more="") + REAR + forks + control
    findings = found(tmp_path, text, STEERING_REVERSED)
    assert {each.values["joint"] for each in findings} == {"one_joint", "two_joint"}
    assert found(tmp_path, text, WHEEL_WITHOUT_COLLISION) == []


@pytest.mark.parametrize(
    ("left", "right", "toe"),
    [(0.0, 0.0, None), (0.02, -0.02, None), (0.03, 0.0, 0.015), (0.0, -0.02, -0.01)],
)
def test_wheels_that_point_to_one_side_are_reported(tmp_path, left, right, toe):
    """Wheels that point inward by the same angle keep the robot straight."""
    forks = "".join(
        FORK.format(name=name, place=f"0.2 {y} 0", rpy="0 0 0", axis="0 0 1")
        + WHEEL.format(name=f"{name}_wheel", parent=name, place="0 0 0").replace(
            '<origin xyz="0 0 0"/>', f'<origin xyz="0 0 0" rpy="0 0 {yaw}"/>'
        )
        for name, y, yaw in (("one", 0.15, left), ("two", -0.15, right))
    )
    plugin = (
        '<gazebo><plugin name="drive" filename="gz-sim-ackermann-steering-system">'
        "<left_joint>left_joint</left_joint><right_joint>right_joint</right_joint>"
        "<left_steering_joint>one_joint</left_steering_joint>"
        "<right_steering_joint>two_joint</right_steering_joint></plugin></gazebo>"
    )
    findings = found(tmp_path, BODY.format(more="") + REAR + forks + plugin, WHEELS_TOED)
    assert [each.values["toe"] for each in findings] == (
        [] if toe is None else [pytest.approx(toe)]
    )


def sdf_cart(mu="", effort="", name="glider"):
    """Half of the weight of 6 kg is on the ball, because its mass is between ball and axle."""
    inertia = "<inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia>"
    ode = f"<surface><friction><ode>{mu}</ode></friction></surface>"
    limit = f"<limit><effort>{effort}</effort></limit>" if effort else ""
    wheels = "".join(
        f"""<link name="{side}"><pose>-0.2 {y} 0.1 -1.5707963 0 0</pose>
        <inertial><mass>0.001</mass>{inertia}</inertial><collision name="c"><geometry><cylinder>
        <radius>0.1</radius><length>0.02</length></cylinder></geometry></collision></link>
        <joint name="{side}_joint" type="revolute"><parent>base</parent><child>{side}</child>
        <axis><xyz>0 0 1</xyz>{limit}</axis></joint>"""
        for side, y in (("left", 0.15), ("right", -0.15))
    )
    return f"""<sdf version="1.9"><model name="cart"><link name="base"><pose>0 0 0.2 0 0 0</pose>
      <inertial><mass>6</mass>{inertia}</inertial></link>{wheels}
      <link name="{name}"><pose>0.2 0 0.05 0 0 0</pose>
        <inertial><mass>0.001</mass>{inertia}</inertial><collision name="c"><geometry><sphere>
        <radius>0.05</radius></sphere></geometry>{ode}</collision></link>
      <joint name="foot" type="fixed"><parent>base</parent><child>{name}</child></joint>
      <plugin name="drive" filename="gz-sim-diff-drive-system"><left_joint>left_joint</left_joint>
      <right_joint>right_joint</right_joint><wheel_separation>0.3</wheel_separation>
      <wheel_radius>0.1</wheel_radius></plugin></model></sdf>"""


@pytest.mark.parametrize("name", ["glider", "caster"])
@pytest.mark.parametrize(
    ("mu", "effort", "severity"),
    [
        ("", "", "info"),
        ("<mu>0.1</mu><mu2>0.1</mu2>", "", None),
        # The ball's friction is 3 kg × 9.8 m/s² = 29.4 N, as that of two motors of 1.47 N m.
        ("", 1.5, "info"),
        ("", 1.4, "warning"),
        ("<mu>0.9</mu><mu2>0.9</mu2>", 1.4, "info"),
    ],
)
def test_casters_in_sdf_are_reported(tmp_path, name, mu, effort, severity):
    path = tmp_path / "cart.sdf"
    path.write_text(sdf_cart(mu, effort, name))
    findings = [each for each in cartwheel.check(path).findings if each.code is CASTER_FRICTION]
    assert [each.severity for each in findings] == [severity] * (severity is not None)
    for each in findings:
        assert each.values["link"] == name
        assert each.values["holds"] == (severity == "warning")
        assert each.origin.line > 1
        assert not each.instead
