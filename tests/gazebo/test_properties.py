"""What is set of links, joints and lights counts in the physics, and goes on counting."""

import math

import numpy as np
import pytest

from cartwheel.codes.graph import ENTITY_UNKNOWN
from cartwheel.description.model import Light
from cartwheel.errors import Origin
from cartwheel.geometry import Pose

from .conftest import notes, vec, xyz

STEP = 0.005
G = 9.8


CUBE = {"mass": 5.0, "ixx": 0.3, "iyy": 0.4, "izz": 0.5, "ixy": 0.01, "ixz": 0.02, "iyz": 0.03}


@pytest.fixture
def cube(make, gazebo):
    return gazebo(
        make.world(make.box("cube", (0.5,) * 3, pose=Pose((0, 0, 9))), ground=None, gravity=0.0)
    )


def set_link(api, name, com=(0, 0, 0), *, gravity=True, **values):
    return api.done(
        "set_link_properties",
        link_name=name,
        gravity_mode=gravity,
        com={"position": xyz(com)},
        **CUBE | values,
    )


def pushed(api, name="cube::link", force=(10.0, 0, 0), torque=(0, 0, 0), seconds=0.5):
    """Speeds that a wrench makes of rest: of the frame's origin, and turning."""
    start = api.done("get_link_state", link_name=name).link_state.twist
    api.done(
        "apply_body_wrench",
        body_name=name,
        wrench={"force": xyz(force), "torque": xyz(torque)},
        duration={"nanosec": round(seconds * 1e9)},
    )
    api.world.run(seconds)
    end = api.done("get_link_state", link_name=name).link_state.twist
    return vec(end.linear) - vec(start.linear), vec(end.angular) - vec(start.angular)


def test_properties_of_a_link_as_described(make, gazebo):
    api = gazebo(make.world(make.box("cube", (0.5, 0.3, 0.2), mass=3.0)))
    found = api.done("get_link_properties", link_name="cube::link")
    assert found.mass == 3.0
    assert found.ixx == pytest.approx(3.0 * (0.3**2 + 0.2**2) / 12)
    assert found.gravity_mode
    assert vec(found.com.position) == pytest.approx([0, 0, 0])
    assert found.com.orientation.w == 1.0


def test_what_is_set_is_published(cube):
    set_link(cube, "cube::link", (0.1, 0.2, 0.3), gravity=False)
    found = cube.done("get_link_properties", link_name="cube::link")
    for name, value in CUBE.items():
        assert getattr(found, name) == value
    assert vec(found.com.position) == pytest.approx([0.1, 0.2, 0.3])
    assert not found.gravity_mode


def spawn_and_delete(make, api):
    api.world.session.spawn(make.box("other", (0.1,) * 3, pose=Pose((5, 5, 9))))
    api.done("delete_model", model_name="other")


AFTER = {
    "at once": lambda make, api: None,
    "spawn": spawn_and_delete,
    "reset": lambda make, api: api("reset_simulation"),
    "reset_world": lambda make, api: api("reset_world"),
}


@pytest.mark.parametrize("after", AFTER)
def test_mass_and_inertia_count(make, cube, after):
    """dv = F t / m and dw = T t / I, whatever came between."""
    set_link(cube, "cube::link", ixy=0.0, ixz=0.0, iyz=0.0)
    AFTER[after](make, cube)
    linear, _ = pushed(cube)
    assert linear == pytest.approx([10.0 * 0.5 / 5.0, 0, 0], rel=1e-9)
    _, angular = pushed(cube, force=(0, 0, 0), torque=(0, 0, 1.0))
    assert angular == pytest.approx([0, 0, 1.0 * 0.5 / 0.5], rel=1e-9)


@pytest.mark.parametrize("after", AFTER)
def test_the_centre_of_mass_counts(make, cube, after):
    """A push through the new centre turns nothing; one step of it, so that all stays in line."""
    set_link(cube, "cube::link", (0.2, 0.0, 0.0))
    AFTER[after](make, cube)
    linear, angular = pushed(cube, force=(0, 10.0, 0), seconds=STEP)
    assert linear == pytest.approx([0, 10.0 * STEP / 5.0, 0], rel=1e-9)
    assert np.abs(angular).max() < 1e-12


