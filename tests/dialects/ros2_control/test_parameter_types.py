"""Values of another type than the one that a controller of ROS 2 declares."""

from __future__ import annotations

from pathlib import Path

import pytest

from cartwheel import yaml_text
from cartwheel.codes import devices
from cartwheel.dialects.ros2_control.mistyped import mistyped, mistyped_manager
from cartwheel.dialects.ros2_control.refused_files import refused_file
from cartwheel.dialects.ros2_control.scalars import scalar_type
from cartwheel.dialects.ros_control.files import controller_entries, read_yaml, ros2_file

DRIVE = "diff_drive_controller/DiffDriveController"
TRICYCLE = "tricycle_controller/TricycleController"
ARM = "joint_trajectory_controller/JointTrajectoryController"
PID = "pid_controller/PidController"


def written(folder: Path, kind: str, *lines: str, shared: str = "") -> Path:
    """A file with a controller ``one`` and its parameters."""
    path = folder / "one.yaml"
    manager = "controller_manager:\n  ros__parameters:\n    one: {type: " + kind + "}\n"
    own = "".join(f"    {line}\n" for line in lines)
    path.write_text(f"{manager}one:\n  ros__parameters:\n{own}{shared}")
    return path


def wrong(path: Path, *, classic: bool = False) -> list[tuple[str, object, int, str]]:
    """The parameters of the wrong type, with the right value, the line and its replacement."""
    (entry,) = controller_entries(ros2_file([read_yaml(path)], ""), "", "")
    found = list(mistyped(entry, [path], classic=classic))
    assert {each.code for each in found} <= {devices.CONTROLLER_PARAMETER_TYPE}
    assert all(each.values["controller"] == "one" for each in found)
    return [
        (
            str(each.values["parameter"]),
            each.values["meant"],
            each.origin.line if each.origin else 0,
            each.instead,
        )
        for each in found
    ]


@pytest.mark.parametrize(
    ("kind", "line", "found"),
    [
        (DRIVE, "publish_rate: 50  # Hz", ("publish_rate", "50.0", "publish_rate: 50.0  # Hz")),
        (DRIVE, 'wheel_radius: "0.1"', ("wheel_radius", "0.1", "wheel_radius: 0.1")),
        (DRIVE, "wheel_radius: 0x10", ("wheel_radius", "16.0", "wheel_radius: 16.0")),
        (
            DRIVE,
            "linear: {x: {max_velocity: -1}}",
            ("linear.x.max_velocity", "-1.0", "linear: {x: {max_velocity: -1.0}}"),
        ),
        (
            DRIVE,
            "angular.z.max_velocity: 2",
            ("angular.z.max_velocity", "2.0", "angular.z.max_velocity: 2.0"),
        ),
        (
            DRIVE,
            "twist_covariance_diagonal: [0, 1]",
            ("twist_covariance_diagonal", "[0.0, 1.0]", "twist_covariance_diagonal: [0.0, 1.0]"),
        ),
        (DRIVE, "open_loop: 1", ("open_loop", "true", "open_loop: true")),
        (DRIVE, "left_wheel_names: a", ("left_wheel_names", "[a]", "left_wheel_names: [a]")),
        (
            DRIVE,
            "velocity_rolling_window_size: 10.0",
            ("velocity_rolling_window_size", "10", "velocity_rolling_window_size: 10"),
        ),
        (DRIVE, "update_rate: 10.0", ("update_rate", "10", "update_rate: 10")),
        (TRICYCLE, "cmd_vel_timeout: 500.0", ("cmd_vel_timeout", "500", "cmd_vel_timeout: 500")),
        # It is unknown what is meant.
        (TRICYCLE, "cmd_vel_timeout: 0.5", ("cmd_vel_timeout", "", "")),
        (
            ARM,
            "constraints.stopped_velocity_tolerance: 0",
            (
                "constraints.stopped_velocity_tolerance",
                "0.0",
                "constraints.stopped_velocity_tolerance: 0.0",
            ),
        ),
    ],
)
def test_a_value_of_another_type_is_found_at_its_line(kind, line, found, tmp_path):
    name, meant, instead = found
    assert wrong(written(tmp_path, kind, "use_sim_time: true", line)) == [(name, meant, 7, instead)]


@pytest.mark.parametrize(
    ("kind", "line"),
    [
        (DRIVE, "publish_rate: 50.0"),
        (DRIVE, "publish_rate: 5e1"),
        (DRIVE, "publish_rate: .inf"),
        (DRIVE, "wheel_radius: $(var radius)"),
        (DRIVE, "left_wheel_names: [a]"),
        (DRIVE, "velocity_rolling_window_size: 10"),
        # An unknown parameter is reported as such.
        (DRIVE, "publish_rates: 50"),
        # Values that no reader accepts are reported as invalid.
        (DRIVE, 'publish_rate: "often"'),
        (TRICYCLE, "cmd_vel_timeout: 500"),
        # The types of another controller are not known.
        ("my_controllers/Wobble", "publish_rate: 50"),
        # Husarion's controller of this name declares other parameters.
        (
            "mecanum_drive_controller/MecanumDriveController",
            "{front_left_wheel_name: a, reference_timeout: 1}",
        ),
    ],
)
def test_a_value_of_the_declared_type_or_of_an_unknown_one_is_not_reported(kind, line, tmp_path):
    path = written(tmp_path, kind, "use_sim_time: true")
    inner = line.strip("{}").split(", ") if line.startswith("{") else [line]
    assert wrong(written(tmp_path, kind, *inner)) == []
    assert path.is_file()


