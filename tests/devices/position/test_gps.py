"""Receivers of satellite navigation."""

import math

import numpy as np
import pytest
from tests.devices.position.bodies import floating, spherical, unit, vector

from cartwheel.devices.position.geodesy import EQUATOR, Datum
from cartwheel.geometry import Pose


def test_hector_gps_publishes_latitude_longitude_and_velocity(make, read):
    """Its world's x is north and y is west; a minute of arc north is a nautical mile or so."""
    tags = """<referenceLatitude>52</referenceLatitude><referenceLongitude>13</referenceLongitude>
      <referenceAltitude>30</referenceAltitude><updateRate>10</updateRate>"""
    plugin = f'<plugin name="g" filename="libhector_gazebo_ros_gps.so">{tags}</plugin>'
    world = floating(make, unit(plugin), Pose((1000, 500, 5)))
    world.session.simulation.data.joint("unit::link").qvel[:3] = [1.0, 2.0, 0.5]
    box = world.mailbox("/fix_velocity")
    fixes = read(world, "/fix", 1.0)
    assert len(fixes) == 11
    expected = Datum(latitude=math.radians(52), longitude=math.radians(13), height=30).locate(
        (-500.0, 1000.0, 5.0)
    )
    fix = fixes[0]
    # A kilometre off, a flat Earth is wrong by the square of that over twice its radius.
    assert fix.latitude == pytest.approx(math.degrees(expected[0]), abs=1e-6)
    assert fix.longitude == pytest.approx(math.degrees(expected[1]), abs=2e-6)
    assert fix.altitude == pytest.approx(35.0)
    assert vector(box.drain()[0].vector) == pytest.approx([1.0, 2.0, 0.5])
    assert fix.header.frame_id == "world"


def test_hector_gps_takes_the_worlds_reference_when_asked(make, read):
    tags = "<useWorldSphericalCoordinates>true</useWorldSphericalCoordinates>"
    plugin = f'<plugin name="g" filename="libhector_gazebo_ros_gps.so">{tags}</plugin>'
    world = floating(
        make, unit(plugin), Pose((0, 1000, 0)), spherical_coordinates=spherical(-33.0, 151.0, 12.0)
    )
    fix = read(world, "/fix", 1.0)[0]
    # Its y is north then, since its x is east.
    expected = Datum(latitude=math.radians(-33), longitude=math.radians(151)).locate((0, 1000, 0))
    assert fix.latitude == pytest.approx(math.degrees(expected[0]), abs=1e-6)
    assert fix.longitude == pytest.approx(151.0, abs=1e-9)
    assert fix.altitude == pytest.approx(12.0)


@pytest.mark.parametrize("heading", [0.0, 30.0, 90.0, -135.0, 400.0])
def test_hector_gps_turns_place_and_velocity_by_the_heading(make, read, heading):
    """The world's x axis points that far from the north towards the east."""
    tags = f"""<referenceLatitude>-20</referenceLatitude>
      <referenceLongitude>150</referenceLongitude>
      <referenceHeading>{heading}</referenceHeading><updateRate>10</updateRate>"""
    plugin = f'<plugin name="g" filename="libhector_gazebo_ros_gps.so">{tags}</plugin>'
    world = floating(make, unit(plugin), Pose((300, -70, 5)))
    world.session.simulation.data.joint("unit::link").qvel[:3] = [1.0, 2.0, 0.5]
    box = world.mailbox("/fix_velocity")
    fix = read(world, "/fix", 0.2)[0]
    turn = math.radians(heading)
    # Ahead is (cos, sin) in north and east, left of it (sin, -cos).
    axes = np.array([[math.cos(turn), math.sin(turn)], [math.sin(turn), -math.cos(turn)]])
    north, east = np.array([300, -70]) @ axes
    datum = Datum(latitude=math.radians(-20), longitude=math.radians(150))
    expected = datum.locate((east, north, 5.0))
    assert fix.latitude == pytest.approx(math.degrees(expected[0]), abs=2e-7)
    assert fix.longitude == pytest.approx(math.degrees(expected[1]), abs=2e-7)
    north, east = np.array([1.0, 2.0]) @ axes
    assert vector(box.drain()[0].vector) == pytest.approx([north, -east, 0.5])


