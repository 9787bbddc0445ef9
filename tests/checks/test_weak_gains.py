"""Proportional gains that do not overcome the friction of a joint, or do not hold its load."""

import math

import pytest
from tests.dialects.ros_control.arms import ROS1, beam, robot, transmission

from cartwheel.checks.checking import check
from cartwheel.checks.gains import gain_too_low, upright_stiffness
from cartwheel.checks.robot import Robot
from cartwheel.codes.devices import CONTROLLER_GAIN_TOO_LOW
from cartwheel.corpus import try_robot
from cartwheel.description import load_robot

GZ = (
    '<plugin name="p" filename="gz-sim-joint-position-controller-system">'
    "<joint_name>beam_joint</joint_name><p_gain>{p}</p_gain><i_gain>{i}</i_gain><i_max>10</i_max>"
    "<i_min>-10</i_min></plugin>"
)
FILE = (
    "move:\n  type: effort_controllers/JointPositionController\n  joint: beam_joint\n"
    "  pid: {{p: {p}, i: {i}, d: 0.1, i_clamp: 10}}\n"
)


def rubbing(plugin: str, friction: float) -> str:
    dynamics = f'<dynamics friction="{friction}" damping="0.5"/>'
    body = beam("beam", "world", axis="0 0 1").replace("</joint>", f"{dynamics}</joint>", 1)
    return robot(body + transmission("beam_joint", "Effort"), plugin)


@pytest.mark.parametrize(
    ("p", "i", "reported"), [(3.0, 0.0, True), (20.0, 0.0, False), (3.0, 30.0, False)]
)
@pytest.mark.parametrize("gz", [True, False], ids=["plugin", "controller"])
def test_a_gain_that_does_not_overcome_friction_is_reported(tmp_path, p, i, reported, gz):
    path = tmp_path / "arm.urdf"
    path.write_text(rubbing(GZ.format(p=p, i=i) if gz else ROS1, 1.5))
    (tmp_path / "move.yaml").write_text(FILE.format(p=p, i=i))
    files = () if gz else (tmp_path / "move.yaml",)
    findings = check(path, controller_files=files).findings
    found = [each for each in findings if each.code is CONTROLLER_GAIN_TOO_LOW]
    assert [each.values["joint"] for each in found] == ["beam_joint"] * reported
    verdict = try_robot(path, standing=1.0, controllers=files)
    (reach,) = verdict.reaches
    assert reach.moved != reported
    codes = [each.code for each in verdict.faults]
    # An integral moves the joint, but may let it oscillate.
    assert i or codes == [CONTROLLER_GAIN_TOO_LOW] * reported
    assert (CONTROLLER_GAIN_TOO_LOW in codes) == reported


@pytest.mark.parametrize(("p", "axis", "reported"), [
    (10.0, "0 0 1", True), (10.0, "0 0 -1", True), (10.0, "1 0 0", False),
    # It sags by 0.22 m, by 0.016 m, or by 0.005 m.
    (90.0, "0 0 1", True), (90.0, "0 0 -1", True), (1200.0, "0 0 1", True),
    (4000.0, "0 0 1", False),
])  # fmt: skip
@pytest.mark.parametrize("gz", [True, False], ids=["plugin", "controller"])
def test_a_gain_that_does_not_hold_a_weight_within_the_limits_is_reported(
    tmp_path, p, axis, reported, gz
):
    """A weight of 2 kg on a slide of 1 m: a gain of 20 N/m would just hold it at its end, and one
    of 1960 N/m 1 cm below its target.
    """
    limit = 'lower="-0.5" upper="0.5" effort="100" velocity="10"'
    slide = beam("beam", "world", axis=axis, limit=limit, kind="prismatic")
    slide = slide.replace("</joint>", '<dynamics damping="5"/></joint>', 1)
    path = tmp_path / "slide.urdf"
    plugin = GZ.format(p=p, i=0.0) if gz else ROS1
    path.write_text(robot(slide + transmission("beam_joint", "Effort"), plugin))
    (tmp_path / "move.yaml").write_text(FILE.format(p=p, i=0.0))
    files = () if gz else (tmp_path / "move.yaml",)
    findings = check(path, controller_files=files).findings
    found = [each for each in findings if each.code is CONTROLLER_GAIN_TOO_LOW]
    assert [each.values["joint"] for each in found] == ["beam_joint"] * reported
    faults = try_robot(path, standing=1.0, controllers=files).faults
    assert [each.code for each in faults] == [CONTROLLER_GAIN_TOO_LOW] * reported
    if reported and p >= 90.0:
        assert abs(faults[0].reason.values["error"]) == pytest.approx(2.0 * 9.8 / p, rel=0.01)


