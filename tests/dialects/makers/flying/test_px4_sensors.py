"""PX4's sensors: topics, places and errors."""

import math

import numpy as np
import pytest

from cartwheel.description.model import Element
from cartwheel.errors import Origin


def body(make, plugins, sensors=""):
    return make.sdf(f"""<model name="iris"><link name="base"><inertial><mass>1</mass></inertial>
      {sensors}</link>{plugins}</model>""")


def run(make, model, topic, seconds=1.0, **world):
    world = make.world(step=0.004, gravity=0.0, **world)
    world.session.spawn(model)
    box = world.mailbox(topic)
    world.run(seconds)
    return box.drain()


def spherical(latitude, longitude, elevation):
    origin = Origin(file="w.world", line=1)
    values = {"latitude_deg": latitude, "longitude_deg": longitude, "elevation": elevation}
    children = tuple(
        Element(tag=name, attributes={}, text=str(value), children=(), origin=origin)
        for name, value in values.items()
    )
    return Element(
        tag="spherical_coordinates", attributes={}, text="", children=children, origin=origin
    )


GPS = """<sensor name="gps" type="gps"><plugin name="gps" filename="libgazebo_gps_plugin.so">
  {}</plugin></sensor>"""


def test_the_receiver_is_in_zurich_by_default(make):
    fixes = run(make, body(make, "", GPS.format("")), "/iris/link/iris")
    assert len(fixes) == 6
    assert (fixes[0].latitude, fixes[0].longitude) == (47.397742, 8.545594)
    assert fixes[0].altitude == pytest.approx(488.0)


def test_the_place_and_the_topic_are_stated(make):
    tags = """<topic>gps7</topic><homeLatitude>-30</homeLatitude><homeLongitude>150</homeLongitude>
      <homeAltitude>9</homeAltitude><update_rate>10</update_rate>"""
    fixes = run(make, body(make, "", GPS.format(tags)), "/iris/link/gps7")
    assert len(fixes) == 11
    assert (fixes[0].latitude, fixes[0].longitude) == pytest.approx((-30.0, 150.0))
    assert fixes[0].altitude == pytest.approx(9.0)


def test_the_world_states_the_place(make):
    plugin = '<plugin name="t" filename="libgazebo_groundtruth_plugin.so"/>'
    fixes = run(
        make,
        body(make, plugin),
        "/iris/groundtruth",
        0.1,
        spherical_coordinates=spherical(10, 20, 30),
    )
    assert len(fixes) == 26
    found = (fixes[0].latitude, fixes[0].longitude, fixes[0].altitude)
    assert found == pytest.approx((10.0, 20.0, 30.0))


def test_the_receiver_has_noise(make):
    noisy = body(make, "", GPS.format("<gpsNoise>1</gpsNoise><update_rate>50</update_rate>"))
    velocities = run(make, noisy, "/iris/link/iris_velocity", 20.0)
    east = [message.vector.x for message in velocities]
    up = [message.vector.z for message in velocities]
    # The deviation of 1000 samples has an error of 2 %.
    assert np.std(east) == pytest.approx(0.2 * math.sqrt(0.004), rel=0.1)
    assert np.std(up) == pytest.approx(0.4 * math.sqrt(0.004), rel=0.1)


def test_the_magnetometer_measures_in_axes_forward_left_up(make):
    plugin = """<plugin name="m" filename="libgazebo_magnetometer_plugin.so">
      <noiseDensity>0</noiseDensity><randomWalk>0</randomWalk></plugin>"""
    messages = run(make, body(make, plugin), "/iris/mag")
    assert len(messages) == 101
    field = messages[0].magnetic_field
    # The body's x axis points east and its y axis north.
    assert field.y == pytest.approx(21.5e-6, abs=0.5e-6)
    assert field.z == pytest.approx(-42.8e-6, abs=0.5e-6)


def test_the_barometer_drifts(make):
    plugin = """<plugin name="b" filename="libgazebo_barometer_plugin.so">
      <baroDriftPaPerSec>20</baroDriftPaPerSec></plugin>"""
    pressures = [each.fluid_pressure for each in run(make, body(make, plugin), "/iris/baro", 10.0)]
    # 488 m above sea level in the International Standard Atmosphere; the noise is 1 Pa.
    assert pressures[0] == pytest.approx(95600.0, abs=5.0)
    assert pressures[-1] - pressures[0] == pytest.approx(200.0, abs=5.0)


def test_the_imu_has_the_topic_of_its_model(make):
    plugin = """<plugin name="i" filename="libgazebo_imu_plugin.so"><linkName>base</linkName>
      <imuTopic>/imu2</imuTopic></plugin>"""
    assert len(run(make, body(make, plugin), "/iris/imu2", 0.1)) == 26
