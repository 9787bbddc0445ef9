"""Properties that a program changes while a world runs, against closed forms."""

import math

import numpy as np
import pytest
from tests.api.scenes import LASER, PENDULUM, SERVO
from tests.coded import coded, raises
from tests.devices.cameras.sensors import pixels_of, sensor, take

import cartwheel as cw
from cartwheel.codes.files import FILE_MISSING
from cartwheel.codes.graph import ENTITY_UNKNOWN
from cartwheel.codes.world import (
    FRICTION_LIMITED,
    PROPERTY_ABSENT,
    SIMULATION_CLOSED,
    VALUE_INVALID,
)
from cartwheel.errors import UnknownNameError

G = 9.8
STEP = 0.005


@pytest.fixture
def box(make):
    """A box of 2 kg, 50 m above nothing, in a world of its own."""
    world = make.world(make.box("box", (0.2, 0.3, 0.4), pose=cw.Pose((0, 0, 50))), ground=None)
    return world, world.model("box"), world.model("box").link("link")


@pytest.fixture
def pendulum(make):
    world = make.world(make.sdf(PENDULUM), ground=None, without=["chain-drag"])
    return world, world.model("pendulum")


@pytest.fixture
def uncompiled(monkeypatch):
    """Fails if a world that was compiled before is compiled again."""

    def refuse(*_, **__):
        raise AssertionError("it was compiled")

    def begin():
        for name in ("build", "build_visuals"):
            monkeypatch.setattr(f"cartwheel.simulation.models.compilations.{name}", refuse)

    return begin


# -- inertia


def test_a_heavier_body_accelerates_less(box, uncompiled):
    """a = F / m."""
    world, model, link = box
    uncompiled()
    assert link.mass == model.mass == 2.0
    link.mass = 8.0
    assert link.mass == model.mass == 8.0
    model.push((4.0, 0, 0), seconds=1.0)
    assert link.acceleration.linear[0] == pytest.approx(0.5, rel=1e-12)
    world.run(1.0)
    assert model.velocity.linear == pytest.approx((0.5, 0, -G), rel=1e-9)


def test_a_changed_inertia(box, uncompiled):
    """ω' = T / I about each axis."""
    world, model, link = box
    uncompiled()
    expected = np.diag([2 * (0.09 + 0.16), 2 * (0.04 + 0.16), 2 * (0.04 + 0.09)]) / 12
    np.testing.assert_allclose(link.inertia, expected, rtol=1e-12)
    link.inertia = np.diag([0.1, 0.2, 0.25])
    np.testing.assert_array_equal(link.inertia, np.diag([0.1, 0.2, 0.25]))
    model.push(torque=(0.01, 0.02, 0.05), seconds=STEP)
    assert link.acceleration.angular == pytest.approx((0.1, 0.1, 0.2), rel=1e-9)
    assert world.time == 0


def test_an_inertia_with_products(box):
    """I ω' = T, after a compilation, because the principal axes are not those of the body."""
    _, model, link = box
    inertia = np.array([[0.3, 0.02, -0.01], [0.02, 0.25, 0.03], [-0.01, 0.03, 0.2]])
    link.inertia = inertia
    np.testing.assert_allclose(link.inertia, inertia, rtol=1e-12)
    model.push(torque=(0.01, 0.02, 0.05), seconds=STEP)
    expected = np.linalg.solve(inertia, [0.01, 0.02, 0.05])
    assert link.acceleration.angular == pytest.approx(expected, rel=1e-9)


def test_a_centre_of_mass_beside_the_support(make):
    """A pendulum's torque moves with its centre of mass: ω' = -m g l / (I + m l²)."""
    world = make.world(
        make.sdf("""<model name="p"><link name="rod"><inertial><mass>2</mass>
        <pose>0.5 0 0 0 0 0</pose><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia>
        </inertial></link><joint name="hinge" type="continuous"><parent>world</parent>
        <child>rod</child><axis><xyz>0 -1 0</xyz></axis></joint></model>"""),
        ground=None,
    )
    rod = world.model("p").link("rod")
    before = world.session.simulation.model
    rod.center_of_mass = (0.25, 0, 0)
    assert rod.center_of_mass == (0.25, 0, 0)
    expected = 2 * G * 0.25 / (0.1 + 2 * 0.25**2)
    assert rod.acceleration.angular == pytest.approx((0, expected, 0), rel=1e-9)
    assert world.session.simulation.model is before


