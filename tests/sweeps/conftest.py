"""The world of the tests: the example cart, and an IMU with noise."""

import pytest

import cartwheel as cw

GYRO = """<sdf version="1.7"><model name="gyro"><static>true</static><pose>0 5 0 0 0 0</pose>
<link name="link"><sensor name="imu" type="imu"><update_rate>100</update_rate><imu>
<angular_velocity><z><noise type="gaussian"><mean>0</mean><stddev>0.1</stddev></noise></z>
</angular_velocity></imu><plugin name="gyro" filename="libgazebo_ros_imu_sensor.so"><ros>
<remapping>~/out:=/gyro</remapping></ros></plugin></sensor></link></model></sdf>"""


@pytest.fixture(scope="session")
def gyro(tmp_path_factory):
    file = tmp_path_factory.mktemp("sweep") / "gyro.sdf"
    file.write_text(GYRO)
    return file


@pytest.fixture(scope="session")
def built(gyro):
    return cw.build("empty", ["rosbots.xacro", gyro])
