"""What a scanner measures, by the geometry of what stands before it."""

import dataclasses
import math

import numpy as np
import pytest
from tests.devices.rays.scanners import HEIGHT, angles, box, model, scan, scans, sensor, wall

from cartwheel.geometry import Pose, matrix_from_quat, quat_from_rpy


def test_a_wall_is_read_at_its_distance_over_the_cosine(make):
    world = make.world(wall(make, 2.0), make.sdf(model(sensor())))
    message = scan(world)
    alpha = angles(message)
    assert len(message.ranges) == 181
    assert message.angle_max == pytest.approx(alpha[-1])
    with np.errstate(divide="ignore"):
        expected = 2.0 / np.cos(alpha)
    # Beyond the maximum there is nothing to be read. The first angle is rounded to 32 bits.
    seen = (expected > 0.0) & (expected < 10.0)
    assert message.ranges[seen] == pytest.approx(expected[seen], rel=1e-5)
    assert np.all(np.isposinf(message.ranges[~seen]))
    assert 0 < seen.sum() < 181


def test_a_scan_turns_to_the_left(make):
    left = make.box("left", (1, 1, 2), static=True, pose=Pose((0, 3.5, 0)))
    world = make.world(left, make.sdf(model(sensor(samples=3))))
    assert scan(world).ranges == pytest.approx([math.inf, math.inf, 3.0])


def test_the_edges_of_a_box_are_where_they_are(make):
    """A box of 1 m whose face is 2 m away spans atan(0.25) to each side, not a ray more."""
    target = make.box("target", (1, 1, 2), static=True, pose=Pose((2.5, 0, 0)))
    world = make.world(target, make.sdf(model(sensor(samples=3601, low=-0.6, high=0.6))))
    message = scan(world)
    hit = np.isfinite(message.ranges)
    edge = math.atan2(0.5, 2.0)
    assert hit.tolist() == (np.abs(angles(message)) <= edge).tolist()


def test_a_sphere_is_read_by_the_chord(make):
    """r = d cos a - sqrt(R² - d² sin² a) for a sphere of radius R in the distance d."""
    ball = make.sdf(
        f"""<model name="ball"><static>true</static><pose>3 0 {HEIGHT} 0 0 0</pose>
        <link name="link"><collision name="c"><geometry><sphere><radius>0.7</radius></sphere>
        </geometry></collision></link></model>"""
    )
    world = make.world(ball, make.sdf(model(sensor(samples=400, low=-0.4, high=0.4))))
    message = scan(world)
    alpha = angles(message)
    root = 0.7**2 - (3.0 * np.sin(alpha)) ** 2
    hit = root > 0
    assert message.ranges[hit] == pytest.approx(
        3.0 * np.cos(alpha[hit]) - np.sqrt(root[hit]), abs=1e-5
    )
    assert np.all(np.isposinf(message.ranges[~hit]))


@pytest.mark.parametrize("roll", [0.0, 0.3])
@pytest.mark.parametrize("pitch", [0.2, 0.5])
def test_a_tilted_mount_reads_the_ground(make, roll, pitch):
    """A ray with the direction d in the world meets the ground after height / -d_z."""
    text = sensor(pose=f"0.3 0 0.2 {roll} {pitch} 0", most=20.0)
    message = scan(make.world(make.sdf(model(text))))
    alpha = angles(message)
    rays = np.stack([np.cos(alpha), np.sin(alpha), np.zeros_like(alpha)])
    down = -(matrix_from_quat(quat_from_rpy(roll, pitch, 0)) @ rays)[2]
    with np.errstate(divide="ignore"):
        expected = np.where(down > 1e-9, (HEIGHT + 0.2) / down, np.inf)
    expected[expected >= 20.0] = np.inf
    assert np.isfinite(expected).any()
    assert message.ranges == pytest.approx(expected, rel=1e-5)


def test_the_mount_turns_with_its_model(make):
    world = make.world(
        wall(make, 2.0), make.sdf(model(sensor(samples=3), pose=f"0.5 0 {HEIGHT} 0 0 1.5707963"))
    )
    # Turned to the left by a right angle, the wall ahead is on its right.
    assert scan(world).ranges == pytest.approx([1.5, math.inf, math.inf], rel=1e-5)


def test_what_is_too_near_or_too_far_reads_infinite(make):
    """REP 117: -inf says that something is nearer than can be measured."""
    front = make.box("front", (1, 0.1, 2), static=True, pose=Pose((0.8, 0, 0)))
    side = make.box("side", (0.1, 1, 2), static=True, pose=Pose((0, 5.5, 0)))
    world = make.world(
        front, side, make.sdf(model(sensor(samples=2, low=0, high=math.pi / 2, least=0.5, most=4)))
    )
    assert scan(world).ranges.tolist() == [-math.inf, math.inf]