def test_the_centre_of_mass_of_a_free_body(box):
    """A push at the body's origin turns it: ω' = F d / I."""
    _, model, link = box
    link.center_of_mass = (0.1, 0, 0)
    model.push((0, 1.0, 0), at=model.pose.position, seconds=STEP)
    inertia = 2 * (0.04 + 0.09) / 12
    assert link.acceleration.angular[2] == pytest.approx(-0.1 / inertia, rel=1e-9)


def test_a_rebuilt_world_keeps_changes(box, make):
    world, model, link = box
    link.mass = 8.0
    link.inertia = np.eye(3)
    link.friction = (0.3, 0.2)
    link.gravity = False
    world.gravity = (0, 0, -1.0)
    world.spawn(make.box("other", (0.1,) * 3), x=3.0)
    world.reset()
    assert (link.mass, link.friction, link.gravity) == (8.0, (0.3, 0.2), False)
    assert model.mass == 8.0
    world.run(1.0)
    assert model.velocity.linear == (0, 0, 0)
    assert world.model("other").velocity.linear[2] == pytest.approx(-1.0, abs=1e-9)
    assert world.gravity == (0, 0, -1)


# -- gravity


def test_gravity_of_the_world_and_of_a_link(box, uncompiled):
    world, model, link = box
    uncompiled()
    world.gravity = (0.0, 1.0, -2.0)
    world.run(0.5)
    assert model.velocity.linear == pytest.approx((0, 0.5, -1.0), abs=1e-12)
    assert link.gravity
    link.gravity = False
    world.run(0.5)
    assert model.velocity.linear == pytest.approx((0, 0.5, -1.0), abs=1e-12)
    link.gravity = True
    world.run(0.5)
    assert model.velocity.linear == pytest.approx((0, 1.0, -2.0), abs=1e-12)


def test_a_sleeping_body_falls_up(make, uncompiled):
    world = make.world(make.box("box", (0.2,) * 3, pose=cw.Pose((0, 0, 0.1))))
    world.run(6.0)
    assert (world.session.simulation.data.tree_asleep >= 0).any()
    uncompiled()
    world.gravity = (0, 0, 1.0)
    world.run(1.0)
    # It leaves the ground within the time constant of a contact of 0.01 s.
    assert world.model("box").velocity.linear[2] == pytest.approx(1.0, abs=0.03)


# -- restitution


@pytest.mark.parametrize("restitution", [0.5, 0.8])
def test_a_ball_bounces_with_its_new_restitution(make, restitution):
    """It rebounds to e² times its height, less or more the distance of one step."""
    ball = make.sdf(
        """<model name="ball"><pose>0 0 0.55 0 0 0</pose><link name="link"><inertial><mass>1</mass>
        <inertia><ixx>0.001</ixx><iyy>0.001</iyy><izz>0.001</izz></inertia></inertial>
        <collision name="c"><geometry><sphere><radius>0.05</radius></sphere></geometry></collision>
        </link></model>"""
    )
    world = make.world(ball, step=0.001)
    links = [world.model("ball").link("link"), world.model("ground_plane").link("link")]
    assert [link.restitution for link in links] == [0.0, 0.0]
    for link in links:
        link.restitution = restitution
    assert [link.restitution for link in links] == [restitution, restitution]
    fall = math.sqrt(2 * 0.5 / G)
    world.run(fall + restitution * fall)
    expected = 0.05 + 0.5 * restitution**2
    assert world.model("ball").pose.z == pytest.approx(expected, abs=math.sqrt(2 * G * 0.5) * 0.001)
    links[0].restitution = 0.0
    world.run(3.0)
    # One surface without restitution is enough to lie still.
    assert abs(world.model("ball").velocity.linear[2]) < 1e-3


@pytest.mark.parametrize("wrong", [-0.1, 1.1, math.nan])
def test_a_restitution_that_no_surface_has(box, wrong):
    _, _, link = box
    with raises(VALUE_INVALID):
        link.restitution = wrong
    assert link.restitution == 0.0


