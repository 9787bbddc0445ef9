"""Magnetometers."""

import math

import pytest
from tests.devices.position.bodies import floating, unit, vector

from cartwheel.devices.position.magnetometer import dipole_field
from cartwheel.geometry import Pose, quat_from_rpy, rotate


def test_hector_magnetic_is_the_field_in_the_links_axes(make, read):
    """Inclination 60°: it dips into the Earth, along the north where there is no declination."""
    tags = "<magnitude>50</magnitude><topicName>m</topicName><updateRate>20</updateRate>"
    plugin = f'<plugin name="m" filename="libhector_gazebo_ros_magnetic.so">{tags}</plugin>'
    turned = quat_from_rpy(0.2, -0.3, 1.1)
    world = floating(make, unit(plugin), Pose((0, 0, 0), turned))
    messages = read(world, "/m", 1.0)
    assert len(messages) == 21
    felt = rotate(turned, vector(messages[0].vector).tolist())
    assert felt == pytest.approx((25.0, 0.0, -50 * math.sqrt(3) / 2), abs=1e-9)


@pytest.mark.parametrize(
    ("heading", "declination", "inclination"),
    [(0, 0, 60), (90, 0, 0), (0, 15, -30), (40, -25, 70), (-120, 100, 20)],
)
def test_hector_magnetic_points_to_where_the_compass_does(
    make, read, heading, declination, inclination
):
    """Magnetic north lies `declination` east of the north, the x axis `heading` east of it."""
    tags = f"""<magnitude>2</magnitude><referenceHeading>{heading}</referenceHeading>
      <declination>{declination}</declination><inclination>{inclination}</inclination>
      <useMagneticFieldMsgs>true</useMagneticFieldMsgs>"""
    plugin = f'<plugin name="m" filename="libhector_gazebo_ros_magnetic.so">{tags}</plugin>'
    turned = quat_from_rpy(0.2, -0.3, 1.1)
    world = floating(make, unit(plugin), Pose((0, 0, 0), turned))
    (message, *_) = read(world, "/magnetic", 0.1)
    x, y, z = rotate(turned, vector(message.magnetic_field).tolist())
    assert z == pytest.approx(-2 * math.sin(math.radians(inclination)))
    assert math.hypot(x, y) == pytest.approx(2 * math.cos(math.radians(inclination)))
    # A compass measures the clockwise angle from the field to the x axis.
    compass = math.degrees(math.atan2(y, x))
    assert (compass - (heading - declination) + 180) % 360 - 180 == pytest.approx(0, abs=1e-9)
    assert message.header.frame_id == "link"


def test_gz_magnetometer_feels_the_worlds_field(make, read):
    sensor = """<sensor name="m" type="magnetometer"><update_rate>20</update_rate>
      <pose>0 0 0 0 0 1.5707963</pose><topic>m</topic></sensor>"""
    world = floating(make, unit(sensor=sensor), magnetic_field=(2e-5, 1e-6, -4e-5))
    field = vector(read(world, "/m", 1.0)[0].magnetic_field)
    # Turned left by a quarter: what was its left is ahead.
    assert field == pytest.approx([1e-6, -2e-5, -4e-5], abs=1e-11)


def test_a_field_has_its_magnitude_and_dips_below_the_horizon():
    x, y, z = dipole_field(5e-5, math.radians(30), math.radians(60))
    assert math.hypot(x, y, z) == pytest.approx(5e-5)
    assert math.atan2(y, x) == pytest.approx(math.radians(30))
    assert z == pytest.approx(-5e-5 * math.sqrt(3) / 2)
