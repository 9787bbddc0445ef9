"""Rays, distances between surfaces and the height of the ground, against closed forms."""

import math

import numpy as np
import pytest
from tests.coded import raises

import cartwheel as cw
from cartwheel.codes.running import UNKNOWN_LINK
from cartwheel.codes.world import (
    NUMBER_OUT_OF_RANGE,
    PROPERTY_ABSENT,
    UNKNOWN_MODEL,
    VALUE_INVALID,
)
from cartwheel.errors import UnknownNameError

LINK = """<link name="{}"><pose>{}</pose><inertial><mass>1</mass><inertia><ixx>0.1</ixx>
  <iyy>0.1</iyy><izz>0.1</izz></inertia></inertial><collision name="c"><geometry>{}</geometry>
  </collision></link>"""
SPHERE = "<sphere><radius>{}</radius></sphere>"


@pytest.fixture
def hall(make):
    """Two boxes of 1 m on the ground, with centres at x = 2 and x = 5."""
    return make.world(
        make.box("near", (1, 1, 1), static=True, pose=cw.Pose((2, 0, 0.5))),
        make.box("far", (1, 1, 1), static=True, pose=cw.Pose((5, 0, 0.5))),
    )


def test_a_ray_hits_the_nearest_surface(hall):
    hit = hall.ray((0, 0.1, 0.4), (3, 0, 0))
    assert (hit.model, hit.link) == ("near", "link")
    assert hit.distance == pytest.approx(1.5)
    assert hit.point == pytest.approx((1.5, 0.1, 0.4))
    assert hit.normal == pytest.approx((-1, 0, 0))
    assert hall.ray((0, 0.1, 0.4), (1, 0, 0), ignore="near").distance == pytest.approx(4.5)
    assert hall.ray((0, 0.1, 0.4), (1, 0, 0), ignore=["near", "far::link"]) is None
    assert hall.ray((0, 0.1, 0.4), (1e-300, 0, 0)).distance == pytest.approx(1.5)


def test_a_ray_has_a_range(hall):
    assert hall.ray((0, 0, 0.4), (1, 0, 0), 1.49) is None
    assert hall.ray((0, 0, 0.4), (1, 0, 0), max_range=1.51).model == "near"


def test_a_slanted_ray_hits_the_ground(hall):
    hit = hall.ray((-1, 0, 1), (-1, 0, -1))
    assert hit.model == "ground_plane"
    assert hit.distance == pytest.approx(math.sqrt(2))
    assert hit.normal == pytest.approx((0, 0, 1))


def test_a_ray_from_within_hits_the_far_side(hall):
    hit = hall.ray((2, 0, 0.5), (1, 0, 0))
    assert (hit.model, hit.distance) == ("near", pytest.approx(0.5))


def test_rays_see_the_current_state(hall):
    hall.model("near").pose = cw.Pose((3, 0, 0.5))
    assert hall.ray((0, 0, 0.4), (1, 0, 0)).distance == pytest.approx(2.5)
    hall.model("near").delete()
    assert hall.ray((0, 0, 0.4), (1, 0, 0)).distance == pytest.approx(4.5)


def test_the_clearance_of_boxes_and_spheres(make, hall):
    ball = hall.spawn(
        make.sdf(
            f'<model name="ball">{LINK.format("link", "0 0 0 0 0 0", SPHERE.format(0.25))}</model>'
        ),
        x=0.5,
        y=0.2,
        z=0.5,
    )
    found = hall.clearance(ball, "near")
    assert found.distance == pytest.approx(0.75)
    assert found.models == ("ball", "near") and found.links == ("link", "link")
    assert np.asarray(found.points) == pytest.approx(
        np.array([(0.75, 0.2, 0.5), (1.5, 0.2, 0.5)]), abs=1e-6
    )
    assert hall.clearance("near", ball).points == found.points[::-1]
    assert hall.clearance(ball).models == ("ball", "ground_plane")
    assert hall.clearance(ball).distance == pytest.approx(0.25)
    assert hall.clearance(ball, ignore=["ground_plane", "near"]).models == ("ball", "far")
    assert hall.clearance(ball, ["far", "near"]).models == ("ball", "near")
    ball.pose = cw.Pose((1.5, 0.0, 0.5))
    assert hall.clearance(ball, "near").distance == pytest.approx(-0.25)


def test_the_nearest_of_many_is_found_as_by_testing_all(make):
    random = np.random.default_rng(3)
    places = random.uniform(-3, 3, (40, 3))
    sizes = random.uniform(0.05, 0.4, 40)
    links = "".join(
        LINK.format(f"l{i}", f"{x} {y} {z + 10} 0 0 0", SPHERE.format(size))
        for i, ((x, y, z), size) in enumerate(zip(places, sizes, strict=True))
    )
    world = make.world()
    cloud = world.spawn(make.sdf(f'<model name="cloud">{links}</model>'))
    first = [cloud.link(f"l{i}") for i in range(20)]
    second = [cloud.link(f"l{i}") for i in range(20, 40)]
    gaps = np.linalg.norm(places[:20, None] - places[None, 20:], axis=2)
    gaps -= sizes[:20, None] + sizes[None, 20:]
    found = world.clearance(first, second)
    one, other = np.unravel_index(np.argmin(gaps), gaps.shape)
    assert found.distance == pytest.approx(gaps.min())
    assert found.links == (f"l{one}", f"l{other + 20}")


