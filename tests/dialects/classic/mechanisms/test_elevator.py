"""The elevator: where it goes, what it carries, what it refuses."""

import pytest

from cartwheel.codes import running
from cartwheel.description import load_world
from cartwheel.description.files.package_folders import share
from cartwheel.geometry import Pose

FLOOR, SILL = 3.0, 0.1
ORDER = "/elevator"


@pytest.fixture
def world(make):
    import cartwheel as cw

    with cw.World(load_world(share() / "worlds" / "elevator.world")) as made:
        yield made


def order(world, text):
    world.publish(ORDER, data=text)


def joint(world, name):
    return world.session.simulation.joint_position("elevator", name)


def lift_model(make, plugin):
    """A car on a prismatic joint, with a door and a plugin."""
    inertial = "<inertial><mass>10</mass></inertial>"
    slide = '<joint name="{0}" type="prismatic"><parent>{1}</parent><child>{2}</child>{3}</joint>'
    return make.sdf(
        f'<model name="car"><link name="cage">{inertial}</link><link name="leaf">{inertial}</link>'
        + slide.format("lift", "world", "cage", "<axis><xyz>0 0 1</xyz></axis>")
        + slide.format("door", "cage", "leaf", "<axis><xyz>0 1 0</xyz></axis>")
        + f"{plugin}</model>"
    )


def way(distance, speed, acceleration):
    """Seconds for a distance at a limited speed and acceleration."""
    ramps = speed**2 / acceleration
    if distance < ramps:
        return 2 * (distance / acceleration) ** 0.5
    return distance / speed + speed / acceleration


def test_it_carries_a_box_to_a_floor_opens_waits_and_closes(world):
    half = 0.25
    world.run(1.0)
    order(world, "1")
    # 3 m at 1.5 m/s and 1 m/s², then 1 m of door at 0.5 m/s.
    there = way(FLOOR, 1.5, 1.0)
    world.run(there + 0.5)
    assert joint(world, "lift") == pytest.approx(FLOOR, abs=3e-3)
    assert world.model("parcel").pose.z == pytest.approx(SILL + FLOOR + half, abs=0.01)
    world.run(way(1.0, 0.5, 1.0))
    assert joint(world, "door") == pytest.approx(1.0, abs=3e-3)
    world.run(3.5)
    assert joint(world, "door") == pytest.approx(1.0, abs=3e-3)
    world.run(1.5 + way(1.0, 0.5, 1.0) + 0.5)
    assert joint(world, "door") == pytest.approx(0.0, abs=3e-3)
    # It holds what it carries.
    before = joint(world, "lift")
    world.run(10.0)
    assert joint(world, "lift") == pytest.approx(before, abs=1e-3)


def test_while_it_is_busy_it_takes_no_other_order(world):
    order(world, "2")
    world.run(0.5)
    order(world, "1")
    world.run(way(2 * FLOOR, 1.5, 1.0) + 1.0)
    assert joint(world, "lift") == pytest.approx(2 * FLOOR, abs=3e-3)


@pytest.mark.parametrize("text", ["3", "-1", "roof"])
def test_what_is_no_floor_is_reported_and_left(world, text):
    before = len(world.session.diagnostics)
    order(world, text)
    world.run(3.0)
    (reported,) = world.session.diagnostics[before:]
    assert reported.code is running.COMMAND_IGNORED
    assert reported.values["floor"] == text
    assert joint(world, "lift") == pytest.approx(0.0, abs=1e-3)


@pytest.mark.wording
@pytest.mark.parametrize(
    ("bound", "text", "message"),
    [
        (
            "<bottom_floor>0</bottom_floor>",
            "-1",
            "a command is ignored: floor -1 is below the lowest floor 0",
        ),
        (
            "<top_floor>2</top_floor>",
            "3",
            "a command is ignored: floor 3 is above the highest floor 2",
        ),
    ],
)
def test_the_warning_names_the_bound_that_the_floor_exceeds(make, bound, text, message):
    plugin = f"""<plugin name="p" filename="libgazebo_ros_elevator.so">
      <lift_joint>lift</lift_joint><door_joint>door</door_joint>
      <floor_height>2</floor_height>{bound}</plugin>"""
    world = make.world(lift_model(make, plugin), ground=None)
    before = len(world.session.diagnostics)
    order(world, text)
    world.run(0.1)
    (diagnostic,) = world.session.diagnostics[before:]
    assert diagnostic.message == message


def test_a_reset_takes_it_back_to_rest(world):
    order(world, "2")
    world.run(2.0)
    world.reset()
    world.run(5.0)
    assert joint(world, "lift") == pytest.approx(0.0, abs=1e-3)
    order(world, "1")
    world.run(way(FLOOR, 1.5, 1.0) + 0.5)
    assert joint(world, "lift") == pytest.approx(FLOOR, abs=3e-3)


def test_names_with_the_models_before_them_are_understood(make):
    """Gazebo's own elevator world writes ``elevator::lift``."""
    plugin = """<plugin name="p" filename="libgazebo_ros_elevator.so">
      <lift_joint>car::lift</lift_joint><door_joint>car::door</door_joint>
      <floor_height>2</floor_height><topic>~/elevator</topic></plugin>"""
    model = lift_model(make, plugin)
    world = make.world(model, ground=None)
    order(world, "1")
    world.run(way(2.0, 1.5, 1.0) + 0.5)
    assert world.session.simulation.joint_position("car", "lift") == pytest.approx(2, abs=3e-3)


def test_the_door_gives_way_to_what_stands_in_it(make, world):
    """It pushes with its joint's effort, not with all the power of a servo."""
    pillar = make.box("pillar", (0.2, 0.2, 1.0), mass=200, pose=Pose((1.23, -0.7, 0.601)))
    order(world, "0")
    world.run(5.0)
    assert joint(world, "door") == pytest.approx(1.0, abs=3e-3)
    world.session.spawn(pillar)
    world.run(8.0)
    simulation = world.session.simulation
    # From 1 m open its edge, at y = -0.21, comes as far as the pillar's face at -0.6.
    assert joint(world, "door") == pytest.approx(1.0 - 0.39, abs=0.02)
    assert simulation.pose("pillar").position[1] == pytest.approx(-0.7, abs=0.01)
