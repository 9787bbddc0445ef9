"""Proportional gains that do not overcome the friction of a joint, or do not hold its load."""

import pytest
from tests.dialects.ros_control.arms import ROS1, beam, robot, transmission

from cartwheel.checks.checking import check
from cartwheel.codes.devices import CONTROLLER_GAIN_TOO_LOW
from cartwheel.corpus import try_robot

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
    ("p", "i", "reported"), [(3.0, 0.0, True), (12.0, 0.0, False), (3.0, 30.0, False)]
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
    (10.0, "0 0 1", True), (10.0, "0 0 -1", True), (10.0, "1 0 0", False), (90.0, "0 0 1", False),
])  # fmt: skip
@pytest.mark.parametrize("gz", [True, False], ids=["plugin", "controller"])
def test_a_gain_that_does_not_hold_a_weight_within_the_limits_is_reported(
    tmp_path, p, axis, reported, gz
):
    """A weight of 2 kg on a slide of 1 m: a gain of 20 N/m would just hold it at its end."""
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
    codes = [each.code for each in try_robot(path, standing=1.0, controllers=files).faults]
    assert codes == [CONTROLLER_GAIN_TOO_LOW] * reported


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
        # It starts near the horizontal, or hangs.
        (5.0, ("0 0.2 0", 3), False),
        (5.0, ("0 1.5708 0", 3), False),
        # Gravity does not turn it about an upright axis.
        (5.0, ("1.5708 0 0", 3), False),
        # It cannot reach the upright position.
        (5.0, ("0 -1.0 0", 0.3), False),
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
    assert not found or found[0].values["upright"] == pytest.approx(2.0 * 9.8 * 0.5)
    if limits < 1.0:
        # It stays at a limit.
        return
    codes = [each.code for each in try_robot(path, standing=1.0, controllers=files).faults]
    assert codes == [CONTROLLER_GAIN_TOO_LOW] * reported
