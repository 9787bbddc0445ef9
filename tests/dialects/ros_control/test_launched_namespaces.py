"""Spawners whose controllers have their parameters in another namespace."""

import pytest
import yaml
from tests.coded import coded
from tests.dialects.ros_control.arms import ROS1, beam, robot, transmission

import cartwheel as cw
from cartwheel.codes.devices import CONTROLLER_UNDEFINED
from cartwheel.corpus import try_robot

SPAWNER = '<node name="s" pkg="controller_manager" type="spawner" {ns} args="move {more}"/>'
SPAWN = '<node name="m" pkg="gazebo_ros" type="spawn_model" args="-param robot_description"/>'
LOAD = '<rosparam file="$(find arm)/arm.yaml" command="load" {}/>'
MOVE = {"type": "position_controllers/JointPositionController", "joint": "beam_joint"}
STATES = {"type": "joint_state_controller/JointStateController", "publish_rate": 10}


@pytest.fixture
def arm(tmp_path):
    """Writes a robot, its controllers and a launch file, and returns the robot's file."""

    folder = tmp_path / "arm"
    folder.mkdir()

    def write(content, *elements, **others):
        body = beam("beam", "world", axis="0 0 1") + transmission("beam_joint", "Position")
        bot = folder / "arm.urdf"
        bot.write_text(robot(body, ROS1.replace(">/<", ">/arm<")))
        (folder / "package.xml").write_text("<package><name>arm</name></package>")
        (folder / "arm.yaml").write_text(yaml.safe_dump(content))
        shown = '<param name="robot_description" textfile="$(find arm)/arm.urdf"/>'
        model = (
            '<node name="m" pkg="gazebo_ros" type="spawn_model" args="-param robot_description"/>'
        )
        text = f"<launch>{shown}{model}{''.join(elements)}</launch>"
        (folder / "arm.launch").write_text(text)
        for name, other in others.items():
            (folder / f"{name}.launch").write_text(f"<launch>{other}</launch>")
        return bot

    return write


def spawner(space="", more=""):
    return SPAWNER.format(ns=f'ns="{space}"' if space else "", more=more)


def misplaced(verdict):
    found = [each for each in verdict.observed if each.code is CONTROLLER_UNDEFINED]
    return [(each.values["namespace"], each.values["stated"]) for each in found]


def test_controllers_whose_parameters_are_elsewhere_do_not_start(arm):
    bot = arm({"arm_controllers": {"move": MOVE}}, LOAD.format(""), spawner("arm"))
    verdict = try_robot(bot, standing=1.0)
    assert misplaced(verdict) == [("/arm", "/arm_controllers")]
    assert verdict.controllers == verdict.reaches == ()
    (fault,) = verdict.faults
    assert (fault.test, fault.subject, fault.source) == ("controller", "move", "file")


@pytest.mark.parametrize(
    ("content", "elements"),
    [
        ({"arm": {"move": MOVE}}, (LOAD.format(""), spawner("arm"))),
        ({"/arm": {"move": MOVE}}, (LOAD.format('ns="x"'), spawner("arm"))),
        ({"move": MOVE}, (LOAD.format('ns="arm"'), spawner("/arm"))),
        ({"move": MOVE}, ('<group ns="arm">', LOAD.format(""), spawner(), "</group>")),
        ({"arm": {"move": MOVE}}, (LOAD.format(""), spawner().replace("move", "/arm/move"))),
        ({"arm": {"move": MOVE}}, (LOAD.format(""), spawner("", "--namespace=/arm"))),
        # What only the execution determines, and what may be loaded elsewhere.
        ({"x": {"move": MOVE}}, (LOAD.format(""), spawner("$(arg unknown)"))),
        ({"x": {"move": MOVE}}, (LOAD.format('ns="$(arg unknown)"'), spawner("arm"))),
        ({"x": {"move": MOVE}}, (LOAD.format('param="arm"'), spawner("arm"))),
        (
            {"x": {"move": MOVE}},
            ('<node name="n" pkg="p" type="t">', LOAD.format(""), "</node>", spawner("arm")),
        ),
        (
            {"x": {"move": MOVE}},
            (LOAD.format(""), LOAD.format("").replace("arm.yaml", "no.yaml"), spawner("arm")),
        ),
    ],
)
def test_controllers_whose_parameters_are_or_may_be_in_the_same_namespace_start(
    arm, content, elements
):
    verdict = try_robot(arm(content, *elements), standing=1.0)
    assert misplaced(verdict) == []
    assert verdict.controllers == ("move",)
    # ROS does not start a launch file with a file that does not exist.
    lost = any("no.yaml" in each for each in elements)
    assert [each.test for each in verdict.faults] == ["load"] * lost


@pytest.mark.parametrize(
    ("content", "space", "stated"),
    [({"move": MOVE}, "x", "/x"), ({"move": MOVE}, "arm", None), (MOVE, "arm/move", None)],
)
def test_a_file_may_have_the_name_of_its_only_controller(arm, content, space, stated):
    """A controller without a name has that of the namespace into which it is loaded."""
    load = LOAD.format(f'ns="{space}"').replace("arm.yaml", "move.yaml")
    bot = arm({}, load, spawner("arm"))
    (bot.parent / "move.yaml").write_text(yaml.safe_dump(content))
    found = misplaced(try_robot(bot, standing=0.5))
    assert found == [("/arm", stated)] * (stated is not None)


