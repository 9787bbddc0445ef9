"""GPS, magnetometers and units that drift: by geodesy, by rotation, by their own statistics."""

import math

import numpy as np
import pytest

from cartwheel.codes import devices, running
from cartwheel.description.model import Element
from cartwheel.devices.position.geodesy import EQUATOR, FLATTENING, Datum, from_earth, to_earth
from cartwheel.errors import Origin, PluginError
from cartwheel.geometry import Pose, quat_from_rpy, rotate
from cartwheel.messages import message_class

G = 9.8
HERE = Origin(file="test.world", line=1)

BOX = """<link name="link"><inertial><mass>4</mass><inertia><ixx>0.06</ixx><iyy>0.06</iyy>
  <izz>0.1</izz></inertia></inertial>{sensor}</link>{plugin}"""


def unit(plugin="", sensor=""):
    return f'<model name="unit">{BOX.format(sensor=sensor, plugin=plugin)}</model>'


def vector(message):
    return np.array([message.x, message.y, message.z])


def floating(make, model, pose=None, **more):
    """Without weight, so that it stays or goes on."""
    world = make.world(ground=None, gravity=0.0, **more)
    world.session.spawn(make.sdf(model), pose=pose)
    return world


def spherical(latitude, longitude, elevation=0.0, heading=0.0):
    values = {
        "latitude_deg": latitude,
        "longitude_deg": longitude,
        "elevation": elevation,
        "heading_deg": heading,
    }
    children = tuple(Element(tag=k, text=str(v), origin=HERE) for k, v in values.items())
    return Element(tag="spherical_coordinates", children=children, origin=HERE)


# -- geodesy


def test_poles_and_equator_lie_where_the_ellipsoid_has_them():
    assert to_earth(0, 0, 0) == pytest.approx((EQUATOR, 0, 0))
    assert to_earth(0, math.pi / 2, 100) == pytest.approx((0, EQUATOR + 100, 0), abs=1e-6)
    pole = EQUATOR * (1 - FLATTENING)
    assert to_earth(math.pi / 2, 0, 0) == pytest.approx((0, 0, pole), abs=1e-6)


@pytest.mark.parametrize("latitude", [-89.9, -60.0, -1.0, 0.0, 33.3, 52.5, 90.0])
@pytest.mark.parametrize("height", [-100.0, 0.0, 8848.0])
def test_there_and_back_is_where_it_began(latitude, height):
    place = (math.radians(latitude), math.radians(13.4), height)
    again = from_earth(*to_earth(*place))
    assert again[0] == pytest.approx(place[0], abs=1e-12)
    assert again[2] == pytest.approx(height, abs=1e-6)


def test_a_way_north_is_an_arc_of_the_meridian():
    """m(φ) = a (1 - e²) / (1 - e² sin²φ)^1.5 is the meridian's radius of curvature."""
    latitude = math.radians(50.0)
    e2 = FLATTENING * (2 - FLATTENING)
    radius = EQUATOR * (1 - e2) / (1 - e2 * math.sin(latitude) ** 2) ** 1.5
    across = EQUATOR / math.sqrt(1 - e2 * math.sin(latitude) ** 2)
    datum = Datum(latitude=latitude, longitude=0.2)
    north = datum.locate((0.0, 100.0, 0.0))
    assert north[0] - latitude == pytest.approx(100 / radius, rel=1e-5)
    east = datum.locate((100.0, 0.0, 0.0))
    assert east[1] - 0.2 == pytest.approx(100 / (across * math.cos(latitude)), rel=1e-5)
    # A plane leaves the Earth by d²/2R.
    assert north[2] == pytest.approx(100**2 / 2 / radius, rel=1e-3)
    turned = Datum(latitude=latitude, longitude=0.2, heading=math.pi / 2)
    assert turned.locate((100.0, 0.0, 0.0)) == pytest.approx(north)


# -- GPS


