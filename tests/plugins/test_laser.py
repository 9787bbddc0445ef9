"""What a laser scanner reads, by the geometry of what stands before it."""

import dataclasses
import math

import numpy as np
import pytest
from tests.coded import coded

from cartwheel.codes import devices
from cartwheel.errors import CartwheelError
from cartwheel.geometry import Pose, matrix_from_quat, quat_from_rpy

HEIGHT = 0.5
"""m, of the sensor above the ground."""


def sensor(
    *,
    samples=181,
    low=-math.pi / 2,
    high=math.pi / 2,
    least=0.1,
    most=10.0,
    rate=10,
    resolution=1,
    vertical="",
    noise="",
    pose="0 0 0 0 0 0",
    kind="ray",
    plugin="libgazebo_ros_laser.so",
    tags="<topicName>scan</topicName><frameName>laser</frameName>",
):
    return f"""
    <sensor name="lidar" type="{kind}"><pose>{pose}</pose><update_rate>{rate}</update_rate>
      <ray><scan><horizontal><samples>{samples}</samples><resolution>{resolution}</resolution>
        <min_angle>{low}</min_angle><max_angle>{high}</max_angle></horizontal>{vertical}</scan>
        <range><min>{least}</min><max>{most}</max></range>{noise}</ray>
      <plugin name="laser" filename="{plugin}">{tags}</plugin>
    </sensor>"""


def model(sensor_text, *, bodies="", pose=f"0 0 {HEIGHT} 0 0 0"):
    """A post that stands still with a scanner at its frame."""
    return f"""
    <model name="post"><static>true</static><pose>{pose}</pose>
      <link name="laser">{bodies}{sensor_text}</link></model>"""


def box(name, size, pose="0 0 0 0 0 0", *, visual=False, retro=None):
    kind = "visual" if visual else "collision"
    told = f"<laser_retro>{retro}</laser_retro>" if retro is not None else ""
    return f"""<{kind} name="{name}"><pose>{pose}</pose>{told}
      <geometry><box><size>{size}</size></box></geometry></{kind}>"""


def scans(world, seconds=0.05, topic="/scan"):
    inbox = world.mailbox(topic, size=10_000)
    world.run(seconds)
    inbox.close()
    return inbox.drain()


def scan(world, topic="/scan"):
    return scans(world, 0.2, topic)[0]


def angles(message):
    return message.angle_min + np.arange(len(message.ranges)) * message.angle_increment


def wall(make, distance, *, width=50.0, name="wall"):
    """Across the x axis; its near face at `distance`."""
    return make.box(name, (1.0, width, 4.0), static=True, pose=Pose((distance + 0.5, 0, 0)))


def test_a_wall_is_read_at_its_distance_over_the_cosine(make):
    world = make.world(wall(make, 2.0), make.sdf(model(sensor())))
    message = scan(world)
    alpha = angles(message)
    assert len(message.ranges) == 181
    assert message.angle_max == pytest.approx(alpha[-1])
    with np.errstate(divide="ignore"):
        expected = 2.0 / np.cos(alpha)
    # Beyond the maximum there is nothing to be read.
    seen = expected < 10.0
    assert message.ranges[seen] == pytest.approx(expected[seen], rel=1e-5)
    assert np.all(np.isposinf(message.ranges[~seen]))
    assert 0 < seen.sum() < 181


def test_the_message_says_what_the_sensor_is(make):
    world = make.world(wall(make, 2.0), make.sdf(model(sensor(low=-1.0, high=1.5, samples=11))))
    message = scan(world)
    assert message.header.frame_id == "laser"
    assert (message.range_min, message.range_max) == (0.1, 10.0)
    assert (message.angle_min, message.angle_max) == (-1.0, 1.5)
    assert message.angle_increment == pytest.approx(0.25)
    # All rays are measured in one moment, as in Gazebo.
    assert (message.time_increment, message.scan_time) == (0.0, 0.0)
    assert message.ranges.dtype == message.intensities.dtype == np.float32


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
    assert set(world.session.simulation.model.geom_group.tolist()) == {1, 4}


def test_a_gpu_sensor_sees_visuals_and_a_cpu_sensor_collisions(make):
    ahead = f"""<model name="ahead"><static>true</static><link name="link">
      {box("solid", "1 1 4", "3.5 0 0 0 0 0")}
      {box("picture", "1 1 4", "2.5 0 0 0 0 0", visual=True)}</link></model>"""
    for kind, plugin, expected in (
        ("ray", "libgazebo_ros_laser.so", 3.0),
        ("gpu_ray", "libgazebo_ros_gpu_laser.so", 2.0),
    ):
        text = sensor(samples=1, kind=kind, plugin=plugin)
        world = make.world(make.sdf(ahead), make.sdf(model(text)))
        assert scan(world).ranges == pytest.approx([expected])


def test_intensities_are_the_laser_retro_of_what_is_hit(make):
    left = f"""<model name="bright"><static>true</static><link name="link">
      {box("solid", "1 1 4", "0 3.5 0 0 0 0", retro=120)}</link></model>"""
    world = make.world(wall(make, 2.0), make.sdf(left), make.sdf(model(sensor(samples=3))))
    message = scan(world)
    assert message.ranges == pytest.approx([math.inf, 2.0, 3.0])
    assert message.intensities.tolist() == [0.0, 0.0, 120.0]


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