@pytest.mark.parametrize("heading", [0.0, 30.0, -135.0])
def test_sensors_take_the_worlds_heading(make, read, heading):
    """Here it is the angle of the world's x axis from the east towards the north (SDF)."""
    sensor = """<sensor name="gps" type="gps"><update_rate>10</update_rate>
      <plugin name="g" filename="libgazebo_ros_gps_sensor.so"/></sensor>"""
    world = floating(
        make,
        unit(sensor=sensor),
        Pose((300, -70, 5)),
        spherical_coordinates=spherical(60.0, -100.0, heading=heading),
    )
    world.session.simulation.data.joint("unit::link").qvel[:3] = [1.0, 2.0, 0.5]
    box = world.mailbox("/g/vel")
    fix = read(world, "/g/out", 0.2)[0]
    turn = math.radians(heading)
    axes = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
    east, north = np.array([300, -70]) @ axes
    datum = Datum(latitude=math.radians(60), longitude=math.radians(-100))
    expected = datum.locate((east, north, 5.0))
    assert fix.latitude == pytest.approx(math.degrees(expected[0]), abs=1e-7)
    assert fix.longitude == pytest.approx(math.degrees(expected[1]), abs=1e-7)
    east, north = np.array([1.0, 2.0]) @ axes
    assert vector(box.drain()[0].vector) == pytest.approx([east, north, 0.5])


GPS_NOISE = """<position_sensing><horizontal><noise type="gaussian"><stddev>0.5</stddev></noise>
  </horizontal><vertical><noise type="gaussian"><stddev>1.0</stddev></noise></vertical>
  </position_sensing>"""


def test_ros2_gps_sensor_publishes_the_worlds_place(make, read):
    sensor = """<sensor name="gps" type="gps"><update_rate>10</update_rate>
      <pose>0 0 1 0 0 0</pose><plugin name="gps_plugin" filename="libgazebo_ros_gps_sensor.so">
      <ros><namespace>/demo</namespace><remapping>~/out:=fix</remapping></ros></plugin></sensor>"""
    world = floating(
        make,
        unit(sensor=sensor),
        Pose((300, 400, 0)),
        spherical_coordinates=spherical(47.0, 8.0, 500.0),
    )
    fixes = read(world, "/demo/fix", 1.0)
    assert len(fixes) == 11
    expected = Datum(latitude=math.radians(47), longitude=math.radians(8), height=500.0).locate(
        (300, 400, 1)
    )
    assert fixes[0].latitude == pytest.approx(math.degrees(expected[0]), abs=1e-10)
    assert fixes[0].longitude == pytest.approx(math.degrees(expected[1]), abs=1e-10)
    assert fixes[0].altitude == pytest.approx(expected[2], abs=1e-6)
    assert fixes[0].header.frame_id == "link"
    assert "/demo/gps_plugin/vel" in [topic.name for topic in world.graph.topics()]


def test_gz_navsat_scatters_as_its_noise_says(make, read):
    sensor = f"""<sensor name="n" type="navsat"><update_rate>100</update_rate><topic>navsat</topic>
      <navsat>{GPS_NOISE}</navsat></sensor>"""
    world = floating(make, unit(sensor=sensor), spherical_coordinates=spherical(0.0, 0.0))
    fixes = read(world, "/navsat", 20.0)
    heights = np.array([fix.altitude for fix in fixes])
    norths = np.radians([fix.latitude for fix in fixes]) * EQUATOR
    count = len(fixes)
    assert heights.std() == pytest.approx(1.0, rel=4 / math.sqrt(2 * count))
    # At the equator the meridian is a little rounder than the equator itself.
    assert norths.std() == pytest.approx(0.5, rel=4 / math.sqrt(2 * count) + 0.01)
    assert np.diag(fixes[0].position_covariance.reshape(3, 3)) == pytest.approx([0.25, 0.25, 1])
