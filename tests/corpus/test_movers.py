"""Unsupported plugins that may be what moves a robot."""

import pytest
from tests.corpus.carts import cart, plugin, written
from tests.corpus.test_rivals import MANAGER, managed

from cartwheel.codes.devices import (
    CONTROLLERS_NOT_FOUND,
    HARDWARE_NOT_SIMULATED,
    PLUGIN_MISPLACED,
    PLUGIN_UNKNOWN,
)
from cartwheel.codes.tags import TAG_IGNORED
from cartwheel.corpus import try_robot

OTHER = '<gazebo><plugin name="x" filename="{}"><target>person</target></plugin></gazebo>'


@pytest.mark.parametrize("name", ["libmy_follower.so", "libown_thing.so"])
def test_an_unsupported_plugin_may_be_what_moves_a_robot_with_wheels(tmp_path, name):
    verdict = try_robot(written(tmp_path, cart(), OTHER.format(name)), standing=1.0)
    assert verdict.outcome == "unknown"
    (fault,) = verdict.faults
    assert (fault.test, fault.code) == ("plugin", PLUGIN_UNKNOWN)
    assert fault.reason.values["name"] == name
    assert verdict.should_move


def test_an_unsupported_plugin_of_a_robot_that_a_drive_moves_is_no_fault(tmp_path):
    path = written(tmp_path, cart(), plugin(), OTHER.format("libown_thing.so"))
    assert try_robot(path, standing=1.0).good


def test_a_plugin_named_after_following_moves_a_model_whose_wheels_do_not_turn(tmp_path):
    box = cart().replace('type="continuous"', 'type="fixed"')
    verdict = try_robot(written(tmp_path, box, OTHER.format("libmy_follower.so")), standing=1.0)
    assert [each.code for each in verdict.faults] == [PLUGIN_UNKNOWN]


@pytest.mark.parametrize(
    ("name", "moves"),
    [
        ("libmove_ball.so", True),
        ("libBallMover.so", True),
        ("libmoving_box.so", True),
        ("libSimMotion.so", True),
        ("libmy_servo.so", True),
        ("libactuator_plugin.so", True),
        ("libBoatDynamics.so", True),
        ("libown_buoyancy.so", True),
        ("libhydro_forces.so", True),
        ("libpropulsion.so", True),
        ("libhydrophone.so", False),
        ("libmotion_sensor.so", False),
        ("libmotion_capture.so", False),
        ("libremove_model.so", False),
        ("libmoveit_scene.so", False),
    ],
)
def test_a_plugin_named_after_motion_moves_a_model_without_joints(tmp_path, name, moves):
    box = cart().split('<link name="left">', 1)[0]
    verdict = try_robot(written(tmp_path, box, OTHER.format(name)), standing=1.0)
    assert [each.code for each in verdict.faults] == [PLUGIN_UNKNOWN] * moves
    assert verdict.outcome == ("unknown" if moves else "good")


@pytest.mark.parametrize("more", ["", '<gazebo><plugin name="y" filename="libother.so"/></gazebo>'])
def test_the_only_plugin_of_a_model_with_one_turning_joint_may_move_it(tmp_path, more):
    """Of several, any may be about something else, and the joint that of a caster."""
    one = cart().replace('type="continuous"', 'type="fixed"', 1)
    path = written(tmp_path, one, OTHER.format("libown_thing.so"), more)
    verdict = try_robot(path, standing=1.0)
    assert [each.code for each in verdict.faults] == ([] if more else [PLUGIN_UNKNOWN])


def bounded(urdf: str) -> str:
    """A robot whose joints have limits instead of turning without end."""
    limit = '<limit lower="-1" upper="1" effort="5" velocity="2"/></joint>'
    first, *others = urdf.split('type="continuous"')
    return 'type="revolute"'.join((first, *(each.replace("</joint>", limit, 1) for each in others)))


def test_unsupported_hardware_may_be_what_moves_an_arm(tmp_path):
    """Its transmissions are for controllers, but nothing that is supported runs them."""
    box = bounded(cart())
    arm = managed("Effort").replace(MANAGER, OTHER.format("libmy_hw_gazebo_plugin.so"))
    verdict = try_robot(written(tmp_path, box, arm), standing=1.0)
    assert [each.code for each in verdict.faults] == [PLUGIN_UNKNOWN]
    assert verdict.outcome == "unknown"