@pytest.mark.parametrize("upper", [0.0, -0.5])
def test_a_slide_between_equal_limits_is_held(tmp_path, upper):
    """Limits of 0 are often placeholders."""
    limit = f'lower="0" upper="{upper}" effort="100" velocity="10"'
    slide = beam("beam", "world", axis="0 0 1", limit=limit, kind="prismatic")
    path = tmp_path / "slide.urdf"
    path.write_text(robot(slide, GZ.format(p=5.0, i=0.0)))
    assert CONTROLLER_GAIN_TOO_LOW not in [each.code for each in check(path).findings]


@pytest.mark.parametrize(
    ("p", "pose", "reported"),
    [
        # Its weight of 2 kg is 0.5 m above the axis: 9.8 N m/rad.
        (5.0, ("0 -1.5708 0", 3), True),
        (5.0, ("0 -1.0 0", 3), True),
        (40.0, ("0 -1.5708 0", 3), False),
        # It sags from near the horizontal, or from nearer the top.
        (5.0, ("0 0.2 0", 3), True),
        (120.0, ("0 0.2 0", 3), False),
        (15.0, ("0 -0.7 0", 3), True),
        # It hangs.
        (15.0, ("0 1.5708 0", 3), False),
        # Gravity does not turn it about an upright axis.
        (5.0, ("1.5708 0 0", 3), False),
        # It cannot reach the upright position, but sags to a limit.
        (5.0, ("0 -1.0 0", 0.3), True),
    ],
)
@pytest.mark.parametrize("gz", [True, False], ids=["plugin", "controller"])
def test_a_gain_that_does_not_hold_a_load_up_is_reported(tmp_path, pose, p, reported, gz):
    """Gravity's torque C sin(a) grows faster with the angle than p a if p is below C."""
    turned, limits = pose
    limit = f'lower="{-limits}" upper="{limits}" effort="100" velocity="10"'
    arm = beam("beam", "world", limit=limit).replace(
        '<origin xyz="0 0 1"/>', f'<origin xyz="0 0 1" rpy="{turned}"/>', 1
    )
    arm = arm.replace("</joint>", '<dynamics damping="2"/></joint>', 1)
    path = tmp_path / "arm.urdf"
    path.write_text(
        robot(arm + transmission("beam_joint", "Effort"), GZ.format(p=p, i=0.0) if gz else ROS1)
    )
    (tmp_path / "move.yaml").write_text(FILE.format(p=p, i=0.0))
    files = () if gz else (tmp_path / "move.yaml",)
    findings = check(path, controller_files=files).findings
    found = [each for each in findings if each.code is CONTROLLER_GAIN_TOO_LOW]
    assert [each.values["joint"] for each in found] == ["beam_joint"] * reported
    for each in found:
        values = each.values
        assert "load" in values or values["upright"] == pytest.approx(2.0 * 9.8 * 0.5)
    if limits < 1.0:
        # It stays at a limit.
        return
    codes = [each.code for each in try_robot(path, standing=1.0, controllers=files).faults]
    assert codes == [CONTROLLER_GAIN_TOO_LOW] * reported


@pytest.mark.parametrize(("p", "reported"), [(1.0, True), (5.0, True), (15.0, False)])
@pytest.mark.parametrize("gz", [True, False], ids=["plugin", "controller"])
def test_a_gain_that_hardly_lifts_what_hangs_is_reported(tmp_path, p, reported, gz):
    """Gravity pulls 2 kg at 0.5 m back with 9.8 N m/rad: the joint moves to p / (p + 9.8)."""
    arm = beam("beam", "world").replace(
        '<origin xyz="0 0 1"/>', '<origin xyz="0 0 1" rpy="0 1.5708 0"/>', 1
    )
    arm = arm.replace("</joint>", '<dynamics damping="2"/></joint>', 1)
    path = tmp_path / "arm.urdf"
    plugin = GZ.format(p=p, i=0.0) if gz else ROS1
    path.write_text(robot(arm + transmission("beam_joint", "Effort"), plugin))
    (tmp_path / "move.yaml").write_text(FILE.format(p=p, i=0.0))
    files = () if gz else (tmp_path / "move.yaml",)
    findings = check(path, controller_files=files).findings
    found = [each for each in findings if each.code is CONTROLLER_GAIN_TOO_LOW]
    assert [each.values["joint"] for each in found] == ["beam_joint"] * reported
    assert not found or found[0].values["hanging"] == pytest.approx(9.8)
    verdict = try_robot(path, standing=1.0, controllers=files)
    (reach,) = verdict.reaches
    assert reach.reached / reach.target == pytest.approx(p / (p + 9.8), abs=0.01)
    assert [each.code for each in verdict.faults] == [CONTROLLER_GAIN_TOO_LOW] * reported