@pytest.mark.parametrize("after", AFTER)
def test_without_gravity_it_floats(make, gazebo, after):
    world = make.world(make.box("cube", (0.5,) * 3, pose=Pose((0, 0, 9))), ground=None)
    api = gazebo(world)
    set_link(api, "cube::link", gravity=False)
    AFTER[after](make, api)
    world.run(1.0)
    assert world.model("cube").pose.z == pytest.approx(9.0, abs=1e-9)
    set_link(api, "cube::link", gravity=True)
    world.run(0.5)
    n = 100
    assert world.model("cube").pose.z == pytest.approx(9.0 - G * STEP**2 * n * (n + 1) / 2)


def test_it_changes_nothing_of_the_motion(cube):
    """What flies goes on flying when its mass changes."""
    cube.done(
        "set_model_state",
        model_state={
            "model_name": "cube",
            "pose": {"position": xyz((0, 0, 9))},
            "twist": {"linear": xyz((1, 0, 0))},
        },
    )
    cube.world.run(0.5)
    set_link(cube, "cube::link")
    cube.world.run(0.5)
    assert cube.world.model("cube").pose.position == pytest.approx((1.0, 0, 9), abs=1e-9)


def test_a_heavier_box_presses_harder(make, gazebo):
    """The ground bears it, and the contact's softness follows the new mass."""
    world = make.world(make.box("cube", (0.5,) * 3, mass=2.0, pose=Pose((0, 0, 0.25))))
    api = gazebo(world)
    set_link(api, "cube::link", mass=50.0, ixx=2.0, iyy=2.0, izz=2.0, ixy=0, ixz=0, iyz=0)
    # A breath of a push keeps it awake: what sleeps has no contacts to be read.
    api.done(
        "apply_body_wrench",
        body_name="cube::link",
        wrench={"force": {"z": -1e-6}},
        duration={"sec": -1},
    )
    world.run(1.0)
    force = sum(contact.force[2] for contact in contacts(api))
    assert force == pytest.approx(50.0 * G, rel=0.01)
    assert world.model("cube").pose.z == pytest.approx(0.25, abs=2e-3)


def contacts(api):
    from cartwheel.simulation.sensing.contacts import read_contacts

    api.simulation.refresh()
    return read_contacts(api.simulation.model, api.simulation.data, {"cube::link::collision"})


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"mass": 0.0}, "mass must be above 0"),
        ({"mass": -1.0}, "mass must be above 0"),
        ({"mass": math.nan}, "mass must be a finite number (got nan)"),
        ({"ixx": 5.0}, "no rigid body can have this inertia"),
        ({"ixx": -1.0}, "not positive definite"),
        ({"iyz": math.inf}, "iyz must be a finite number (got inf)"),
        ({"link_name": "cube::lank"}, 'Did you mean "cube::link"?'),
        (
            {"com": {"position": {"z": math.nan}}},
            "com.position.z must be a finite number (got nan)",
        ),
    ],
)
@pytest.mark.wording
def test_link_refusals(cube, values, said):
    assert said in cube.refused(
        "set_link_properties", **{"link_name": "cube::link"} | CUBE | values
    )
    assert cube.done("get_link_properties", link_name="cube::link").mass == 2.0


# -- joints


def arm(make, gazebo, axis="", gravity=0.0):
    model = make.sdf(
        f"""<model name="arm"><link name="base"/>
        <joint name="fix" type="fixed"><parent>world</parent><child>base</child></joint>
        <link name="bar"><inertial><mass>1</mass>
          <inertia><ixx>.5</ixx><iyy>.5</iyy><izz>.5</izz></inertia></inertial></link>
        <joint name="hinge" type="revolute"><parent>base</parent><child>bar</child>
          <axis><xyz>0 0 1</xyz>{axis}</axis></joint></model>"""
    )
    return gazebo(make.world(model, ground=None, gravity=gravity))