def test_another_launch_file_may_load_the_parameters(arm):
    wrong = LOAD.format(""), spawner("arm")
    right = LOAD.format("").replace("arm.yaml", "right.yaml")
    bot = arm({"x": {"move": MOVE}}, *wrong, load=right)
    (bot.parent / "right.yaml").write_text(yaml.safe_dump({"arm": {"move": MOVE}}))
    assert misplaced(try_robot(bot, standing=1.0)) == []


def test_of_several_controllers_those_start_whose_parameters_are_found(arm):
    content = {"arm": {"states": STATES}, "x": {"move": MOVE}}
    verdict = try_robot(arm(content, LOAD.format(""), spawner("arm", "states")), standing=1.0)
    assert verdict.spawned == ("states",)
    assert [each.subject for each in verdict.faults] == ["move"]


@pytest.mark.wording
def test_controllers_with_the_same_namespaces_are_one_problem(arm):
    names = ["move", *(f"state{index}" for index in range(5))]
    content = {"x": {"move": MOVE, **dict.fromkeys(names[1:], STATES)}, "y": {"last": STATES}}
    verdict = try_robot(
        arm(content, LOAD.format(""), spawner("arm", " ".join([*names[1:], "last"]))), standing=1.0
    )
    assert misplaced(verdict) == [("/arm", "/x"), ("/arm", "/y")]
    several, one = (each for each in verdict.observed if each.code is CONTROLLER_UNDEFINED)
    assert several.values["controllers"] == tuple(names)
    assert '"move", "state0", "state1", "state2" and 2 more, whose' in several.message
    assert 'parameters in "/arm/last", but "arm.yaml" sets "/y/last"' in one.message
    assert verdict.controllers == ()
    assert [(each.test, each.subject) for each in verdict.faults] == [
        ("controller", "move"),
        ("controller", "last"),
    ]


def test_only_a_launch_file_that_is_started_keeps_controllers_from_starting(arm):
    bot = arm({"x": {"move": MOVE}}, LOAD.format(""), spawner("arm"))
    with cw.World("empty", lenient=True) as world:
        world.spawn(bot, controllers="auto")
        assert coded(world, CONTROLLER_UNDEFINED, controller="move", stated="/x")
        world.run(0.1)
        assert "/arm/move/command" in {each.name for each in world.graph.topics()}
    with cw.launch(bot.parent / "arm.launch", lenient=True) as world:
        assert coded(world, CONTROLLER_UNDEFINED, controller="move", stated="/x")
        world.run(0.1)
        assert "/arm/move/command" not in {each.name for each in world.graph.topics()}


@pytest.mark.parametrize(
    ("stated", "spawned", "started", "manager"),
    [
        ("/real", "", "other", "/real"),
        ("real", "", "/real", None),
        ("/", "", "arm", "/"),
        # spawn_model adds its namespace to plugins that state none.
        (None, "", "arm", "/"),
        (None, "", "", None),
        (None, "arm", "arm", None),
        (None, "arm", "other", "/arm"),
        # It is unknown.
        (None, "$(arg unknown)", "other", None),
    ],
)
def test_a_spawner_needs_the_namespace_of_the_controller_manager(
    arm, stated, spawned, started, manager
):
    space = started.strip("/")
    content = {space: {"move": MOVE}} if space else {"move": MOVE}
    bot = arm(content, LOAD.format(""), spawner(started))
    text = bot.read_text()
    tag = "" if stated is None else f"<robotNamespace>{stated}</robotNamespace>"
    changed = text.replace("<robotNamespace>/arm</robotNamespace>", tag)
    assert changed != text
    bot.write_text(changed)
    launch = bot.parent / "arm.launch"
    named = f' ns="{spawned}"' if spawned else ""
    launch.write_text(
        launch.read_text().replace('type="spawn_model"', f'type="spawn_model"{named}')
    )
    verdict = try_robot(bot, standing=1.0)
    found = [each for each in verdict.observed if each.code is CONTROLLER_UNDEFINED]
    assert [each.values["manager"] for each in found] == [manager] * (manager is not None)
    assert bool(verdict.controllers) == (manager is None)
    assert verdict.outcome == ("good" if manager is None else "file")


@pytest.mark.parametrize("joint", ["beam_joint", "other_joint"])
def test_a_launch_file_whose_controllers_command_another_robot_is_not_about_this_one(arm, joint):
    """It loads no description, as the launch file of the other robot includes it."""
    load = LOAD.format("").replace("arm.yaml", "other.yaml")
    bot = arm({}, control=load + spawner("other"))
    content = {"other": {"move": MOVE | {"joint": joint}}}
    (bot.parent / "other.yaml").write_text(yaml.safe_dump(content))
    verdict = try_robot(bot, standing=0.5)
    found = [each.values["manager"] for each in verdict.observed if "manager" in each.values]
    assert found == ["/arm"] * (joint == "beam_joint")