@pytest.mark.parametrize(
    ("kind", "line", "found"),
    [
        (ARM, "joints: 5", []),
        (ARM, "joints: true", []),
        (PID, "dof_names: 1.5", []),
        # Larger than the largest double.
        (DRIVE, f'wheel_radius: "0x{"f" * 400}"', []),
        (DRIVE, 'publish_rate: "inf"', [("publish_rate", ".inf", 7, "publish_rate: .inf")]),
        (DRIVE, "publish_rate: |\n      50", [("publish_rate", "50.0", 7, "")]),
    ],
)
def test_unusual_values(kind, line, found, tmp_path):
    assert wrong(written(tmp_path, kind, "use_sim_time: true", line)) == found


def test_a_file_is_read_once_for_many_joints_and_lines(tmp_path, monkeypatch):
    reads = []
    read = yaml_text.read
    monkeypatch.setattr(yaml_text, "read", lambda path: reads.append(path) or read(path))
    joints = [f"j{number}" for number in range(100)]
    gains = ("gains:", *(f"  {joint}: {{p: 1}}" for joint in joints))
    path = written(tmp_path, ARM, f"joints: [{', '.join(joints)}]", *gains)
    (entry,) = controller_entries(ros2_file([read_yaml(path)], ""), "", "")
    reads.clear()
    assert len(list(mistyped(entry, [path], classic=False))) == len(joints)
    assert len(reads) <= 2


def test_gains_are_those_of_the_joints(tmp_path):
    gains = ("gains:", "  a: {p: 100, i: 0.0, d: 1}", "  other: {p: 1}")
    assert wrong(written(tmp_path, ARM, "joints: [a]", *gains)) == [
        ("gains.a.p", "100.0", 8, "a: {p: 100.0, i: 0.0, d: 1.0}")
    ]
    assert wrong(written(tmp_path, PID, "dof_names: [other]", *gains)) == [
        ("gains.other.p", "1.0", 9, "other: {p: 1.0}")
    ]


def test_a_parameter_of_all_nodes_counts_unless_the_controller_has_its_own(tmp_path):
    shared = "/**:\n  ros__parameters:\n    publish_rate: 50\n"
    (found,) = wrong(written(tmp_path, DRIVE, "open_loop: true", shared=shared))
    assert found == ("publish_rate", "50.0", 9, "publish_rate: 50.0")
    assert wrong(written(tmp_path, DRIVE, "publish_rate: 50.0", shared=shared)) == []


def test_what_only_humble_declares_is_reported_for_gazebo_classic(tmp_path):
    path = written(tmp_path, ARM, "joints: [a]", "state_publish_rate: 50")
    assert wrong(path) == []
    assert [each[0] for each in wrong(path, classic=True)] == ["state_publish_rate"]


def test_a_controller_of_the_repository_may_declare_other_types(tmp_path):
    (tmp_path / ".git").mkdir()
    (tmp_path / "package.xml").write_text("<package><name>diff_drive_controller</name></package>")
    path = written(tmp_path, DRIVE, "publish_rate: 50")
    assert len(wrong(path)) == 1
    (tmp_path / "plugins.xml").write_text(
        f'<library path="d"><class name="{DRIVE}" type="diff_drive_controller::DiffDriveController"'
        ' base_class_type="controller_interface::ControllerInterface"/></library>'
    )
    assert wrong(path) == []


def test_the_rate_of_the_manager_is_an_integer(tmp_path):
    path = tmp_path / "one.yaml"
    for rate, meant in (("100.0", ["100"]), ("100", []), ("'100'", ["100"])):
        path.write_text(f"controller_manager:\n  ros__parameters:\n    update_rate: {rate}\n")
        manager = ros2_file([read_yaml(path)], "").manager
        found = list(mistyped_manager("controller_manager", manager, [path]))
        assert [each.values["meant"] for each in found] == meant
        assert all(each.values["stops"] is True for each in found)


@pytest.mark.parametrize(
    ("text", "quoted", "kind"),
    [
        ("5", False, "integer"),
        ("-5", False, "integer"),
        ("08", False, "double"),
        ("5.", False, "double"),
        (".5", False, "double"),
        ("1e3", False, "double"),
        ("nan", False, "double"),
        ("-.INF", False, "double"),
        ("on", False, "bool"),
        ("off", True, "string"),
        ("5", True, "string"),
        ("5 m", False, "string"),
        ("$(var rate)", False, ""),
        ("99999999999999999999", False, ""),
    ],
)
def test_the_types_of_values(text, quoted, kind):
    assert scalar_type(text, quoted=quoted) == kind


@pytest.mark.parametrize(
    ("lines", "line", "instead"),
    [
        (["pose: [0, 0.5, 1]"], 3, "pose: [0.0, 0.5, 1.0]"),
        (["names: [a, 1]"], 3, ""),
        (["limits:", "  max:"], 4, ""),
        (["a: &x [1.0]", "b: *x"], 4, ""),
        (["pairs: [[1, 2], [3, 4]]"], 3, ""),
    ],
)
def test_a_file_that_only_the_parser_of_ros_2_refuses(lines, line, instead, tmp_path):
    path = tmp_path / "one.yaml"
    path.write_text("one:\n  ros__parameters:\n" + "".join(f"    {each}\n" for each in lines))
    found = refused_file(path)
    assert found is not None
    assert found.code is devices.CONTROLLERS_FILE_UNREADABLE
    assert (found.origin.line, found.instead) == (line, instead)
    assert found.values["stops"] is True


def test_values_outside_of_the_parameters_are_refused(tmp_path):
    path = tmp_path / "one.yaml"
    good = "one:\n  ros__parameters:\n    pose: [0.0, 0.5]\n    names: [a, b]\n    empty: ''\n"
    path.write_text(good)
    assert refused_file(path) is None
    path.write_text(good + "two:\n  type: a/B\n")
    found = refused_file(path)
    assert found is not None
    assert found.origin.line == 7