def spin(api, effort=1.0, seconds=1.0):
    api.done(
        "apply_joint_effort",
        joint_name="hinge",
        effort=effort,
        duration={"sec": int(seconds), "nanosec": round(seconds % 1 * 1e9)},
    )
    api.world.run(seconds)


@pytest.mark.parametrize("after", AFTER)
def test_damping_counts(make, gazebo, after):
    """w = w0 exp(-d t / I)."""
    api = arm(make, gazebo)
    api.done("set_joint_properties", joint_name="hinge", ode_joint_config={"damping": [0.25]})
    AFTER[after](make, api)
    assert api.done("get_joint_properties", joint_name="hinge").damping == pytest.approx([0.25])
    joint = api.simulation.engine.joint_id("arm", "hinge")
    api.simulation.data.qvel[api.simulation.model.jnt_dofadr[joint]] = 2.0
    api.world.run(2.0)
    rate = api.done("get_joint_properties", joint_name="hinge").rate[0]
    # The implicit step damps by 1 / (1 + d h / I) each: 400 of them.
    assert rate == pytest.approx(2.0 / (1 + 0.25 * STEP / 0.5) ** 400, rel=1e-9)
    assert rate == pytest.approx(2.0 * math.exp(-1.0), rel=2e-3)


@pytest.mark.parametrize("after", AFTER)
def test_stops_count(make, gazebo, after):
    api = arm(make, gazebo)
    api.done(
        "set_joint_properties",
        joint_name="arm::hinge",
        ode_joint_config={"hiStop": [0.4], "loStop": [-0.2]},
    )
    AFTER[after](make, api)
    for effort, stop in ((0.5, 0.4), (-0.5, -0.2)):
        spin(api, effort, 4.0)
        position = api.done("get_joint_properties", joint_name="hinge").position[0]
        assert position == pytest.approx(stop, abs=0.01)


def test_gazebos_number_for_no_stop_frees_the_joint(make, gazebo):
    api = arm(make, gazebo, "<limit><lower>-0.2</lower><upper>0.2</upper></limit>")
    api.done(
        "set_joint_properties",
        joint_name="hinge",
        ode_joint_config={"hiStop": [1e16], "loStop": [-1e16]},
    )
    spin(api)
    assert api.done("get_joint_properties", joint_name="hinge").position[0] > 0.9


@pytest.mark.wording
def test_what_has_no_effect_is_said(make, gazebo):
    api = arm(make, gazebo)
    answer = api.done(
        "set_joint_properties",
        joint_name="hinge",
        ode_joint_config={"cfm": [0.1], "fudge_factor": [0.5], "erp": [0.0]},
    )
    assert len(notes(answer)) == 1
    assert "cfm, fudge_factor have no effect" in answer.status_message


def joint_rate(api):
    return api.done("get_joint_properties", joint_name="hinge").rate[0]


@pytest.mark.parametrize("after", AFTER)
def test_a_motor_reaches_its_velocity_with_its_effort(make, gazebo, after):
    """a = fmax / I until vel, and vel from then on, against less than fmax."""
    api = arm(make, gazebo)
    config = {"fmax": [0.5], "vel": [2.0]}
    api.done("set_joint_properties", joint_name="hinge", ode_joint_config=config)
    AFTER[after](make, api)
    api.world.run(1.0)
    assert joint_rate(api) == pytest.approx(0.5 / 0.5 * 1.0, rel=0.02)
    spin(api, -0.3, 4.0)
    assert joint_rate(api) == pytest.approx(2.0, rel=1e-3)
    api.done("set_joint_properties", joint_name="hinge", ode_joint_config={"vel": [-1.0]})
    api.world.run(8.0)
    assert joint_rate(api) == pytest.approx(-1.0, rel=1e-3)


