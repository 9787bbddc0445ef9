"""Why robots do not stand."""

import pytest

from cartwheel.codes.robot import JOINTS_UNDRIVEN, START_OUTSIDE_LIMITS, UNBALANCED
from cartwheel.corpus.trial import try_robot

LINK = (
    '<link name="{name}"><inertial><origin xyz="{at}"/><mass value="{mass}"/>'
    '<inertia ixx="0.02" iyy="0.02" izz="0.02" '
    'ixy="0" ixz="0" iyz="0"/></inertial><collision><origin xyz="{at}"/>'
    '<geometry><box size="{size}"/></geometry></collision></link>'
)
JOINT = (
    '<joint name="{name}_joint" type="{kind}"><parent link="{parent}"/><child link="{name}"/>'
    '<origin xyz="{at}"/><axis xyz="0 1 0"/>'
    '<limit lower="{lower}" upper="{upper}" effort="100" velocity="5"/></joint>'
)


@pytest.fixture
def tried(tmp_path):
    def run(*parts, **more):
        path = tmp_path / "robot.urdf"
        path.write_text(f'<robot name="robot">{"".join(parts)}</robot>')
        return try_robot(path, standing=3.0, **more)

    return run


def stand_of(verdict):
    (found,) = [each for each in verdict.faults if each.test == "stand"]
    return found


def arm(kind="revolute", mass=0.3, far=0.0):
    """A weak arm on a foot, whose heavy part may be far beside the foot."""
    foot = LINK.format(name="foot", at="0 0 0.02", mass=1, size="0.2 0.2 0.04")
    head = LINK.format(name="head", at=f"{far} 0 0.1", mass=3, size="0.05 0.05 0.1")
    neck = '<joint name="neck" type="fixed"><parent link="foot"/><child link="head"/></joint>'
    upper = LINK.format(name="arm", at="0.01 0 0.2", mass=mass, size="0.02 0.02 0.4")
    shoulder = JOINT.format(
        name="arm", kind=kind, parent="foot", at="0 0 0.3", lower=-3, upper=3
    ).replace("0 1 0", "1 0 0" if far else "0 1 0")
    # A robot without devices need not stand.
    sensor = '<gazebo reference="foot"><sensor name="imu" type="imu"/></gazebo>'
    return foot, head, neck, upper, shoulder, sensor


@pytest.mark.parametrize("kind", ["revolute", "fixed"])
def test_a_robot_that_tips_although_its_joints_are_held_is_unbalanced(tried, kind):
    fault = stand_of(tried(*arm(kind, far=0.3)))
    assert (fault.code, fault.source) == (UNBALANCED, "file")


def test_a_balanced_robot_that_an_arm_tips_over_has_a_joint_that_nothing_drives(tried):
    fault = stand_of(tried(*arm(mass=30)))
    assert (fault.code, fault.source) == (JOINTS_UNDRIVEN, "file")


@pytest.mark.parametrize("kind", ["continuous", "revolute"])
@pytest.mark.parametrize(("places", "stands"), [("0 0.2", False), ("-0.2 0.2 0", True)])
def test_a_robot_on_a_single_wheel_falls_over(tried, places, stands, kind):
    """A wheel in the middle below the body; the other one on top of it, or three apart."""
    body = LINK.format(name="body", at="0.005 0 0.2", mass=5, size="0.5 0.3 0.1")
    sensor = '<gazebo reference="body"><sensor name="imu" type="imu"/></gazebo>'
    wheels = []
    for index, place in enumerate(places.split()):
        at = f"{place} {0.2 * index} 0.1" if stands else f"0 0 {0.1 + float(place)}"
        wheel = LINK.format(name=f"wheel{index}", at="0 0 0", mass=1, size="0 0 0")
        wheels += [
            wheel.replace('<box size="0 0 0"/>', '<cylinder radius="0.1" length="0.04"/>').replace(
                '<collision><origin xyz="0 0 0"/>', '<collision><origin rpy="1.5708 0 0"/>'
            ),
            JOINT.format(
                name=f"wheel{index}", kind=kind, parent="body", at=at, lower=-1e16, upper=1e16
            ),
        ]
    verdict = tried(body, *wheels, sensor)
    if not stands:
        fault = stand_of(verdict)
        assert (fault.code, fault.source) == (UNBALANCED, "file")
    found = [each for each in verdict.faults if each.code is JOINTS_UNDRIVEN]
    assert not found or stands


def legged(lower, upper):
    """A body on two legs, each with a flat foot, and motors that hold the joints at the start."""
    yield LINK.format(name="body", at="0 0 0", mass=3, size="0.1 0.4 0.1")
    for name, y in (("left", 0.15), ("right", -0.15)):
        leg = LINK.format(name=name, at="0 0 -0.2", mass=0.5, size="0.04 0.04 0.4")
        foot = LINK.format(name=f"{name}_foot", at="0 0 -0.01", mass=0.2, size="0.2 0.08 0.02")
        yield leg + foot
        yield JOINT.format(
            name=name, kind="revolute", parent="body", at=f"0 {y} 0", lower=lower, upper=upper
        )
        yield (
            f'<joint name="{name}_ankle" type="fixed"><parent link="{name}"/>'
            f'<child link="{name}_foot"/><origin xyz="0 0 -0.4"/></joint>'
        )
        yield (
            '<gazebo><plugin name="hold" filename="gz-sim-joint-position-controller-system">'
            f"<joint_name>{name}_joint</joint_name><p_gain>500</p_gain><d_gain>20</d_gain>"
            "</plugin></gazebo>"
        )


def test_legs_that_start_outside_their_limits_throw_a_robot_over(tried):
    assert tried(*legged(-1.0, 1.0)).stand.state == "yes"
    fault = stand_of(tried(*legged(0.6, 1.5)))
    assert (fault.code, fault.source) == (START_OUTSIDE_LIMITS, "file")
    assert fault.reason.values["joint"] in ("left_joint", "right_joint")


def test_an_arm_that_starts_outside_its_limits_carries_nothing(tried):
    """The robot tips because of its own weight."""
    parts = [each.replace('lower="-3"', 'lower="0.6"') for each in arm(far=0.3)]
    assert stand_of(tried(*parts)).code is UNBALANCED


CAMERA = (
    '<xacro:include filename="$(find realsense2_description)/urdf/_d435.urdf.xacro"/>'
    '<xacro:sensor_d435 parent="head"><origin xyz="0 0 0.2"/></xacro:sensor_d435>'
)


@pytest.mark.parametrize("with_own", [False, True])
def test_the_sensors_that_only_a_stand_in_adds_are_not_for_gazebo(tmp_path, with_own):
    """The driver of the camera publishes its images; the original package has no sensors."""
    *parts, own = arm("fixed", far=0.3)
    path = tmp_path / "robot.urdf.xacro"
    path.write_text(
        '<robot name="robot" xmlns:xacro="http://www.ros.org/wiki/xacro">'
        f"{''.join(parts)}{CAMERA}{own * with_own}</robot>"
    )
    verdict = try_robot(path, standing=3.0)
    assert not verdict.stands
    assert verdict.good is not with_own
