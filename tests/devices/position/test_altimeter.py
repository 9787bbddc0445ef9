"""Altimeters of gz-sim, and sensors that only Gazebo Classic has."""

import math

import numpy as np
import pytest

from cartwheel.codes import devices
from cartwheel.geometry import Pose

G = 9.8

INERTIA = """<inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia>
  </inertial>"""


def altimeter(tags="<topic>height</topic>", inside=""):
    return f"""<model name="unit"><link name="link"><pose>0 0 0.5 0 0 0</pose>{INERTIA}
      <sensor name="alt" type="altimeter"><pose>0.3 0 0.2 0 0 0</pose>
      <update_rate>50</update_rate>{tags}<altimeter>{inside}</altimeter></sensor></link></model>"""


def test_an_altimeter_publishes_how_far_it_fell_since_its_spawn(make, read):
    world = make.world(ground=None)
    world.session.spawn(make.sdf(altimeter()), pose=Pose((0, 0, 100)))
    messages = read(world, "/height", 1.0)
    assert len(messages) == 51
    for message in (messages[0], messages[-1]):
        seconds = message.header.stamp.sec + message.header.stamp.nanosec * 1e-9
        assert message.vertical_reference == pytest.approx(100.7)
        assert message.vertical_velocity == pytest.approx(-G * seconds, abs=1e-9)
        # The engine's steps of 5 ms fall a little further than a parabola.
        fallen = G * seconds * (seconds + 0.005) / 2
        assert message.vertical_position == pytest.approx(-fallen, abs=1e-6)
    assert messages[0].header.frame_id == "link"


def test_an_altimeter_rises_where_it_is_mounted(make, read):
    """In a turn about y what lies ahead goes down, by the rate times the arm."""
    world = make.world(ground=None, gravity=0.0)
    world.session.spawn(make.sdf(altimeter("<topic>height</topic><gz_frame_id>f</gz_frame_id>")))
    world.session.simulation.data.joint("unit::link").qvel[4] = 0.5
    message = read(world, "/height", 0.01)[0]
    assert message.vertical_velocity == pytest.approx(-0.5 * 0.3, rel=1e-2)
    assert message.header.frame_id == "f"


def test_an_altimeters_noise_has_its_spread(make, read):
    inside = "".join(
        f"<{what}><noise type='gaussian'><stddev>{spread}</stddev></noise></{what}>"
        for what, spread in (("vertical_position", 0.2), ("vertical_velocity", 0.05))
    )
    world = make.world(ground=None, gravity=0.0)
    world.session.spawn(make.sdf(altimeter(inside=inside)))
    messages = read(world, "/height", 20.0)
    tolerance = 4 / math.sqrt(2 * len(messages))
    heights = np.array([message.vertical_position for message in messages])
    speeds = np.array([message.vertical_velocity for message in messages])
    assert heights.std() == pytest.approx(0.2, rel=tolerance)
    assert speeds.std() == pytest.approx(0.05, rel=tolerance)
    assert not world.diagnostics


def test_what_classic_alone_has_is_reported(make):
    model = """<model name="m"><static>1</static><link name="l"><sensor name="a" type="{}"/>
      </link></model>"""
    for kind in ("altimeter", "logical_camera", "sonar", "wireless_receiver"):
        (reported,) = make.world(make.sdf(model.format(kind))).diagnostics
        assert reported.code is devices.SENSOR_WITHOUT_PLUGIN
        assert reported.origin is not None