def test_a_motor_without_velocity_is_friction(make, gazebo):
    api = arm(make, gazebo)
    api.done("set_joint_properties", joint_name="hinge", ode_joint_config={"fmax": [0.5]})
    spin(api, 0.4, 2.0)
    assert abs(joint_rate(api)) < 1e-4
    spin(api, 0.8, 1.0)
    assert joint_rate(api) == pytest.approx((0.8 - 0.5) / 0.5, rel=0.02)


def test_a_motor_ends_with_its_effort(make, gazebo):
    api = arm(make, gazebo)
    for fmax in (0.5, 0.0):
        api.done("set_joint_properties", joint_name="hinge", ode_joint_config={"fmax": [fmax]})
    spin(api, 0.4, 1.0)
    assert joint_rate(api) == pytest.approx(0.4 / 0.5, rel=1e-9)
    api.done("set_joint_properties", joint_name="hinge", ode_joint_config={"fmax": [0.5]})
    assert api.simulation.driven("arm", "hinge")


@pytest.mark.wording
def test_a_velocity_without_effort_is_said_to_do_nothing(make, gazebo):
    api = arm(make, gazebo)
    answer = api.done("set_joint_properties", joint_name="hinge", ode_joint_config={"vel": [1.0]})
    assert "vel has no effect" in answer.status_message


def test_the_effort_of_a_driven_wheel(make, gazebo, rosbots):
    """The cart's own motors become so weak that it speeds up with 2 T / (r m') at most."""
    world = make.world()
    world.session.spawn(rosbots, pose=Pose((0, 0, 0.05)))
    api = gazebo(world)
    world.run(1.0)
    for side in ("left", "right"):
        answer = api.done(
            "set_joint_properties",
            joint_name=f"wheel_{side}_joint",
            ode_joint_config={"fmax": [0.3], "vel": [5.0]},
        )
        assert len(notes(answer)) == 1
    world.publish("/part2_cmr/cmd_vel", linear_x=1.0)
    start = world.model("rosbots").pose.x
    world.run(2.0)
    wheel = next(link for link in rosbots.links if link.name == "wheel_left_link").inertial
    rolling = rosbots.mass + 2 * max(wheel.ixx, wheel.iyy, wheel.izz) / 0.26**2
    expected = 2 * 0.3 / 0.26 / rolling
    assert world.model("rosbots").pose.x - start == pytest.approx(expected * 2.0, rel=0.1)


def test_joint_types(make, gazebo, rosbots):
    world = make.world()
    world.session.spawn(rosbots, pose=Pose((0, 0, 0.05)))
    api = gazebo(world)
    wheel = api.done("get_joint_properties", joint_name="wheel_left_joint")
    assert wheel.type == wheel.CONTINUOUS
    assert len(wheel.position) == len(wheel.rate) == len(wheel.damping) == 1
    world.publish("/part2_cmr/cmd_vel", linear_x=0.26)
    world.run(3.0)
    # The wheel's radius is 0.26 m.
    rate = api.done("get_joint_properties", joint_name="wheel_left_joint").rate[0]
    assert rate == pytest.approx(1.0, rel=0.02)
    fixed = api.done("get_joint_properties", joint_name="camera_joint")
    assert fixed.type == fixed.FIXED
    assert len(fixed.position) == 0


@pytest.mark.parametrize(
    ("joint", "config", "said"),
    [
        ("hing", {}, 'Did you mean "hinge"?'),
        ("arm", {}, "is a model, not a joint"),
        ("hinge", {"damping": [-1.0]}, "damping must be between 0"),
        (
            "hinge",
            {"damping": [math.nan]},
            "ode_joint_config.damping must be a finite number (got nan)",
        ),
        ("hinge", {"fmax": [-1.0]}, "fmax must not be negative"),
        ("hinge", {"vel": [math.inf]}, "ode_joint_config.vel must be a finite number (got inf)"),
        ("hinge", {"hiStop": [-1.0], "loStop": [1.0]}, "loStop 1 is above hiStop -1"),
    ],
)
@pytest.mark.wording
def test_joint_refusals(make, gazebo, joint, config, said):
    api = arm(make, gazebo)
    assert said in api.refused("set_joint_properties", joint_name=joint, ode_joint_config=config)