def test_hector_gps_tells_latitude_longitude_and_velocity(make, read):
    """Its world's x is north and y is west; a minute of arc north is a nautical mile or so."""
    tags = """<referenceLatitude>52</referenceLatitude><referenceLongitude>13</referenceLongitude>
      <referenceAltitude>30</referenceAltitude><updateRate>10</updateRate>"""
    plugin = f'<plugin name="g" filename="libhector_gazebo_ros_gps.so">{tags}</plugin>'
    world = floating(make, unit(plugin), Pose((1000, 500, 5)))
    world.session.simulation.data.joint("unit::link").qvel[:3] = [1.0, 2.0, 0.5]
    box = world.mailbox("/fix_velocity")
    fixes = read(world, "/fix", 1.0)
    assert len(fixes) == 10
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


def test_ros2_gps_sensor_tells_the_worlds_place(make, read):
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
    assert len(fixes) == 10
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


# -- pressure


@pytest.mark.parametrize(
    ("height", "tabulated"), [(0.0, 101325.0), (1000.0, 89875.0), (5000.0, 54020.0)]
)
def test_pressure_is_that_of_the_standard_atmosphere(make, read, height, tabulated):
    """The tables of ICAO's standard atmosphere have five digits."""
    sensor = f"""<sensor name="p" type="air_pressure"><update_rate>10</update_rate><topic>p</topic>
      <air_pressure><reference_altitude>{height}</reference_altitude></air_pressure></sensor>"""
    message = read(floating(make, unit(sensor=sensor)), "/p", 0.5)[0]
    assert message.fluid_pressure == pytest.approx(tabulated, rel=2e-4)
    assert message.variance == 0.0


def test_pressure_falls_by_the_weight_of_the_air(make, read):
    """dp = -ρ g dh with ρ = 1.225 kg/m³ at the sea."""
    sensor = """<sensor name="p" type="air_pressure"><update_rate>10</update_rate><topic>p</topic>
      </sensor>"""
    low = read(floating(make, unit(sensor=sensor)), "/p", 0.5)[0].fluid_pressure
    high = read(floating(make, unit(sensor=sensor), Pose((0, 0, 10))), "/p", 0.5)[0].fluid_pressure
    assert low - high == pytest.approx(1.225 * 9.80665 * 10, rel=2e-3)


# -- magnetic field


def test_hector_magnetic_is_the_field_in_the_links_axes(make, read):
    """Inclination 60°: it dips into the Earth, along the north where there is no declination."""
    tags = "<magnitude>50</magnitude><topicName>m</topicName><updateRate>20</updateRate>"
    plugin = f'<plugin name="m" filename="libhector_gazebo_ros_magnetic.so">{tags}</plugin>'
    turned = quat_from_rpy(0.2, -0.3, 1.1)
    world = floating(make, unit(plugin), Pose((0, 0, 0), turned))
    messages = read(world, "/m", 1.0)
    assert len(messages) == 20
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
    # A compass tells how far the x axis is clockwise from the field.
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


# -- a unit that drifts


def hector(tags, rate=100):
    return unit(
        f"""<plugin name="i" filename="libhector_gazebo_ros_imu.so"><topicName>imu</topicName>
        <updateRate>{rate}</updateRate>{tags}</plugin>"""
    )


def test_hector_imu_reads_truth_when_it_has_no_errors(make, read):
    world = make.world(ground=None)
    turned = quat_from_rpy(0.1, 0.2, 0.7)
    world.session.spawn(make.sdf(hector("")), pose=Pose((0, 0, 100), turned))
    world.session.simulation.data.joint("unit::link").qvel[3:] = [0.0, 0.0, 0.5]
    message = read(world, "/imu", 0.1)[0]
    assert vector(message.linear_acceleration) == pytest.approx([0, 0, 0], abs=1e-6)
    assert vector(message.angular_velocity) == pytest.approx([0, 0, 0.5], abs=1e-6)
    told = message.orientation
    assert (told.x, told.y, told.z, told.w) == pytest.approx(turned, abs=1e-9)


