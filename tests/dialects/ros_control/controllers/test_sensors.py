"""Broadcasters of sensors: an IMU on a turning beam, a joint that bears one."""

import math

import pytest
import yaml
from tests.dialects.ros_control.arms import (
    ARM,
    GRAVITY,
    MASS,
    beam,
    robot,
    ros2_joint,
    ros2_parameters,
    ros2_plugin,
)
from tests.dialects.ros_control.arms import ros2_system as system

RATE = 2.0
"""rad/s."""


def sensor(name, kind, pose="", inside=""):
    return f"""<sensor name="{name}" type="{kind}">{f"<pose>{pose}</pose>" if pose else ""}
      <always_on>true</always_on>{inside}</sensor>"""


def spawn(bench, tmp_path, body, tags, sensors, **controllers):
    file = tmp_path / "own.yaml"
    file.write_text(yaml.safe_dump(ros2_parameters(**controllers)))
    reported = "".join(
        f'<sensor name="{name}"><state_interface name="{state}"/></sensor>'
        for name, state in sensors.items()
    )
    hardware = system(ros2_joint("beam_joint", "position", "velocity"), reported)
    urdf = robot(body + hardware, ros2_plugin(file)).replace("</robot>", f"{tags}</robot>")
    made = bench(urdf)
    made.world.run(0.1)
    return made


def imu(bench, tmp_path, inside="", pose=f"{ARM} 0 0 0 0 {math.pi / 2}", **more):
    """A unit half a metre out on a beam that turns about the vertical, its x axis ahead."""
    tags = f'<gazebo reference="beam">{sensor("unit", "imu", pose, inside)}</gazebo>'
    made = spawn(
        bench, tmp_path, beam("beam", "world", axis="0 0 1", kind="continuous"), tags,
        {"unit": "orientation.x"},
        reported={
            "type": "imu_sensor_broadcaster/IMUSensorBroadcaster",
            "sensor_name": "unit",
            "frame_id": "unit_frame",
            **more,
        },
        turn={
            "type": "velocity_controllers/JointGroupVelocityController",
            "joints": ["beam_joint"],
        },
    )  # fmt: skip
    made.publish("/turn/commands", "std_msgs/msg/Float64MultiArray", data=[RATE])
    made.world.run(1.0)
    return made


def test_an_imu_feels_the_centre_and_the_ground(bench, tmp_path):
    """In its axes: gravity's reaction up, and inwards, which is its y, the rate squared."""
    covariance = [float(number) for number in range(9)]
    made = imu(bench, tmp_path, static_covariance_angular_velocity=covariance)
    box = made.box("/reported/imu")
    made.world.run(0.1)
    found = box.drain()
    assert len(found) == 10
    last = found[-1]
    assert last.header.frame_id == "unit_frame"
    assert [last.angular_velocity.x, last.angular_velocity.y, last.angular_velocity.z] == (
        pytest.approx([0.0, 0.0, RATE], abs=1e-3)
    )
    felt = last.linear_acceleration
    assert [felt.x, felt.y, felt.z] == pytest.approx([0.0, RATE**2 * ARM, GRAVITY], abs=0.01)
    # Half a turn of its own between its axes and the beam's.
    turn = 2 * math.atan2(last.orientation.z, last.orientation.w)
    expected = made.position("beam_joint") + math.pi / 2
    assert math.remainder(turn - expected, 2 * math.pi) == pytest.approx(0.0, abs=0.03)
    assert last.angular_velocity_covariance.tolist() == covariance


def test_an_imu_has_the_noise_of_its_sensor(bench, tmp_path):
    noise = "".join(
        f"<{axis}><noise type='gaussian'><mean>0</mean><stddev>0.2</stddev></noise></{axis}>"
        for axis in "xyz"
    )
    made = imu(bench, tmp_path, f"<imu><angular_velocity>{noise}</angular_velocity></imu>")
    box = made.box("/reported/imu")
    made.world.run(4.0)
    rates = [each.angular_velocity.z for each in box.drain()]
    mean = sum(rates) / len(rates)
    spread = math.sqrt(sum((rate - mean) ** 2 for rate in rates) / (len(rates) - 1))
    # 400 of them: the mean is off by less than four of its errors, the spread by a seventh.
    assert mean == pytest.approx(RATE, abs=4 * 0.2 / math.sqrt(400))
    assert spread == pytest.approx(0.2, rel=0.15)


def force(bench, tmp_path, inside="", **more):
    """A beam that is held out level by a joint which measures what it bears."""
    reported = sensor("load", "force_torque", inside=f"<force_torque>{inside}</force_torque>")
    tags = (
        f'<gazebo reference="beam_joint"><provideFeedback>true</provideFeedback>{reported}</gazebo>'
    )
    made = spawn(
        bench, tmp_path, beam("beam", "world"), tags, {"load": "force.z"},
        reported={
            "type": "force_torque_sensor_broadcaster/ForceTorqueSensorBroadcaster",
            "sensor_name": "load",
            "frame_id": "load_frame",
            **more,
        },
        hold={
            "type": "position_controllers/JointGroupPositionController",
            "joints": ["beam_joint"],
        },
    )  # fmt: skip
    made.publish("/hold/commands", "std_msgs/msg/Float64MultiArray", data=[0.0])
    made.world.run(0.5)
    box = made.box("/reported/wrench")
    made.world.run(0.05)
    wrench = box.drain()[-1].wrench
    return [wrench.force.x, wrench.force.y, wrench.force.z,
            wrench.torque.x, wrench.torque.y, wrench.torque.z]  # fmt: skip


def test_a_joint_bears_the_weight_and_its_lever(bench, tmp_path):
    """The beam pulls down with its weight, and about the joint by it times half a metre."""
    weight = MASS * GRAVITY
    found = force(bench, tmp_path)
    assert found == pytest.approx([0.0, 0.0, -weight, 0.0, weight * ARM, 0.0], abs=0.02)


def test_the_other_direction_an_offset_and_a_factor(bench, tmp_path):
    weight = MASS * GRAVITY
    found = force(
        bench,
        tmp_path,
        "<measure_direction>parent_to_child</measure_direction>",
        **{"multiplier.force.z": 2.0, "offset.force.x": 1.5},
    )
    assert found == pytest.approx([1.5, 0.0, 2 * weight, 0.0, -weight * ARM, 0.0], abs=0.04)