# -- friction


@pytest.mark.parametrize("mu", [0.1, 0.4])
def test_friction_stops_a_sliding_body(make, uncompiled, mu):
    """It stops after v² / 2 mu g."""
    world = make.world(make.box("box", (0.4, 0.4, 0.1), mu=1.0, pose=cw.Pose((0, 0, 0.05))))
    uncompiled()
    box = world.model("box")
    world.run(0.5)
    assert box.link("link").friction == (1.0, 1.0)
    box.link("link").friction = mu
    assert box.link("link").friction == (mu, mu)
    box.velocity = cw.Twist((1.0, 0, 0))
    world.run(1.0 / (mu * G) + 1.0)
    # Friction is viscous below mu g T / 2 with T = 0.03 s, which adds at most v T / 2; the step
    # adds v h.
    assert box.pose.x == pytest.approx(1 / (2 * mu * G), abs=0.03 / 2 + STEP)


def test_different_coefficients_along_and_across(make):
    """Along x, mu applies; across it, mu2."""
    distances = []
    for axis in (0, 1):
        ground = make.sdf(
            """<model name="floor"><static>1</static><link name="l"><collision name="c">
            <pose>0 0 -0.5 0 0 0</pose><geometry><box><size>20 20 1</size></box></geometry>
            </collision></link></model>"""
        )
        slider = make.sdf(
            """<model name="s"><pose>0 0 0.05 0 0 0</pose><link name="l"><inertial><mass>2</mass>
            <inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial>
            <collision name="c"><geometry><box><size>0.4 0.4 0.1</size></box></geometry><surface>
            <friction><ode><mu>1</mu><mu2>1</mu2><fdir1>1 0 0</fdir1></ode></friction></surface>
            </collision></link></model>"""
        )
        world = make.world(ground, slider, ground=None)
        model = world.model("s")
        model.link("l").friction = (0.4, 0.1)
        velocity = [0.0, 0.0, 0.0]
        velocity[axis] = 1.0
        model.velocity = cw.Twist((velocity[0], velocity[1], 0.0))
        world.run(3.0)
        distances.append(model.pose.position[axis])
    assert distances == pytest.approx([1 / (8 * G / 10), 1 / (2 * G / 10)], abs=0.03 / 2 + STEP)


def test_a_limited_coefficient_is_reported(make):
    world = make.world()
    cart = world.spawn("rosbots.xacro", z=0.05)
    assert not coded(world, FRICTION_LIMITED)
    cart.link("caster_link").friction = 100.0
    (note,) = coded(world, FRICTION_LIMITED)
    assert note.values["collisions"] == ("caster_link::caster_link_collision",)
    assert cart.link("caster_link").friction == (100.0, 100.0)


# -- joints


def test_damping_slows_a_pendulum(make, uncompiled):
    """A disc that turns freely slows down as e^(-d t / I)."""
    world = make.world(
        make.sdf("""<model name="disc"><link name="disc"><inertial><mass>2</mass><inertia>
        <ixx>0.1</ixx><iyy>0.1</iyy><izz>0.2</izz></inertia></inertial></link><joint name="axle"
        type="continuous"><parent>world</parent><child>disc</child><axis><xyz>0 0 1</xyz></axis>
        </joint></model>"""),
        ground=None,
    )
    uncompiled()
    joint = world.model("disc").joints["axle"]
    assert (joint.damping, joint.friction, joint.limits) == (0, 0, (None, None))
    joint.velocity = 3.0
    world.run(1.0)
    assert joint.velocity == pytest.approx(3.0, rel=1e-12)
    joint.damping = 0.1
    world.run(1.0)
    # The implicit integrator multiplies by 1 / (1 + d h / I) in each step.
    assert joint.velocity == pytest.approx(3.0 * (1 + 0.1 * STEP / 0.2) ** -200, rel=1e-9)
    assert joint.velocity == pytest.approx(3.0 * math.exp(-0.5), rel=2e-3)
    joint.damping = 0.0
    joint.velocity = 3.0
    joint.friction = 0.2
    assert world.model("disc").joints.friction == {"axle": 0.2}
    world.run(1.0)
    # Dry friction takes T t / I; the soft constraint of friction leaves 1e-4 of it.
    assert joint.velocity == pytest.approx(3.0 - 0.2 / 0.2 * 1.0, abs=2e-3)