def test_two_robots_have_their_own_topics_and_frames(make):
    world = make.world(wall(make, 2.0))
    described = make.sdf(model(sensor(samples=1)))
    for index in (1, 2):
        world.session.spawn(
            described,
            name=f"post_{index}",
            pose=Pose((-index, 0, HEIGHT)),
            namespace=f"robot_{index}",
            frame_prefix=f"robot_{index}",
        )
    for index in (1, 2):
        message = scan(world, f"/robot_{index}/scan")
        assert message.header.frame_id == f"robot_{index}/laser"
        # The second stands behind the first, of which a scanner alone is nothing to be seen.
        assert message.ranges == pytest.approx([2.0 + index])


@pytest.mark.parametrize(
    ("named", "frame"), [("laser", "robot_1/laser"), ("/laser", "laser"), ("", "robot_1/laser")]
)
def test_a_namespace_goes_before_the_frame_where_there_is_no_prefix(make, named, frame):
    tags = f"<topicName>scan</topicName><frameName>{named}</frameName>"
    tags += "<robotNamespace>/robot_1</robotNamespace>"
    world = make.world(make.sdf(model(sensor(samples=1, tags=tags))))
    assert scan(world, "/robot_1/scan").header.frame_id == frame


def test_who_listens_changes_nothing_of_what_happens(make):
    def end(listens):
        ball = """<model name="ball"><pose>1 0.2 2 0 0 0</pose><link name="link">
          <inertial><mass>1</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia>
          </inertial><collision name="c"><geometry><box><size>0.3 0.2 0.1</size></box></geometry>
          </collision></link></model>"""
        world = make.world(make.sdf(ball), make.sdf(model(sensor(rate=37))))
        inbox = world.mailbox("/scan") if listens else None
        world.run(3.0)
        assert inbox is None or len(inbox.drain()) == 111
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
    assert stamps == [125_000_000 * k for k in range(16)]


def test_nobody_listens_and_nothing_is_measured(make, monkeypatch):
    from cartwheel.simulation.rays import RayHandle

    casts = []
    measure = RayHandle.cast
    monkeypatch.setattr(RayHandle, "cast", lambda self: casts.append(1) or measure(self))
    world = make.world(make.sdf(model(sensor(rate=100))))
    world.run(0.5)
    assert casts == []
    assert len(scans(world, 0.1)) == len(casts) == 10


NOISE = "<noise><type>gaussian</type><mean>{mean}</mean><stddev>{stddev}</stddev></noise>"


def noisy(make, *, seed=0, mean=0.0, stddev=0.02, most=10.0, seconds=2.0):
    text = sensor(
        samples=1000,
        low=-0.001,
        high=0.001,
        most=most,
        noise=NOISE.format(mean=mean, stddev=stddev),
    )
    world = make.world(wall(make, 2.0), make.sdf(model(text)), seed=seed)
    return np.array([m.ranges for m in scans(world, seconds)])


def test_noise_has_the_mean_and_the_spread_that_are_asked_for(make):
    readings = noisy(make, mean=0.05, stddev=0.02)
    count = readings.size
    assert count == 20_000
    # Five standard errors of the mean and of the standard deviation.
    assert readings.mean() == pytest.approx(2.05, abs=5 * 0.02 / math.sqrt(count))
    assert readings.std() == pytest.approx(0.02, abs=5 * 0.02 / math.sqrt(2 * count))
    # No ray and no moment repeats another's.
    assert len(np.unique(readings)) > 0.9 * count


def test_noise_stays_within_what_can_be_measured(make):
    readings = noisy(make, stddev=0.5, most=2.2)
    assert readings.max() == np.float32(2.2)
    assert readings.min() >= 0.1


def test_quantised_ranges_are_multiples_of_the_precision(make):
    noise = "<noise><type>gaussian_quantized</type><mean>0</mean><stddev>0.1</stddev>"
    noise += "<precision>0.25</precision></noise>"
    text = sensor(samples=500, low=-0.001, high=0.001, noise=noise)
    ranges = scan(make.world(wall(make, 2.0), make.sdf(model(text)))).ranges
    assert set(ranges.tolist()) == {1.75, 2.0, 2.25}


def test_a_bias_is_drawn_once(make):
    noise = "<noise><type>gaussian</type><mean>0</mean><stddev>0</stddev>"
    noise += "<bias_mean>0.1</bias_mean><bias_stddev>0</bias_stddev></noise>"
    signs = set()
    for seed in range(8):
        text = sensor(samples=1, noise=noise)
        told = scans(make.world(wall(make, 2.0), make.sdf(model(text)), seed=seed), 1.0)
        (value,) = {float(message.ranges[0]) for message in told}
        assert abs(value - 2.0) == pytest.approx(0.1, abs=1e-6)
        signs.add(value > 2.0)
    # As in Gazebo it may have either sign.
    assert signs == {True, False}


def test_what_is_not_there_has_no_noise(make):
    assert np.all(np.isposinf(noisy(make, most=1.5)))


def test_the_seed_decides_the_noise(make):
    first, again, other = noisy(make, seed=1), noisy(make, seed=1), noisy(make, seed=2)
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)


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
        ({"noise": "<noise><type>pink</type></noise>"}, devices.PLUGIN_PARAMETER_INVALID),
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
    told = scans(world, 1.0)
    assert len(told) == 50
    for message in told:
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
    """It rests for long, is told to drive, and its scans tell of it."""
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


def test_angles_the_wrong_way_round_are_swept_clockwise_and_told(make):
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
    (told,) = coded(world, devices.SCAN_REVERSED)
    assert told.severity == "info"
    assert told.values == {"first": 0.7, "last": -0.3}