def test_hector_imus_noise_and_scale_are_as_stated(make, read):
    tags = """<rateGaussianNoise>0.1 0.2 0.3</rateGaussianNoise><accelOffset>1 2 3</accelOffset>
      <rateScaleError>2 2 2</rateScaleError>"""
    world = floating(make, hector(tags))
    world.session.simulation.data.joint("unit::link").qvel[5] = 0.5
    messages = read(world, "/imu", 20.0)
    rates = np.array([vector(m.angular_velocity) for m in messages])
    count = len(rates)
    assert rates.std(axis=0) == pytest.approx([0.1, 0.2, 0.3], rel=4 / math.sqrt(2 * count))
    assert rates.mean(axis=0) == pytest.approx([0, 0, 1.0], abs=4 * 0.3 / math.sqrt(count))
    accelerations = np.array([vector(m.linear_acceleration) for m in messages])
    assert accelerations == pytest.approx(np.tile([1.0, 2.0, 3.0], (count, 1)), abs=1e-6)
    assert np.diag(messages[0].angular_velocity_covariance.reshape(3, 3)) == pytest.approx(
        [0.01, 0.04, 0.09]
    )


def drift(make, read, seed, *, seconds=200.0, late=0.0, frequency=1.0):
    tags = f"""<rateDrift>0.1 0.1 0.1</rateDrift>
      <rateDriftFrequency>{frequency} {frequency} {frequency}</rateDriftFrequency>"""
    world = floating(make, hector(tags, rate=10), seed=seed)
    world.run(late)
    return np.array([vector(m.angular_velocity) for m in read(world, "/imu", seconds)])


def test_the_drift_is_a_gauss_markov_process(make, read):
    """Its standard deviation is that stated, and it forgets by e^(-f t)."""
    values = drift(make, read, 3, seconds=400.0)
    # Two time constants make about one independent sample.
    independent = 3 * 400.0 / 2
    assert values.std() == pytest.approx(0.1, rel=4 / math.sqrt(2 * independent))
    for lag in (1, 5, 10):
        correlation = np.mean(values[:-lag] * values[lag:]) / np.mean(values**2)
        assert correlation == pytest.approx(math.exp(-0.1 * lag), abs=0.15)


def test_the_drift_does_not_depend_on_who_listens_since_when(make, read):
    early = drift(make, read, 5, seconds=20.0)
    again = drift(make, read, 5, seconds=20.0)
    late = drift(make, read, 5, seconds=10.0, late=10.0)
    other = drift(make, read, 6, seconds=20.0)
    assert np.array_equal(early, again)
    assert np.array_equal(early[100:], late)
    assert not np.array_equal(early, other)


def test_calibration_takes_the_rates_drift_away_and_a_bias_can_be_set(make, read):
    tags = "<rateDrift>0.5 0.5 0.5</rateDrift><accelDrift>0.5 0.5 0.5</accelDrift>"
    world = floating(make, hector(tags))
    before = read(world, "/imu", 0.05)[-1]
    assert np.abs(vector(before.angular_velocity)).max() > 1e-3
    world.graph.service("/imu/calibrate").handler(None)
    after = read(world, "/imu", 0.05)[0]
    # It begins to wander again at once: by 0.5 √(2 dt / 3600 s) a period.
    assert np.abs(vector(after.angular_velocity)).max() < 0.01
    request = message_class("hector_gazebo_plugins/srv/SetBias_Request")
    three = message_class("geometry_msgs/msg/Vector3")
    world.graph.service("/imu/set_accel_bias").handler(request(bias=three(1.0, 2.0, 3.0)))
    biased = read(world, "/imu", 0.05)[0]
    assert vector(biased.linear_acceleration) == pytest.approx([1, 2, 3], abs=0.02)
    bias = read(world, "/imu/bias", 0.05)[0]
    assert vector(bias.linear_acceleration) == pytest.approx([1, 2, 3], abs=0.02)


def test_a_yaw_error_turns_the_orientation_about_the_vertical(make, read):
    world = floating(make, hector("<yawOffset>0.3</yawOffset>"), Pose((0, 0, 0)))
    told = read(world, "/imu", 0.05)[0].orientation
    assert (told.x, told.y, told.z, told.w) == pytest.approx(quat_from_rpy(0, 0, 0.3), abs=1e-9)