def test_a_spring_holds_what_gravity_pulls(make, uncompiled):
    """x = x0 - m g / k; gravity pulls along the axis of the slider."""
    world = make.world(
        make.sdf(
            """<model name="m"><link name="load"><inertial><mass>2</mass><inertia><ixx>0.1</ixx>
            <iyy>0.1</iyy><izz>0.1</izz></inertia></inertial></link>
            <joint name="slide" type="prismatic"><parent>world</parent><child>load</child>
            <axis><xyz>0 0 1</xyz><dynamics><damping>40</damping></dynamics></axis></joint>
            </model>"""
        ),
        ground=None,
    )
    joint = world.model("m").joints["slide"]
    assert (joint.stiffness, joint.spring_reference) == (0.0, 0.0)
    uncompiled()
    joint.stiffness = 200.0
    world.run(3.0)
    assert joint.position == pytest.approx(-2 * G / 200.0, abs=1e-4)
    joint.spring_reference = 0.3
    world.run(3.0)
    assert joint.position == pytest.approx(0.3 - 2 * G / 200.0, abs=1e-4)
    assert (joint.stiffness, joint.spring_reference) == (200.0, 0.3)
    for name, value in (("stiffness", -1.0), ("spring_reference", math.inf)):
        with raises(VALUE_INVALID):
            setattr(joint, name, value)


@pytest.mark.parametrize("quantity", ["damping", "friction", "positions", "velocities"])
def test_one_number_is_assigned_to_all_joints(make, quantity):
    world = make.world()
    joints = world.spawn("rosbots.xacro", z=0.05).joints
    setattr(joints, quantity, 0.5)
    assert dict(getattr(joints, quantity)) == dict.fromkeys(joints.names, 0.5)
    for value in ([0.5], None, math.nan, "half"):
        with raises(VALUE_INVALID):
            setattr(joints, quantity, value)


def test_damping_of_all_joints(pendulum):
    _, model = pendulum
    model.joints.damping = {"slider": 2.0}
    assert model.joints.damping == {"hinge": 0.0, "slider": 2.0}
    model.joints.damping = [0.5, 1.5]
    np.testing.assert_array_equal(np.asarray(model.joints.damping), [0.5, 1.5])
    model.joints.friction["hinge"] = 0.25
    assert model.joints["hinge"].friction == 0.25


def test_limits_stop_a_joint(pendulum, uncompiled):
    world, model = pendulum
    uncompiled()
    hinge = model.joints["hinge"]
    hinge.limits = (-0.2, 0.4)
    assert hinge.limits == (-0.2, 0.4)
    hinge.effort = 40.0
    world.run(3.0)
    # The limit is as soft as a contact: it gives way by less than 0.02 rad.
    assert hinge.position == pytest.approx(0.4, abs=0.02)
    hinge.limits = (None, None)
    world.run(0.2)
    assert hinge.position > 0.5


def test_gains_of_a_controller(make, uncompiled):
    """At rest, p e = m g: half the gain doubles the error."""
    world = make.world(make.sdf(SERVO), ground=None)
    uncompiled()
    joint = world.model("lift").joints["rail"]
    assert joint.gains == cw.Gains(p=1000.0, i=0.0, d=200.0)
    world.publish("/lift/rail/cmd_pos", data=0.0)
    world.run(3.0)
    assert joint.position == pytest.approx(-3 * G / 1000, rel=1e-3)
    joint.gains = cw.Gains(p=500.0, d=200.0)
    assert joint.gains == cw.Gains(p=500.0, d=200.0)
    world.run(3.0)
    assert joint.position == pytest.approx(-3 * G / 500, rel=1e-3)
    world.reset()
    assert joint.gains == cw.Gains(p=500.0, d=200.0)
    world.publish("/lift/rail/cmd_pos", data=0.0)
    world.run(3.0)
    assert joint.position == pytest.approx(-3 * G / 500, rel=1e-3)


def test_a_joint_without_gains(pendulum):
    _, model = pendulum
    assert model.joints["hinge"].gains is None
    with raises(PROPERTY_ABSENT, name="hinge", property="PID controller"):
        model.joints["hinge"].gains = cw.Gains(1.0)