@pytest.mark.parametrize("listed", [False, True])
def test_unsupported_hardware_may_move_a_robot_without_transmissions(tmp_path, listed):
    """With transmissions, it needs controllers, of which there are none."""
    kind = "><robotSimType>my_robot/FlyingHardware</robotSimType></plugin></gazebo>"
    parts = managed("Effort").replace("/></gazebo>", kind)
    if not listed:
        start, end = parts.index("<transmission"), parts.rindex("</transmission>")
        parts = parts[:start] + parts[end + len("</transmission>") :]
    (fault,) = try_robot(written(tmp_path, cart(), parts), standing=1.0).faults
    expected = (CONTROLLERS_NOT_FOUND, "file") if listed else (HARDWARE_NOT_SIMULATED, "unknown")
    assert (fault.code, fault.source) == expected


def test_controllers_that_are_only_loaded_are_not_why_unsupported_hardware_does_not_move(tmp_path):
    (tmp_path / "package.xml").write_text("<package><name>robot</name></package>")
    (tmp_path / "robot.launch").write_text(
        '<launch><param name="robot_description" textfile="$(find robot)/robot.urdf"/>'
        '<node name="s" pkg="controller_manager" type="spawner" args="--stopped move"/></launch>'
    )
    box = bounded(cart())
    arm = managed("Effort").replace(MANAGER, OTHER.format("libmy_hw_gazebo_plugin.so"))
    verdict = try_robot(written(tmp_path, box, arm), standing=1.0)
    assert [each.code for each in verdict.faults] == [PLUGIN_UNKNOWN]


@pytest.mark.parametrize(
    ("name", "drive", "moves"),
    [
        ("gazebo_ros_control", "", True),
        ("gazebo_ros_factory", "", False),
        ("gazebo_ros_control", plugin(), False),
    ],
    ids=["control", "factory", "driven"],
)
def test_a_plugin_that_gazebo_refuses_should_move_a_robot_if_its_name_says_so(
    tmp_path, name, drive, moves
):
    refused = f'<gazebo><plugin name="{name}" filename="libgazebo_ros_factory.so"/></gazebo>'
    arm = managed("Effort").replace(MANAGER, refused)
    verdict = try_robot(written(tmp_path, cart(), drive, arm), standing=1.0)
    assert [(each.test, each.code) for each in verdict.faults] == [
        ("plugin", PLUGIN_MISPLACED)
    ] * moves
    assert verdict.outcome == ("file" if moves else "good")
    assert verdict.plugins == (("gazebo_ros_diff_drive",) if drive else ())


@pytest.mark.parametrize("name", ["libmy_sensor.so", "libgazebo_ros_p3d.so"])
def test_what_measures_moves_no_robot(tmp_path, name):
    verdict = try_robot(written(tmp_path, cart(), OTHER.format(name)), standing=1.0)
    assert not verdict.should_move


@pytest.mark.parametrize(
    ("tags", "moves"),
    [
        ("<traj_x>cos(t)</traj_x>", True),
        ("<trajectory>circle</trajectory>", True),
        ("<waypoints>0 0 1 1</waypoints>", True),
        ("<path><point>0 0</point></path>", True),
        ("<linear_velocity>1</linear_velocity>", True),
        ("<path>maps/office.yaml</path>", False),
        ("<config_path>1</config_path>", False),
    ],
)
def test_an_unsupported_plugin_with_a_route_moves_a_model_without_joints(tmp_path, tags, moves):
    plugin = f'<gazebo><plugin name="x" filename="libown_thing.so">{tags}</plugin></gazebo>'
    box = (
        '<link name="base">'
        '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
        "</inertial>"
        '<collision><geometry><box size="1 1 1"/></geometry></collision></link>'
    )
    path = tmp_path / "robot.urdf"
    path.write_text(f'<robot name="robot">{box}{plugin}</robot>')
    verdict = try_robot(path, standing=0.5)
    assert [each.code for each in verdict.faults] == [PLUGIN_UNKNOWN] * moves
    assert verdict.outcome == ("unknown" if moves else "good")