def test_a_sensor_looks_out_of_its_housing(make):
    """The housing is larger than the minimum; still nothing but the wall is seen."""
    housing = box("housing", "0.6 0.6 0.6") + box("lens", "0.1 0.1 0.1")
    world = make.world(wall(make, 2.0), make.sdf(model(sensor(samples=1), bodies=housing)))
    assert scan(world).ranges == pytest.approx([2.0])


def test_a_sensor_sees_its_own_robot_beyond_the_minimum_alone(make):
    """A post 0.3 m ahead is seen with a minimum of 0.1 m, and looked past with one of 0.4 m."""
    post = box("post", "0.02 0.02 1", "0.31 0 0 0 0 0")
    for least, expected in ((0.1, 0.3), (0.4, 2.0)):
        text = sensor(samples=1, least=least)
        world = make.world(wall(make, 2.0), make.sdf(model(text, bodies=post)))
        assert scan(world).ranges == pytest.approx([expected])


def test_own_shapes_one_behind_the_other_are_all_looked_past(make):
    posts = "".join(box(f"post_{i}", "0.01 0.2 1", f"{0.1 * i} 0 0 0 0 0") for i in (1, 2, 3))
    text = sensor(samples=1, least=0.5)
    world = make.world(wall(make, 2.0), make.sdf(model(text, bodies=posts)))
    assert scan(world).ranges == pytest.approx([2.0])
    # What it looked past is there for others as ever.
    assert set(world.session.simulation.model.geom_group.tolist()) == {4}


def test_intensities_are_the_laser_retro_of_what_is_hit(make):
    left = f"""<model name="bright"><static>true</static><link name="link">
      {box("solid", "1 1 4", "0 3.5 0 0 0 0", retro=120)}</link></model>"""
    world = make.world(wall(make, 2.0), make.sdf(left), make.sdf(model(sensor(samples=3))))
    message = scan(world)
    assert message.ranges == pytest.approx([math.inf, 2.0, 3.0])
    assert message.intensities.tolist() == [0.0, 0.0, 120.0]


def test_who_listens_changes_nothing_of_what_happens(make):
    def end(listens):
        ball = """<model name="ball"><pose>1 0.2 2 0 0 0</pose><link name="link">
          <inertial><mass>1</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia>
          </inertial><collision name="c"><geometry><box><size>0.3 0.2 0.1</size></box></geometry>
          </collision></link></model>"""
        world = make.world(make.sdf(ball), make.sdf(model(sensor(rate=37))))
        inbox = world.mailbox("/scan") if listens else None
        world.run(3.0)
        assert inbox is None or len(inbox.drain()) == 112
        return world.session.simulation.data.qpos.tolist()

    assert end(listens=True) == end(listens=False)


def test_a_wall_that_was_put_there_later_is_seen(make):
    world = make.world(make.sdf(model(sensor(samples=1))))
    inbox = world.mailbox("/scan", size=1)
    world.run(0.2)
    assert inbox.drain()[-1].ranges.tolist() == [math.inf]
    world.session.spawn(wall(make, 3.0))
    world.run(0.2)
    assert inbox.drain()[-1].ranges == pytest.approx([3.0])


def test_scans_come_at_the_rate_with_stamps_of_simulation_time(make):
    world = make.world(make.sdf(model(sensor(samples=2, rate=8))))
    stamps = [
        m.header.stamp.sec * 10**9 + m.header.stamp.nanosec for m in scans(world, seconds=2.0)
    ]
    assert stamps == [125_000_000 * k for k in range(17)]


def test_nobody_listens_and_nothing_is_measured(make, monkeypatch):
    from cartwheel.simulation.sensing.rays import RayHandle

    casts = []
    measure = RayHandle.cast
    monkeypatch.setattr(RayHandle, "cast", lambda self: casts.append(1) or measure(self))
    world = make.world(make.sdf(model(sensor(rate=100))))
    world.run(0.5)
    assert casts == []
    assert len(scans(world, 0.1)) == len(casts) == 10


def test_many_rays_at_once_read_what_one_alone_reads(make):
    """Against single rays, in a world of all kinds of shapes in which the bundle is culled."""
    import mujoco

    random = np.random.default_rng(3)
    things = []
    for index in range(40):
        shape = (
            "<box><size>0.6 0.3 0.9</size></box>",
            "<sphere><radius>0.4</radius></sphere>",
            "<cylinder><radius>0.2</radius><length>1</length></cylinder>",
            "<capsule><radius>0.2</radius><length>0.5</length></capsule>",
        )[index % 4]
        x, y = random.uniform(-5, 5, 2)
        z, roll, pitch, yaw = random.uniform(-1, 1.5, 4)
        if math.hypot(x, y) > 1.2:
            things.append(
                f"""<model name="thing_{index}"><static>true</static>
                <pose>{x} {y} {z} {roll} {pitch} {yaw}</pose><link name="link"><collision name="c">
                <geometry>{shape}</geometry></collision></link></model>"""
            )
    vertical = (
        "<vertical><samples>9</samples><min_angle>-0.4</min_angle><max_angle>0.4</max_angle>"
        "</vertical>"
    )
    text = sensor(samples=360, low=0, high=2 * math.pi, most=6.0, vertical=vertical)
    world = make.world(*(make.sdf(thing) for thing in things), make.sdf(model(text)))
    message = scan(world)
    simulation = world.session.simulation
    collisions = np.zeros(6, dtype=np.uint8)
    collisions[4] = 1
    expected = []
    for angle in angles(message):
        ray = np.array([math.cos(angle), math.sin(angle), 0.0])
        found = mujoco.mj_ray(
            simulation.model, simulation.data, [0, 0, HEIGHT], ray, collisions, True, -1, None
        )
        expected.append(found if 0 <= found < 6.0 else math.inf)
    assert 50 < np.isfinite(expected).sum() < 350
    assert message.ranges == pytest.approx(expected, rel=1e-5)