# -- places of fixed models


def test_a_wall_that_moves_is_measured_and_hit(make, uncompiled):
    world = make.world(
        make.box("wall", (0.2, 4, 2), static=True, pose=cw.Pose((5, 0, 1))), make.sdf(LASER)
    )
    box = world.spawn(make.box("box", (0.2,) * 3), x=2.0, z=0.1)
    scans = world.mailbox("/scan", size=1)
    world.run(1.0)
    assert scans.drain()[-1].ranges[1] == pytest.approx(2.0 - 0.1, abs=1e-6)
    box.pose = cw.Pose((2.0, 3.0, 0.1))
    world.run(1.0)
    assert scans.drain()[-1].ranges[1] == pytest.approx(4.9, abs=1e-6)
    uncompiled()
    world.model("wall").pose = cw.Pose((3, 0, 1))
    assert world.model("wall").pose == cw.Pose((3, 0, 1))
    assert world.model("wall").link("link").pose == cw.Pose((3, 0, 1))
    world.run(1.0)
    assert scans.drain()[-1].ranges[1] == pytest.approx(2.9, abs=1e-6)
    box.pose = cw.Pose((2.0, 0.0, 0.1))
    box.link("link").friction = 0.0
    box.velocity = cw.Twist((1.0, 0, 0))
    world.run(0.9)
    # It has met the wall at x = 2.9 - 0.1.
    assert box.pose.x == pytest.approx(2.8, abs=0.01)
    assert world.contacts(between=(box, "wall")) or box.velocity.linear[0] <= 0.0
    world.reset()
    assert world.model("wall").pose == cw.Pose((5, 0, 1))
    scans.drain()
    world.run(1.0)
    assert scans.drain()[-1].ranges[1] == pytest.approx(1.9, abs=1e-6)


def test_a_floor_that_is_lowered_wakes_what_rests_on_it(make, uncompiled):
    world = make.world(
        make.box("table", (1, 1, 0.1), static=True, pose=cw.Pose((0, 0, 1))),
        make.box("box", (0.2,) * 3, pose=cw.Pose((0, 0, 1.15))),
    )
    world.run(6.0)
    assert (world.session.simulation.data.tree_asleep >= 0).any()
    uncompiled()
    world.model("table").pose = cw.Pose((0, 0, 0.5))
    world.run(2.0)
    assert world.model("box").pose.z == pytest.approx(0.65, abs=1e-3)


def test_a_moved_wall_stays_when_models_are_spawned(make):
    world = make.world(make.box("wall", (0.2, 4, 2), static=True, pose=cw.Pose((5, 0, 1))))
    world.model("wall").pose = cw.Pose((3, 0, 1))
    world.spawn(make.box("box", (0.2,) * 3), x=1.0, z=0.1)
    assert world.model("wall").pose == cw.Pose((3, 0, 1))
    assert world.session.simulation.snapshot().positions[1].tolist() == [3, 0, 1]
    world.model("wall").pose = cw.Pose((4, 0, 1))
    assert world.session.simulation.snapshot().positions[1].tolist() == [4, 0, 1]
    world.reset()
    assert world.model("wall").pose == cw.Pose((5, 0, 1))


# -- appearance


def seen(world):
    """The mean colour in the middle of the camera's image."""
    return pixels_of(take(world, "/cam/image_raw"))[10:14, 14:18].reshape(-1, 3).mean(axis=0)


@pytest.fixture
def scene(make):
    """A camera at 1 m, which looks at a grey wall."""
    return make.world(
        make.box("wall", (0.2, 4, 4), static=True, pose=cw.Pose((3, 0, 1))),
        make.sdf(sensor(width=32, height=24)),
        ground=None,
    )


def test_a_camera_sees_a_colour(scene, make, uncompiled):
    wall = scene.model("wall").link("link")
    grey = seen(scene)
    assert np.ptp(grey) < 2
    uncompiled()
    wall.color = (1.0, 0.0, 0.0)
    assert wall.color == (1, 0, 0, 1)
    red = seen(scene)
    assert red[0] > 100
    assert red[1:].max() < 0.1 * red[0]
    wall.color = (0.0, 0.0, 1.0, 1.0)
    assert seen(scene).argmax() == 2
    scene.reset()
    assert seen(scene).argmax() == 2