def upright(dynamics: str = '<dynamics damping="2"/>') -> str:
    """A weight of 2 kg 0.5 m above its joint: 9.8 N m/rad."""
    arm = beam("beam", "world").replace(
        '<origin xyz="0 0 1"/>', '<origin xyz="0 0 1" rpy="0 -1.5708 0"/>', 1
    )
    return arm.replace("</joint>", f"{dynamics}</joint>", 1)


@pytest.mark.parametrize(
    ("p", "friction", "reported"), [(28.0, 0.0, True), (35.0, 0.0, False), (28.0, 1.5, True)]
)
@pytest.mark.parametrize("gz", [True, False], ids=["plugin", "controller"])
def test_a_gain_that_lets_a_load_tip_beyond_its_target_is_reported(
    *, tmp_path, p, friction, reported, gz
):
    """Gravity pushes 2 kg 0.5 m above the joint with 9.8 N m/rad: 0.2 rad becomes 0.2 p / (p -
    9.8), also with friction. Up to 0.3 rad, this is accepted.
    """
    path = tmp_path / "arm.urdf"
    plugin = GZ.format(p=p, i=0.0) if gz else ROS1
    body = upright(f'<dynamics friction="{friction}" damping="2"/>')
    path.write_text(robot(body + transmission("beam_joint", "Effort"), plugin))
    (tmp_path / "move.yaml").write_text(FILE.format(p=p, i=0.0))
    files = () if gz else (tmp_path / "move.yaml",)
    findings = check(path, controller_files=files).findings
    found = [each for each in findings if each.code is CONTROLLER_GAIN_TOO_LOW]
    assert [each.values["upright"] for each in found] == [pytest.approx(9.8)] * reported
    verdict = try_robot(path, standing=1.0, controllers=files)
    (reach,) = verdict.reaches
    if not friction:
        # Where p (a - 0.2) = 9.8 sin(a).
        assert p * (reach.reached - reach.target) == pytest.approx(
            9.8 * math.sin(reach.reached), rel=0.03
        )
    assert [each.code for each in verdict.faults] == [CONTROLLER_GAIN_TOO_LOW] * reported


@pytest.mark.parametrize("gz", [True, False], ids=["plugin", "controller"])
def test_an_integral_does_not_hold_a_load_up(tmp_path, gz):
    """``J s³ + d s² + (p - C) s + i`` has a root with a positive real part if p is below C."""
    path = tmp_path / "arm.urdf"
    plugin = GZ.format(p=5.0, i=30.0) if gz else ROS1
    path.write_text(robot(upright() + transmission("beam_joint", "Effort"), plugin))
    (tmp_path / "move.yaml").write_text(FILE.format(p=5.0, i=30.0))
    files = () if gz else (tmp_path / "move.yaml",)
    found = check(path, controller_files=files).findings
    (weak,) = (each for each in found if each.code is CONTROLLER_GAIN_TOO_LOW)
    assert weak.values["upright"] == pytest.approx(9.8)
    (reach,) = try_robot(path, standing=1.0, controllers=files).reaches
    assert not reach.arrived


@pytest.mark.parametrize(
    "held",
    [
        # Friction above C holds it at each angle, with a gain that overcomes the friction.
        upright('<dynamics friction="11" damping="2"/>'),
        # Gravity does not act on it.
        upright() + '<gazebo reference="beam"><gravity>0</gravity></gazebo>',
    ],
    ids=["friction", "weightless"],
)
def test_a_load_that_something_else_holds_up_is_not_reported(tmp_path, held):
    path = tmp_path / "arm.urdf"
    path.write_text(robot(held, GZ.format(p=5.0, i=0.0)))
    found = check(path).findings
    assert not [each for each in found if "upright" in each.values]