# -- models and the world


def test_model_properties(make, gazebo, rosbots):
    world = make.world()
    world.session.spawn(rosbots, pose=Pose((0, 0, 0.05)))
    api = gazebo(world)
    found = api.done("get_model_properties", model_name="rosbots")
    assert found.canonical_body_name == "base_footprint"
    # Gazebo loses these two.
    assert {"base_link", "camera_link"} <= set(found.body_names)
    assert {"wheel_left_joint", "wheel_right_joint"} <= set(found.joint_names)
    assert "base_link_collision" in found.geom_names
    assert not found.is_static
    assert found.parent_model_name == ""
    assert api.done("get_model_properties", model_name="ground_plane").is_static
    meant = {"kind": "model", "name": "rosbot", "meant": "rosbots"}
    api.fails("get_model_properties", ENTITY_UNKNOWN, meant, model_name="rosbot")


def test_world_properties(make, gazebo):
    world = make.world(make.box("cube", (1, 1, 1)))
    api = gazebo(world)
    world.run(1.5)
    found = api.done("get_world_properties")
    assert found.sim_time == pytest.approx(1.5)
    assert found.model_names == ["ground_plane", "cube"]
    assert found.rendering_enabled


# -- lights

SUN = Light(name="sun", type="directional", origin=Origin(file="test.sdf"))
LAMP = Light(name="lamp", type="point", pose=Pose((0, 0, 3)), origin=Origin(file="test.sdf"))


@pytest.fixture
def lit(make, gazebo):
    return gazebo(make.world(lights=(SUN, LAMP)))


def brightness(api, name):
    model = api.simulation.model
    return model.light(name).diffuse.tolist()


def test_light_properties(lit):
    request = {
        "light_name": "lamp",
        "diffuse": {"r": 0.1, "g": 0.2, "b": 0.3, "a": 1.0},
        "specular": {"r": 0.4, "g": 0.4, "b": 0.4, "a": 1.0},
        "attenuation_constant": 0.5,
        "attenuation_linear": 0.25,
        "attenuation_quadratic": 0.125,
        "pose": {"position": {"x": 1.0, "y": 2.0, "z": 3.0}},
        "direction": {"z": -1.0},
    }
    lit.done("set_light_properties", **request)
    found = lit.done("get_light_properties", light_name="lamp")
    assert (found.diffuse.r, found.diffuse.g, found.diffuse.b) == pytest.approx((0.1, 0.2, 0.3))
    assert found.attenuation_constant == 0.5
    assert found.attenuation_linear == 0.25
    assert found.attenuation_quadratic == 0.125
    lit.world.run(0.01)
    assert brightness(lit, "lamp") == pytest.approx([0.1, 0.2, 0.3])
    assert lit.simulation.model.light("lamp").pos.tolist() == [1.0, 2.0, 3.0]
    assert brightness(lit, "sun") == pytest.approx(SUN.diffuse[:3])
    lit.world.session.spawn(load_cube())
    assert brightness(lit, "lamp") == pytest.approx([0.1, 0.2, 0.3])


def load_cube():
    from cartwheel.description import load_text

    return load_text(
        '<robot name="c"><link name="l"><inertial><mass value="1"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>'
    )


def test_delete_light(lit):
    lit.done("delete_light", light_name="lamp")
    assert lit.simulation.model.nlight == 1
    gone = {"kind": "light", "name": "lamp", "meant": ""}
    lit.fails("get_light_properties", ENTITY_UNKNOWN, gone, light_name="lamp")
    meant = {"kind": "light", "name": "snu", "meant": "sun"}
    lit.fails("delete_light", ENTITY_UNKNOWN, meant, light_name="snu")


@pytest.mark.wording
def test_light_refusals(lit):
    message = lit.refused("set_light_properties", light_name="sun", attenuation_linear=math.inf)
    assert "attenuation_linear must be a finite number (got inf)" in message
    message = lit.refused("set_light_properties", light_name="son")
    assert 'Did you mean "sun"?' in message