def test_a_colour_set_before_the_first_image(scene):
    scene.model("wall").link("link").color = np.array([0.0, 1.0, 0.0])
    assert seen(scene).argmax() == 1


def test_a_colour_stays_when_models_are_spawned(scene, make):
    scene.model("wall").link("link").color = (0, 1, 0)
    assert seen(scene).argmax() == 1
    scene.spawn(make.box("box", (0.1,) * 3), x=-3.0)
    assert seen(scene).argmax() == 1


def test_a_transparent_colour(scene):
    scene.model("wall").link("link").color = (1.0, 0.0, 0.0, 0.0)
    clear = seen(scene)
    scene.model("wall").link("link").color = (1.0, 0.0, 0.0, 0.5)
    half = seen(scene)
    # The background of 0.7 is behind it.
    assert clear == pytest.approx([178] * 3, abs=4)
    assert half[0] > half[1]
    assert half[1] < clear[1] - 20


def test_a_texture(scene, tmp_path):
    wall = scene.model("wall").link("link")
    before = scene.session.simulation.model
    image = np.zeros((8, 8, 3), dtype=np.uint8)
    image[..., 2] = 255
    wall.texture = image
    assert isinstance(wall.texture, bytes)
    assert seen(scene).argmax() == 2
    from PIL import Image

    Image.fromarray(image[..., ::-1].copy()).save(tmp_path / "red.png")
    wall.texture = tmp_path / "red.png"
    assert wall.texture == (tmp_path / "red.png").resolve()
    assert seen(scene).argmax() == 0
    assert scene.session.simulation.model is before
    wall.color = (0, 1, 0)
    assert wall.texture is None
    assert seen(scene).argmax() == 1


def test_lights(make, uncompiled):
    """The wall faces the camera and a lamp beside it."""
    lamp = """<light type="point" name="lamp"><pose>1 0 1 0 0 0</pose><diffuse>0.5 0.5 0.5 1
    </diffuse><attenuation><range>20</range><constant>1</constant></attenuation></light>"""
    from cartwheel.description import load_text

    described = load_text(
        f'<sdf version="1.7"><world name="w">{lamp}</world></sdf>', file="test.sdf"
    )
    world = make.world(
        make.box("wall", (0.2, 4, 4), static=True, pose=cw.Pose((3, 0, 1))),
        make.sdf(sensor(width=32, height=24)),
        lights=described.lights,
    )
    light = world.light("lamp")
    assert world.lights == ("lamp",)
    assert (light.type, light.on, light.intensity, light.color) == ("point", True, 1, (0.5,) * 3)
    lit = seen(world)
    uncompiled()
    light.on = False
    dark = seen(world)
    assert dark.max() < lit.min() - 10
    light.on = True
    assert seen(world) == pytest.approx(lit)
    light.intensity = 0.5
    assert dark.mean() < seen(world).mean() < lit.mean()
    light.color = (1.0, 0.0, 0.0)
    light.intensity = 1.0
    assert seen(world).argmax() == 0
    light.position = (1, 0, 1.5)
    assert light.position == (1, 0, 1.5)
    light.direction = (0, 0, -2)
    assert light.direction == (0, 0, -2)
    world.reset()
    assert light.color == (1, 0, 0)


# -- others


def test_a_change_affects_no_other_world_of_a_build(make, rosbots):
    built = cw.build("walls", {"robot": rosbots, "z": 0.05})

    def trace(change=lambda world: None):
        with built.world() as world:
            world.publish("/part2_cmr/cmd_vel", linear_x=0.4, angular_z=0.2)
            change(world)
            world.run(0.5)
            data = world.session.simulation.data
            image = pixels_of(take(world, "/rosbots/camera1/image_raw"))
            return data.qpos.tolist(), image.tolist()

    def change(world):
        cart = world.model("rosbots")
        link = cart.link("base_link")
        link.mass *= 3
        link.color = (1, 0, 0)
        cart.joints.damping = [1.0, 1.0]
        for name in cart.links:
            if name.startswith("wheel"):
                cart.link(name).friction = 0.05
                cart.link(name).gravity = False
        world.gravity = (0, 0, -5)
        for name in world.models:
            if name not in ("rosbots", "ground_plane"):
                world.model(name).pose = cw.Pose((20, 20, 0))
                world.model(name).link(world.model(name).links[0]).color = (0, 1, 0)
        for name in world.lights:
            world.light(name).on = False

    first = trace()
    other = trace(change)
    assert other[0] != first[0]
    assert other[1] != first[1]
    assert trace() == first
    assert trace(change) == other