@pytest.mark.parametrize(
    ("name", "tags", "moves"),
    [
        ("libmy_quadcopter.so", "", True),
        ("libown_thing.so", "<yawGain>2</yawGain>", True),
        ("libown_thing.so", "<bodyName>base</bodyName>", False),
        ("libgazebo_ros_imu_sensor.so", "<gain>2</gain>", False),
    ],
)
def test_a_plugin_of_an_ignored_element_of_a_model_is_a_fault_of_the_file(
    tmp_path, name, tags, moves
):
    path = tmp_path / "model.sdf"
    path.write_text(
        '<sdf version="1.6"><model name="robot"><link name="base">'
        "<inertial><mass>1</mass></inertial>"
        '<collision name="c"><geometry><box><size>1 1 1</size></box></geometry></collision></link>'
        f'<gazebo><plugin name="x" filename="{name}">{tags}</plugin></gazebo></model></sdf>'
    )
    verdict = try_robot(path, standing=0.5)
    assert [each.code for each in verdict.faults] == [TAG_IGNORED] * moves
    assert verdict.outcome == ("file" if moves else "good")
    assert verdict.should_move == moves


WHEELED = """<link name="base"><inertial><mass>2</mass><inertia><ixx>0.02</ixx><iyy>0.02</iyy>
<izz>0.02</izz></inertia></inertial><collision name="c"><geometry><box><size>0.3 0.15 0.06</size>
</box></geometry></collision></link>"""
for _name, _y in (("left", 0.1), ("right", -0.1)):
    WHEELED += f"""<link name="{_name}"><pose>0 {_y} 0 -1.5708 0 0</pose><inertial><mass>0.2</mass>
<inertia><ixx>1e-4</ixx><iyy>1e-4</iyy><izz>2e-4</izz></inertia></inertial><collision name="c">
<geometry><cylinder><radius>0.05</radius><length>0.02</length></cylinder></geometry></collision>
</link><joint name="{_name}_hinge" type="revolute"><parent>base</parent><child>{_name}</child>
<axis><xyz>0 0 1</xyz></axis></joint>"""
DIFF_DRIVE = """<plugin name="drive" filename="libgazebo_ros_diff_drive.so"><leftJoint>left_hinge
</leftJoint><rightJoint>right_hinge</rightJoint><wheelSeparation>0.2</wheelSeparation>
<wheelDiameter>0.1</wheelDiameter></plugin>"""


@pytest.mark.parametrize(
    ("name", "drive", "moves"),
    [
        ("libgazebo_ros_control.so", "", True),
        ("libgazebo_ros_contol.so", "", True),
        ("libgazebo_ros_contol.so", DIFF_DRIVE, False),
        ("libmy_sensor.so", "", False),
        ("libgazebo_ros_laser.so", "", False),
    ],
)
def test_a_misspelt_plugin_of_an_ignored_element_is_what_would_move_wheels(
    tmp_path, name, drive, moves
):
    path = tmp_path / "model.sdf"
    path.write_text(
        f'<sdf version="1.6"><model name="robot">{WHEELED}{drive}'
        f'<gazebo><plugin name="x" filename="{name}"/></gazebo></model></sdf>'
    )
    faults = [each for each in try_robot(path, standing=0.5).faults if each.test == "plugin"]
    assert [(each.code, each.source) for each in faults] == [(TAG_IGNORED, "file")] * moves


NAMING = (
    '<gazebo><plugin name="x" filename="libmotor_stream.so">'
    "<motorJoint>left_joint</motorJoint></plugin></gazebo>"
)
ARM = (
    '<link name="arm">'
    '<inertial><mass value="0.1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
    "</inertial>"
    '</link><joint name="shoulder" type="continuous"><parent link="base"/><child link="arm"/>'
    '<axis xyz="0 0 1"/></joint>'
)