def test_a_scan_is_of_its_stamp(make):
    """Falling, it reads its height at the step of the stamp: h0 - g dt² n (n + 1) / 2."""
    step, height = 0.001, 40.0
    body = """<inertial><mass>1</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia>
      </inertial>"""
    down = sensor(samples=1, most=100, rate=50, pose=f"0 0 0 0 {math.pi / 2} 0")
    falling = model(down, bodies=body, pose=f"0 0 {height} 0 0 0").replace(
        "<static>true</static>", ""
    )
    world = make.world(make.sdf(falling), step=step)
    reported = scans(world, 1.0)
    assert len(reported) == 51
    for message in reported:
        count = round((message.header.stamp.sec + message.header.stamp.nanosec * 1e-9) / step)
        assert message.ranges[0] == pytest.approx(
            height - 9.8 * step**2 * count * (count + 1) / 2, rel=1e-6
        )


def test_what_sleeps_is_seen(make):
    """A box that came to rest long ago is read where it lies."""
    box_ahead = make.box("box", (0.5, 2.0, 1.0), pose=Pose((1.75, 0, 0.5)))
    world = make.world(box_ahead, make.sdf(model(sensor(samples=1))))
    world.run(10.0)
    assert scan(world).ranges == pytest.approx([1.5], abs=1e-4)
    world.model("box").pose = Pose((2.75, 0, 0.5))
    assert scan(world).ranges == pytest.approx([2.5], abs=1e-3)


def test_a_moving_robot_with_a_scanner_stays_awake(make, rosbots):
    """It rests for long, is commanded to drive, and its scans show that."""
    text = make.sdf(model(sensor(samples=1, pose="0 0 0.4 0 0 0")))
    scanner = dataclasses.replace(text.links[0].sensors[0], link="base_link")
    cart = dataclasses.replace(
        rosbots,
        links=tuple(
            dataclasses.replace(link, sensors=(scanner,)) if link.name == "base_link" else link
            for link in rosbots.links
        ),
    )
    world = make.world(wall(make, 5.0))
    world.session.spawn(cart, pose=Pose((0, 0, 0.05)))
    world.run(20.0)
    before = scan(world).ranges[0]
    world.publish("/part2_cmr/cmd_vel", linear_x=0.5)
    world.run(2.0)
    driven = world.model("rosbots").pose.x
    assert driven > 0.5
    world.publish("/part2_cmr/cmd_vel", linear_x=0.0)
    world.run(1.0)
    there = world.model("rosbots").pose.x
    assert before - scan(world).ranges[0] == pytest.approx(there, abs=5e-3)


def test_a_ray_passes_through_the_gap_of_a_mesh(make, tmp_path):
    """Two blocks in one mesh: their hull would close the gap between them."""
    corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (-2, 2)]
    faces = [
        (0, 1, 3, 2),
        (4, 6, 7, 5),
        (0, 4, 5, 1),
        (2, 3, 7, 6),
        (0, 2, 6, 4),
        (1, 5, 7, 3),
    ]
    lines = []
    for shift in (0.5, -1.5):
        lines += [f"v {x} {y + shift} {z}" for x, y, z in corners]
    for start in (1, 9):
        lines += ["f " + " ".join(str(start + i) for i in face) for face in faces]
    (tmp_path / "gate.obj").write_text("\n".join(lines))
    gate = make.sdf(
        f"""<model name="gate"><static>true</static><pose>2 0 0 0 0 0</pose><link name="link">
        <collision name="c"><geometry><mesh><uri>file://{tmp_path}/gate.obj</uri></mesh></geometry>
        </collision></link></model>"""
    )
    aside = math.atan2(1.0, 2.0)
    text = sensor(samples=3, low=-aside, high=aside)
    message = scan(make.world(wall(make, 5.0), gate, make.sdf(model(text))))
    assert message.ranges == pytest.approx(
        [math.hypot(2.0, 1.0), 5.0, math.hypot(2.0, 1.0)], rel=1e-5
    )