def test_a_change_by_a_callback(box, make):
    world, model, link = box
    masses = []

    def change(_):
        link.mass = link.mass + 1.0
        masses.append(link.mass)

    world.subscribe("/clock", change)
    world.run(0.1)
    assert masses
    assert link.mass == masses[-1]
    assert model.velocity.linear[2] == pytest.approx(-G * 0.1, rel=1e-9)


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("mass", (0.0, -1.0, math.nan, math.inf, "heavy", None, 1e13)),
        (
            "inertia",
            (1.0, np.eye(2), np.diag([1, 1, 3]), -np.eye(3), np.triu(np.ones((3, 3)))),
        ),
        ("center_of_mass", (1.0, (0, 0), (0, 0, math.inf))),
        ("friction", (-0.1, math.nan, (1, 2, 3), "rough")),
        ("color", (0.5, (1, 2, 3), (0, 0), "red", (0, 0, 0, math.nan), (0, 0, 0, 1, 1))),
        ("gravity", ("no", None, 0.5, 2)),
        ("texture", (np.zeros((4, 4)), np.zeros((4, 4, 3)), np.zeros((0, 4, 3), dtype=np.uint8))),
    ],
)
def test_values_that_a_link_cannot_have(box, name, values):
    _, _, link = box
    before = link._described
    for value in values:
        with raises(VALUE_INVALID):
            setattr(link, name, value)
    assert link._described == before


def test_values_that_a_joint_cannot_have(pendulum):
    world, model = pendulum
    hinge = model.joints["hinge"]
    for name in ("damping", "friction"):
        for value in (-1.0, math.nan, math.inf, "much", "0.5", None):
            with raises(VALUE_INVALID):
                setattr(hinge, name, value)
        for values in ("0.5", ["0.5"], [b"1"]):
            with raises(VALUE_INVALID):
                setattr(model.joints, name, values)
    for limits in ((1.0, 0.0), (0.0,), (math.nan, 1.0), 3.0):
        with raises(VALUE_INVALID):
            hinge.limits = limits
    for gains in (cw.Gains(math.nan), 100.0, (1.0, 2.0, 3.0)):
        with raises(VALUE_INVALID):
            hinge.gains = gains
    for gravity in ((0, 0), ("0", "0", "-9.8")):
        with raises(VALUE_INVALID):
            world.gravity = gravity


def test_properties_that_are_missing(make):
    world = make.world()
    cart = world.spawn("rosbots.xacro", z=0.05)
    foot = cart.link("base_footprint")
    assert foot.mass == 0.0
    for name, value in (("mass", 1.0), ("inertia", np.eye(3)), ("center_of_mass", (0, 0, 0))):
        with raises(PROPERTY_ABSENT, kind="link", name="base_footprint"):
            setattr(foot, name, value)
    with raises(PROPERTY_ABSENT, name="base_footprint", property="collision"):
        foot.friction = 1.0
    with raises(FILE_MISSING):
        foot.texture = "nowhere.png"
    with raises(ENTITY_UNKNOWN, UnknownNameError, name="moon"):
        world.light("moon")


def test_a_light_is_on_or_off():
    with cw.World("empty") as world:
        with raises(VALUE_INVALID, name="on"):
            world.light("sun").on = "off"
        assert world.light("sun").on
        world.light("sun").on = False
        assert not world.light("sun").on


def test_a_closed_world_keeps_its_properties(box):
    world, _, link = box
    world.close()
    for change in (
        lambda: setattr(link, "mass", 1.0),
        lambda: setattr(link, "color", (1, 0, 0)),
        lambda: setattr(world, "gravity", (0, 0, 0)),
    ):
        with raises(SIMULATION_CLOSED):
            change()
    assert link.mass == 2.0