def test_a_part_without_gravity_does_not_move_the_center_of_the_load(tmp_path):
    """A counterweight below the joint, on which gravity does not act, does not balance."""
    counter = (
        '<link name="counter"><inertial><origin xyz="-0.5 0 0"/><mass value="2"/>'
        '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        '<joint name="mount" type="{kind}"><parent link="beam"/><child link="counter"/>'
        '<axis xyz="1 0 0"/></joint><gazebo reference="counter"><gravity>0</gravity></gazebo>'
    )
    path = tmp_path / "arm.urdf"
    path.write_text(robot(upright() + counter.format(kind="continuous"), GZ.format(p=5.0, i=0.0)))
    (weak,) = (each for each in check(path).findings if each.code is CONTROLLER_GAIN_TOO_LOW)
    assert weak.values["upright"] == pytest.approx(9.8)


@pytest.mark.parametrize(("mass", "moment"), [(0.001, -1.0), (0.0, 0.0)])
def test_the_load_of_a_link_with_an_impossible_inertia_is_its_stated_mass(tmp_path, mass, moment):
    """Only its moments are replaced, so that it can be read."""
    tip = (
        f'<link name="tip"><inertial><mass value="{mass}"/><inertia ixx="{moment}" iyy="{moment}" '
        f'izz="{moment}" ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="mount" '
        'type="fixed"><parent link="beam"/><child link="tip"/><origin xyz="1 0 0"/></joint>'
    )
    path = tmp_path / "arm.urdf"
    path.write_text(robot(upright() + tip, GZ.format(p=5.0, i=0.0)))
    (weak,) = (each for each in check(path).findings if each.code is CONTROLLER_GAIN_TOO_LOW)
    assert weak.values["upright"] == pytest.approx(9.8 * (2.0 * 0.5 + mass))


def test_the_gain_of_a_velocity_is_not_compared_with_gravity(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(robot(upright(), ""))
    described = Robot(load_robot(path), None)
    joint = described.joints["beam_joint"]
    assert [*gain_too_low(described, joint, 5.0, None)]
    assert not [*gain_too_low(described, joint, 5.0, None, of_velocity=True)]


def test_the_loads_of_a_long_chain_are_those_of_its_parts(tmp_path):
    """Joint k of n beams along x carries n - k of them, with centres at 0.5, 1.5, … from it."""
    count = 30
    links = "".join(
        beam(f"b{k}", f"b{k - 1}" if k else "world", origin="1 0 0").replace(
            '<origin xyz="1 0 0"/>',
            f'<origin xyz="1 0 0" rpy="0 {0 if k else -math.pi / 2} 0"/>',
        )
        for k in range(count)
    )
    path = tmp_path / "chain.urdf"
    path.write_text(robot(links, ""))
    described = Robot(load_robot(path), None)
    for k in range(count):
        above = sum(0.5 + index for index in range(count - k))
        stiffness = upright_stiffness(described, described.joints[f"b{k}_joint"])
        assert stiffness == pytest.approx(2.0 * 9.8 * above)


@pytest.mark.parametrize(("p", "reported"), [(1.0, True), (400.0, False)])
@pytest.mark.parametrize("side", [1, -1])
def test_a_gain_that_does_not_hold_a_level_arm_at_any_target_is_reported(
    tmp_path, p, reported, side
):
    """The level arm exerts several N m, and the gain at most 2 N m between the limits."""
    limit = 'lower="-1" upper="1" effort="1000" velocity="10"'
    arm = beam("beam", "world", axis=f"0 {side} 0", limit=limit)
    arm = arm.replace("</joint>", '<dynamics damping="5"/></joint>', 1)
    path = tmp_path / "arm.urdf"
    path.write_text(robot(arm, GZ.format(p=p, i=0.0)))
    found = [each for each in check(path).findings if each.code is CONTROLLER_GAIN_TOO_LOW]
    assert [each.values["joint"] for each in found] == ["beam_joint"] * reported
    codes = [each.code for each in try_robot(path, standing=1.0).faults]
    assert codes == [CONTROLLER_GAIN_TOO_LOW] * reported
