"""SDF's <ray> element: samples, angles, limits, and the errors in them."""

import math

import numpy as np
import pytest
from tests.coded import coded
from tests.devices.rays.scanners import NOISE, angles, model, scan, sensor, wall

from cartwheel.codes import devices
from cartwheel.errors import CartwheelError
from cartwheel.geometry import Pose


@pytest.mark.parametrize(
    ("samples", "resolution", "count"),
    [(100, 2, 200), (100, 0.5, 50), (3, 1.5, 4), (66.7, 1, 66)],
)
def test_the_resolution_multiplies_the_samples(make, samples, resolution, count):
    text = sensor(samples=samples, resolution=resolution, low=-1.0, high=1.0)
    message = scan(make.world(wall(make, 2.0), make.sdf(model(text))))
    assert len(message.ranges) == count
    assert message.angle_increment == pytest.approx(2.0 / (count - 1))
    assert message.ranges == pytest.approx(2.0 / np.cos(angles(message)), rel=1e-5)


def test_a_single_ray_looks_to_the_middle(make):
    """As it stands in worlds that others wrote: one sample at half the resolution."""
    text = sensor(samples=1, resolution=0.5, low=-0.2, high=0.6)
    message = scan(make.world(wall(make, 2.0), make.sdf(model(text))))
    assert message.ranges == pytest.approx([2.0 / math.cos(0.2)])
    assert message.angle_min == message.angle_max == pytest.approx(0.2)
    assert message.angle_increment == 0.0


@pytest.mark.parametrize(
    ("wrong", "code"),
    [
        ({"samples": 0}, devices.SCAN_SAMPLES_INVALID),
        ({"samples": "many"}, devices.PLUGIN_PARAMETER_INVALID),
        ({"resolution": 0}, devices.SCAN_SAMPLES_INVALID),
        ({"resolution": -1}, devices.SCAN_SAMPLES_INVALID),
        ({"least": 2.0, "most": 1.0}, devices.SENSOR_RANGE_INVALID),
        ({"least": -1.0}, devices.SENSOR_RANGE_INVALID),
        ({"most": "nan"}, devices.PLUGIN_PARAMETER_INVALID),
        ({"noise": NOISE.format(mean=0, stddev=-1)}, devices.PLUGIN_PARAMETER_INVALID),
        ({"samples": 100_000_000}, devices.SCAN_SAMPLES_INVALID),
    ],
)
def test_a_sensor_that_cannot_be_is_refused_with_its_place(make, wrong, code):
    described = make.sdf(model(sensor(**wrong)))
    world = make.world()
    with pytest.raises(CartwheelError) as error:
        world.session.spawn(described)
    assert error.value.code is code
    assert error.value.origin is not None
    assert error.value.origin.line > 0
    # Nothing is left of it.
    assert world.session.simulation.models == ("ground_plane",)
    assert "/scan" not in {topic.name for topic in world.session.graph.topics()}


def test_a_sensor_without_rays_is_refused(make):
    text = """<sensor name="lidar" type="ray"><plugin name="p" filename="libgazebo_ros_laser.so"/>
    </sensor>"""
    with pytest.raises(CartwheelError) as caught:
        make.world(make.sdf(model(text)))
    assert caught.value.code is devices.SENSOR_INCOMPLETE


def test_a_range_without_end_is_measured(make):
    text = sensor(samples=2, low=0, high=math.pi / 2, most="inf")
    message = scan(make.world(wall(make, 150.0), make.sdf(model(text))))
    assert message.ranges == pytest.approx([150.0, math.inf])


def test_angles_the_wrong_way_round_are_swept_clockwise_and_reported(make):
    """As Gazebo casts them; a reader that adds up the steps sees everything where it is."""
    pillar = make.box("pillar", (0.2, 0.2, 4), static=True, pose=Pose((1.5, 0.8, 0)))
    world = make.world(pillar, make.sdf(model(sensor(samples=101, low=0.7, high=-0.3))))
    message = scan(world)
    assert (message.angle_min, message.angle_max) == pytest.approx((0.7, -0.3))
    assert message.angle_increment == pytest.approx(-0.01)
    hits = np.flatnonzero(np.isfinite(message.ranges))
    angles = message.angle_min + hits * message.angle_increment
    # From its corner behind on the left to its corner ahead on the right.
    assert angles.max() == pytest.approx(math.atan2(0.9, 1.4), abs=0.0101)
    assert angles.min() == pytest.approx(math.atan2(0.7, 1.6), abs=0.0101)
    (reported,) = coded(world, devices.SCAN_REVERSED)
    assert reported.severity == "info"
    assert reported.values == {"first": 0.7, "last": -0.3}