@pytest.mark.parametrize(
    ("parts", "outcome"),
    [
        ((plugin(),), "good"),
        ((plugin(), ARM), "unknown"),
        (
            (
                plugin(),
                ARM.replace(
                    "<axis", '<limit lower="0" upper="0" effort="1" velocity="1"/><axis'
                ).replace("continuous", "revolute"),
            ),
            "good",
        ),
        ((plugin(), OTHER.format("libBoatDynamics.so")), "unknown"),
        ((plugin(separation=0.1),), "unknown"),
        ((), "unknown"),
    ],
    ids=["all", "arm", "locked", "own", "failed", "alone"],
)
def test_an_unsupported_plugin_is_only_a_note_if_everything_is_moved_as_commanded(
    tmp_path, parts, outcome
):
    path = written(tmp_path, cart(), NAMING, *parts)
    verdict = try_robot(path, standing=1.0)
    assert verdict.missing[0] == "motor_stream"
    assert verdict.outcome == outcome


BUILT = """cmake_minimum_required(VERSION 3.5)
project(own)
set(FILES src/thing.cc)  # The source.
add_library(${PROJECT_NAME}_thing SHARED ${FILES})
"""


def in_package(folder, source: str) -> None:
    """Writes a package that builds the plugin ``libown_thing.so`` from a source file."""
    (folder / "package.xml").write_text("<package><name>own</name></package>")
    (folder / "CMakeLists.txt").write_text(BUILT)
    (folder / "src").mkdir()
    (folder / "src" / "thing.cc").write_text('#include "own/thing.hh"\n' + source)
    (folder / "include" / "own").mkdir(parents=True)


@pytest.mark.parametrize(
    ("source", "moves"),
    [
        ("this->link->AddRelativeForce({0, 0, this->thrust});", True),
        ("joints[0]->SetVelocity (0, speed);", True),
        ("wheel->SetPosition(0, angle);", True),
        ("_ecm.Component<components::JointForceCmd>(wheel);", True),
        ("// this->link->AddRelativeForce(thrust);\npublisher->publish(pose);", False),
        ("wheel->SetVelocityLimit(0, 5); link->WorldPose();", False),
    ],
    ids=["force", "velocity", "position", "component", "comment", "reading"],
)
def test_a_plugin_whose_source_applies_forces_may_be_what_moves_a_model(tmp_path, source, moves):
    """Neither its name nor its tags say it, and the model has no joints."""
    in_package(tmp_path, f"void Thing::OnUpdate() {{ {source}\n}}")
    box = cart().split('<link name="left">', 1)[0]
    verdict = try_robot(written(tmp_path, box, OTHER.format("libown_thing.so")), standing=1.0)
    assert [each.code for each in verdict.faults] == [PLUGIN_UNKNOWN] * moves
    assert verdict.outcome == ("unknown" if moves else "good")
    assert verdict.should_move == moves


def test_the_headers_of_a_plugin_are_part_of_its_source(tmp_path):
    in_package(tmp_path, "")
    header = tmp_path / "include" / "own" / "thing.hh"
    header.write_text("void Push() { this->model->SetLinearVel(speed); }")
    box = cart().split('<link name="left">', 1)[0]
    path = written(tmp_path, box, OTHER.format("libown_thing.so"))
    assert try_robot(path, standing=1.0).outcome == "unknown"
    header.write_text("")
    assert try_robot(path, standing=1.0).good


def test_a_plugin_whose_source_applies_forces_is_no_fault_if_a_drive_moves_the_robot(tmp_path):
    """It may brake the robot, although nothing drives a hatch of the robot."""
    in_package(tmp_path, "void Thing::OnUpdate() { link->AddForce(drag); }")
    hatch = (
        '<link name="hatch"><inertial><mass value="0.1"/><inertia ixx="1e-4" iyy="1e-4" izz="1e-4"'
        " "
        'ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="hinge" type="revolute">'
        '<parent link="base"/><child '
        'link="hatch"/><limit lower="-1" upper="1" effort="5" velocity="2"/></joint>'
    )
    path = written(tmp_path, cart(), hatch, plugin(), OTHER.format("libown_thing.so"))
    verdict = try_robot(path, standing=1.0)
    assert verdict.good
    assert verdict.missing == ("own_thing",)