def test_an_accelerometers_offset_tilts_what_it_takes_for_up(make, read):
    """Off by b along x it takes a direction b/g off for up: the pitch is wrong by b/g."""
    world = make.world(ground=None)
    world.session.spawn(make.sdf(hector("<accelOffset>0.098 0 0</accelOffset>")))
    told = read(world, "/imu", 0.05)[0].orientation
    assert abs(2 * told.y) == pytest.approx(0.098 / G, rel=1e-3)
    assert abs(told.x) < 1e-9


# -- noise of sensors

IMU_NOISE = """<imu><angular_velocity><z><noise type="gaussian"><mean>0</mean>
  <stddev>0.05</stddev></noise></z></angular_velocity><linear_acceleration><x>
  <noise type="gaussian"><mean>0</mean><stddev>0.2</stddev><bias_mean>1.0</bias_mean>
  <bias_stddev>0.0</bias_stddev></noise></x></linear_acceleration></imu>"""


@pytest.mark.parametrize(
    ("plugin", "topic"),
    [
        ('<plugin name="p" filename="libgazebo_ros_imu_sensor.so"><ros><remapping>~/out:=data'
         "</remapping></ros></plugin>", "/data"),
        ('<plugin name="p" filename="libgazebo_ros_imu_sensor.so"><ros/></plugin>', "/p/out"),
        ("<topic>imu</topic>", "/imu"),
    ],
)  # fmt: skip
def test_an_imu_sensors_noise_is_its_own_by_axis(make, read, plugin, topic):
    sensor = f"""<sensor name="s" type="imu"><update_rate>100</update_rate>{IMU_NOISE}{plugin}
      </sensor>"""
    world = floating(make, unit(sensor=sensor))
    messages = read(world, topic, 20.0)
    count = len(messages)
    assert count == 2000
    rates = np.array([vector(m.angular_velocity) for m in messages])
    accelerations = np.array([vector(m.linear_acceleration) for m in messages])
    tolerance = 4 / math.sqrt(2 * count)
    assert rates[:, 2].std() == pytest.approx(0.05, rel=tolerance)
    assert not rates[:, :2].any()
    assert accelerations[:, 0].std() == pytest.approx(0.2, rel=tolerance)
    # A bias has either sign.
    assert abs(accelerations[:, 0].mean()) == pytest.approx(1.0, abs=4 * 0.2 / math.sqrt(count))
    assert messages[0].angular_velocity_covariance[8] == pytest.approx(0.05**2)
    assert messages[0].linear_acceleration_covariance[0] == pytest.approx(0.2**2)


@pytest.mark.parametrize(
    ("model", "parameter"),
    [
        (hector("<rateDrift>-1 0 0</rateDrift>"), "rateDrift"),
        (hector("<rateDrift>0.1</rateDrift>"), "rateDrift"),
        (unit('<plugin name="g" filename="libhector_gazebo_ros_gps.so"><drift>-1 0 0</drift>'
              "</plugin>"), "drift"),
    ],
)  # fmt: skip
def test_errors_without_sense_name_their_line(make, model, parameter):
    with pytest.raises(PluginError) as caught:
        floating(make, model)
    assert caught.value.code is devices.PLUGIN_PARAMETER_INVALID
    assert caught.value.values["parameter"] == parameter
    assert caught.value.origin is not None


def test_a_sensor_of_unknown_noise_is_left_out(make):
    model = unit(
        sensor='<sensor name="s" type="imu"><topic>t</topic><imu><angular_velocity><x>'
        '<noise type="pink"/></x></angular_velocity></imu></sensor>'
    )
    world = floating(make, model)
    (told,) = [each for each in world.diagnostics if each.severity == "error"]
    assert told.code is running.PLUGIN_LEFT_OUT
    assert told.values["plugin"] == "s"
    assert told.values["cause"] == devices.PLUGIN_PARAMETER_INVALID.number
