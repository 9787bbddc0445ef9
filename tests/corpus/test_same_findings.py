"""Reasons that are in the robot's files: `cartwheel check` reports those that `corpus` gives."""

import pytest
from tests.corpus.carts import cart, controlled, plugin, written
from tests.corpus.test_layouts import LAUNCH, TRANSMISSION, WHEEL

import cartwheel
from cartwheel.codes.devices import (
    CONTROLLER_PARAMETER_INVALID,
    CONTROLLER_PARAMETER_MISSING,
    CONTROLLERS_FILE_ARGUMENT,
    CONTROLLERS_FILE_MISMATCH,
    CONTROLLERS_FILE_WITHOUT_CONTROLLERS,
    CONTROLLERS_NOT_FOUND,
    HARDWARE_UNKNOWN,
    HARDWARE_WITHOUT_PLUGIN,
)
from cartwheel.codes.robot import INERTIA_MISSING, MASS_NOT_POSITIVE
from cartwheel.corpus import try_robot

MANAGER = "libgazebo_ros_control.so"


def ros2(tmp_path, old, new, count=1):
    """A cart whose file of controllers contains a mistake."""
    path = written(tmp_path, cart(), controlled(tmp_path))
    file = tmp_path / "base.yaml"
    assert old in file.read_text()
    file.write_text(file.read_text().replace(old, new, count))
    return path


def ros1(tmp_path, old, new, *, wheel="wheel: {type: velocity_controllers/X, joint: left_joint}"):
    """A cart whose description contains a mistake, and a launch file that starts a controller."""
    (tmp_path / "package.xml").write_text("<package><name>cart</name></package>")
    (tmp_path / "wheel.yaml").write_text(wheel)
    (tmp_path / "sim.launch").write_text(LAUNCH)
    assert old in TRANSMISSION
    return written(tmp_path, cart(), TRANSMISSION.replace(old, new))


def kind(text):
    return f'{MANAGER}"><robotSimType>{text}</robotSimType></plugin>'


@pytest.mark.parametrize(
    ("make", "values", "code"),
    [
        (ros2, ("type:", "kind:"), CONTROLLERS_FILE_WITHOUT_CONTROLLERS),
        (ros2, ("ros__parameters", "ros_parameters"), CONTROLLERS_FILE_WITHOUT_CONTROLLERS),
        (
            ros2,
            ("controller_manager:", "/bot/controller_manager:"),
            CONTROLLERS_FILE_WITHOUT_CONTROLLERS,
        ),
        (ros2, ("ros__parameters", "parameters", 2), CONTROLLERS_FILE_MISMATCH),
        (ros2, ("0.05", "$(var radius)"), CONTROLLERS_FILE_ARGUMENT),
        (ros2, ("0.05", "wide"), CONTROLLER_PARAMETER_INVALID),
        (ros2, ("left_wheel_names", "left_wheels"), CONTROLLER_PARAMETER_MISSING),
        (ros1, ("", ""), CONTROLLERS_NOT_FOUND),
        (ros1, (f'{MANAGER}"/>', kind("gazebo_ros_control/Own")), HARDWARE_UNKNOWN),
        (ros1, (MANAGER, "libgazebo_ros_p3d.so"), HARDWARE_WITHOUT_PLUGIN),
    ],
)
def test_check_reports_why_no_controller_starts(tmp_path, make, values, code):
    if code is CONTROLLERS_NOT_FOUND:
        path = make(tmp_path, *values, wheel=WHEEL)
    else:
        path = make(tmp_path, *values)
    verdict = try_robot(path, standing=1.0)
    # A plugin that cannot be configured is left out for this reason.
    (reason,) = (
        each.reason
        for each in verdict.faults
        if each.code is code or each.reason.values.get("cause") == code.number
    )
    (found,) = (each for each in cartwheel.check(path).findings if each.code is code)
    assert found.message in reason.message


@pytest.mark.parametrize(
    ("text", "code"),
    [
        (WHEEL, CONTROLLERS_FILE_MISMATCH),
        ("wheel: {joint: left_joint}", CONTROLLERS_FILE_WITHOUT_CONTROLLERS),
        ("wheel: {type: a/B, joint: $(arg x)}", CONTROLLERS_FILE_ARGUMENT),
        ("wheel: {type: velocity_controllers/JointVelocityController, joint: left_joint}", None),
    ],
)
def test_check_reports_files_that_ros_1_cannot_use(tmp_path, text, code):
    path = written(tmp_path, cart(), TRANSMISSION)
    (tmp_path / "given.yaml").write_text(text)
    codes = {CONTROLLERS_FILE_ARGUMENT, CONTROLLERS_FILE_MISMATCH}
    codes.add(CONTROLLERS_FILE_WITHOUT_CONTROLLERS)
    report = cartwheel.check(path, controllers=[tmp_path / "given.yaml"])
    assert [each.code for each in report.findings if each.code in codes] == [code] * bool(code)


def test_check_reports_a_base_without_mass(tmp_path):
    """Gazebo does not load a robot whose root link, with the links fixed to it, has no mass."""
    text = cart().replace('<mass value="2"/>', '<mass value="0"/>')
    path = written(tmp_path, text, plugin())
    (fault,) = try_robot(path, standing=1.0).faults
    assert fault.code is INERTIA_MISSING
    found = [each for each in cartwheel.check(path).findings if each.code is MASS_NOT_POSITIVE]
    assert [each.values["link"] for each in found] == ["base"]
    held = text.replace(
        '<link name="front">', '<link name="front"><inertial><mass value="1"/>'
        '<inertia ixx="1e-3" iyy="1e-3" izz="1e-3" ixy="0" ixz="0" iyz="0"/></inertial>'
    )  # fmt: skip
    codes = {each.code for each in cartwheel.check(written(tmp_path, held, plugin())).findings}
    assert MASS_NOT_POSITIVE not in codes
