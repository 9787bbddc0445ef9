"""Logical cameras: the models in view, and their poses."""

import math

import pytest

from cartwheel.codes import running
from cartwheel.geometry import Pose, quat_from_rpy


def logical(view="<near>0.5</near><far>5</far><horizontal_fov>1.2</horizontal_fov>"
            "<aspect_ratio>2</aspect_ratio>", topic="<topic>seen</topic>"):  # fmt: skip
    return f"""<model name="eye"><static>1</static><pose>1 2 1 0 0 0.7</pose>
      <link name="link"><sensor name="lc" type="logical_camera"><pose>0 0 0.5 0.1 0 0</pose>
      <update_rate>10</update_rate>{topic}<logical_camera>{view}</logical_camera></sensor></link>
      </model>"""


EYE = Pose((1, 2, 1), quat_from_rpy(0, 0, 0.7)) @ Pose((0, 0, 0.5), quat_from_rpy(0.1, 0, 0))

WIDE = math.tan(0.6)


@pytest.mark.parametrize(
    ("place", "seen"),
    [
        ((2.0, 0.0, 0.0), True),
        ((0.49, 0.0, 0.0), False),
        ((0.51, 0.0, 0.0), True),
        ((4.99, 0.0, 0.0), True),
        ((5.01, 0.0, 0.0), False),
        ((2.0, 1.99 * WIDE, 0.0), True),
        ((2.0, -2.01 * WIDE, 0.0), False),
        ((2.0, 0.0, 0.99 * WIDE), True),
        ((2.0, 0.0, -1.01 * WIDE), False),
        ((-2.0, 0.0, 0.0), False),
    ],
)
def test_a_logical_camera_sees_what_lies_in_its_view(make, read, place, seen):
    turned = Pose(place, quat_from_rpy(0.3, 0.2, 0.1))
    world = make.world(make.sdf(logical()), ground=None)
    world.session.spawn(make.box("thing", (0.1, 0.1, 0.1), static=True), pose=EYE @ turned)
    message = read(world, "/seen", 0.1)[-1]
    assert [model.name for model in message.model] == (["thing"] if seen else [])
    reported = message.pose
    assert (reported.position.x, reported.position.y, reported.position.z) == pytest.approx(
        EYE.position
    )
    for model in message.model:
        at, turn = model.pose.position, model.pose.orientation
        assert (at.x, at.y, at.z) == pytest.approx(place)
        assert (turn.x, turn.y, turn.z, turn.w) == pytest.approx(turned.orientation)


def test_a_logical_camera_has_gazebos_long_name(make):
    system = '<plugin name="p" filename="gz-sim-logical-camera-system"/>'
    model = logical(topic="").replace("</model>", f"{system}</model>")
    world = make.world(make.sdf(model))
    kinds = {topic.name: topic.type for topic in world.graph.topics()}
    name = "/world/test/model/eye/link/link/sensor/lc/logical_camera"
    assert kinds[name] == "ros_gz_interfaces/msg/LogicalCameraImage"
    assert not world.diagnostics


@pytest.mark.parametrize(
    "view",
    [
        "<near>2</near><far>1</far>",
        "<horizontal_fov>4</horizontal_fov>",
        "<aspect_ratio>0</aspect_ratio>",
    ],
)
def test_a_view_that_is_none_leaves_the_sensor_out(make, view):
    (reported,) = make.world(make.sdf(logical(view))).diagnostics
    assert reported.severity == "error"
    assert reported.code is running.PLUGIN_LEFT_OUT
    assert reported.values["plugin"] == "lc"