@pytest.mark.parametrize("tilt", [0.0, 0.4])
def test_the_clearance_of_an_arm_above_a_slope(make, tilt):
    """Infinite planes have no size, so the nearest of several shapes must still be found."""
    ramp = f"""<model name="ramp"><static>true</static><link name="link">
      <pose>0 0 0 0 {tilt} 0</pose><collision name="c"><geometry><plane><normal>0 0 1</normal>
      </plane></geometry></collision></link></model>"""
    arm = "".join(
        LINK.format(f"l{i}", f"{i} 0 {5 - i} 0 0 0", SPHERE.format(0.2)) for i in range(4)
    )
    world = make.world(make.sdf(ramp), make.sdf(f'<model name="arm">{arm}</model>'), ground=None)
    # The normal is (sin tilt, 0, cos tilt).
    gaps = [i * math.sin(tilt) + (5 - i) * math.cos(tilt) - 0.2 for i in range(4)]
    found = world.clearance("arm", "ramp")
    assert found.distance == pytest.approx(min(gaps))
    assert found.links == (f"l{gaps.index(min(gaps))}", "link")
    assert world.clearance("ramp", "arm").distance == found.distance


def test_the_ground_is_the_highest_fixed_surface(make, hall):
    hall.spawn(make.box("loose", (1, 1, 1)), x=8.0, z=0.5)
    roof = hall.spawn(make.box("roof", (4, 4, 0.1), static=True), x=2.0, z=2.0)
    assert hall.ground_height(8.0, 0.0) == 0.0
    assert hall.ground_height(5.0, 0.2) == pytest.approx(1.0)
    assert hall.ground_height(2.0, 0.0) == pytest.approx(2.05)
    assert hall.ground_height(2.0, 0.0, below=1.9) == pytest.approx(1.0)
    roof.delete()
    assert hall.ground_height(2.0, 0.0) == pytest.approx(1.0)


def test_without_ground_there_is_no_height(make):
    world = make.world(make.box("box", (1, 1, 1)), ground=None)
    assert math.isnan(world.ground_height(0.0, 0.0))
    assert math.isnan(world.ground_height(0.0, 0.0, below=-3.0))


def test_the_height_of_terrain():
    """In the bundled world rubble, loose stones lie on fixed ground."""
    with cw.World("rubble") as world:
        heights = [world.ground_height(x, 0.3) for x in np.linspace(-4, 4, 30)]
        above = [
            height - (50 - world.ray((x, 0.3, 50), (0, 0, -1)).distance)
            for x, height in zip(np.linspace(-4, 4, 30), heights, strict=True)
        ]
        assert np.max(above) < 1e-9
        assert np.sum(np.abs(above) < 1e-9) > 3 and np.min(above) < -0.01


def test_queries_change_nothing(make, rosbots):
    ends = []
    for asks in (False, True):
        world = make.world(make.box("box", (1, 1, 1), static=True, pose=cw.Pose((3, 0, 0.5))))
        cart = world.spawn(rosbots, z=0.05)
        scan = world.topic("/rosbots/camera1/camera_info")
        cart.publish("/part2_cmr/cmd_vel", linear_x=0.5)
        for _ in range(20):
            world.run(0.05)
            if asks:
                world.ray((0, 0, 0.4), (1, 0, 0), ignore=cart)
                world.clearance(cart)
                world.ground_height(1.0, 0.0)
        ends.append((cart.pose, cart.velocity, scan.count))
    assert ends[0] == ends[1]


def test_what_cannot_be_measured_is_refused(make, hall):
    with raises(VALUE_INVALID, name="direction"):
        hall.ray((0, 0, 0), (0, 0, 0))
    with raises(VALUE_INVALID, name="origin"):
        hall.ray((0, 0), (0, 0, 1))
    with raises(NUMBER_OUT_OF_RANGE):
        hall.ray((1e9, 0, 0), (0, 0, 1))
    for most in (0.0, -1.0, math.nan):
        with raises(VALUE_INVALID, name="max_range"):
            hall.ray((0, 0, 0), (0, 0, 1), most)
    with raises(NUMBER_OUT_OF_RANGE, name="x"):
        hall.ground_height(math.nan, 0.0)
    with raises(UNKNOWN_MODEL, UnknownNameError, name="neer"):
        hall.clearance("neer")
    with raises(UNKNOWN_LINK, UnknownNameError, name="top"):
        hall.ray((0, 0, 0), (0, 0, 1), ignore="near::top")
    with raises(PROPERTY_ABSENT):
        hall.clearance("near", "near")
    with raises(PROPERTY_ABSENT):
        hall.clearance("ground_plane", "ground_plane")


def test_why_there_is_no_distance(make, hall):
    near = hall.model("near")
    with raises(PROPERTY_ABSENT) as caught:
        hall.clearance(near, near)
    assert "the same" in str(caught.value)
    with raises(PROPERTY_ABSENT) as caught:
        hall.clearance(near, ignore=["far", "ground_plane"])
    assert "Nothing else" in str(caught.value)
    with raises(PROPERTY_ABSENT) as caught:
        hall.clearance(near, "far", ignore="near")
    assert "first" in str(caught.value)
