"""Plugins of worlds: none is passed over in silence."""

import pytest

from cartwheel.checks.checking import check
from cartwheel.codes import devices, running
from cartwheel.description import load_text
from cartwheel.dialects import registry
from cartwheel.errors import CartwheelError
from cartwheel.session import Session


def reported(filename):
    text = (
        f'<sdf version="1.6"><world name="w"><plugin name="p" filename="{filename}"/></world></sdf>'
    )
    session = Session(load_text(text, file="w.world"))
    found = [d for d in session.diagnostics if d.severity == "warning"]
    session.close()
    return found


@pytest.mark.parametrize(
    ("filename", "code"),
    [
        ("libSimEventsPlugin.so", devices.PLUGIN_UNKNOWN),
        ("libgazebo_ros_diff_drive.so", devices.PLUGIN_MISPLACED),
    ],
)
def test_a_plugin_that_does_nothing_is_reported(filename, code):
    (found,) = reported(filename)
    assert found.code is code
    assert found.values["name"] == filename
    assert bool(found.hint) == (code is devices.PLUGIN_UNKNOWN)
    assert found.origin.line == 1


@pytest.mark.parametrize(
    "filename",
    [
        "gz-sim-physics-system",
        "ignition-gazebo-user-commands-system",
        "libgazebo_ros_state.so",
        "gz-sim-sensors-system",
        "librotors_gazebo_ros_interface_plugin.so",
    ],
)
def test_what_is_built_in_is_not(filename):
    assert not reported(filename)


@pytest.mark.parametrize("place", ["world", "model"])
@pytest.mark.parametrize(
    ("name", "refused"),
    [
        ("gazebo_ros_init", {"world": "server", "model": "server"}),
        ("gazebo_ros_force_system", {"world": "server", "model": "server"}),
        ("gazebo_ros_state", {"model": "world"}),
        ("rotors_gazebo_ros_interface_plugin", {"model": "world"}),
        ("gz-sim-physics-system", {}),
    ],
)
def test_gazebo_loads_system_and_world_plugins_only_in_their_places(tmp_path, name, refused, place):
    plugin = f'<plugin name="p" filename="lib{name}.so"/>'
    inside = plugin if place == "world" else f'<model name="m"><link name="l"/>{plugin}</model>'
    path = tmp_path / "w.world"
    path.write_text(f'<sdf version="1.6"><world name="w">{inside}</world></sdf>')
    session = Session(load_text(path.read_text(), file=str(path)))
    session.close()
    wanted = [refused[place]] if place in refused else []
    for found in (session.diagnostics, check(path).findings):
        places = [each.values["place"] for each in found if each.code is devices.PLUGIN_MISPLACED]
        assert places == wanted


@pytest.mark.parametrize(
    ("name", "meant"), [("p", ""), ("gazebo_ros_diff_drive", "libgazebo_ros_diff_drive.so")]
)
def test_the_name_of_a_refused_plugin_says_which_is_meant(name, meant):
    plugin = f'<plugin name="{name}" filename="libgazebo_ros_factory.so"/>'
    model = f'<model name="m"><link name="l"/>{plugin}</model>'
    session = Session(load_text(f'<sdf version="1.6"><world name="w">{model}</world></sdf>'))
    (found,) = [each for each in session.diagnostics if each.code is devices.PLUGIN_MISPLACED]
    session.close()
    assert found.values["meant"] == meant


@pytest.mark.parametrize("place", ["world", "model"])
@pytest.mark.parametrize(
    "name",
    ["LinkPlot3DPlugin", "KeysToCmdVelPlugin", "roboticsgroup_gazebo_disable_link_plugin"],
)
def test_a_plugin_without_effect_is_a_note(name, place):
    plugin = f'<plugin name="p" filename="lib{name}.so"/>'
    inside = plugin if place == "world" else f'<model name="m"><link name="l"/>{plugin}</model>'
    session = Session(load_text(f'<sdf version="1.6"><world name="w">{inside}</world></sdf>'))
    (found,) = [d for d in session.diagnostics if d.code is devices.PLUGIN_UNKNOWN]
    session.close()
    assert found.severity == "info"


WORLD = """<sdf version="1.9"><world name="w"><model name="cart">
  <link name="a"/><link name="b"/>
  <joint name="left" type="continuous"><parent>a</parent><child>b</child>
  <axis><xyz>0 1 0</xyz></axis></joint>
  {}</model></world></sdf>"""
DRIVE = """<plugin name="p" filename="gz-sim-diff-drive-system"><left_joint>left</left_joint>
  <right_joint>right</right_joint></plugin>"""


def test_a_plugin_that_cannot_be_made_costs_a_world_the_plugin():
    states = '<plugin name="s" filename="gz-sim-joint-state-publisher-system"/>'
    session = Session(load_text(WORLD.format(DRIVE + states), file="w.world"))
    (reported,) = [each for each in session.diagnostics if each.severity == "error"]
    assert reported.code is running.PLUGIN_LEFT_OUT
    assert reported.values["plugin"] == "gz-sim-diff-drive-system"
    assert reported.values["cause"] == devices.PLUGIN_JOINT_UNKNOWN.number
    topics = {topic.name for topic in session.graph.topics()}
    assert any("joint_state" in name for name in topics)
    assert not any("cmd_vel" in name for name in topics)
    assert session.simulation.model.nu == 0
    session.close()


def test_a_plugin_that_cannot_be_made_refuses_a_robot():
    text = WORLD.format(DRIVE).replace('<world name="w">', "").replace("</world>", "")
    session = Session(load_text('<sdf version="1.6"><world name="w"/></sdf>', file="w.world"))
    with pytest.raises(CartwheelError) as caught:
        session.spawn(load_text(text, file="r.sdf"))
    assert caught.value.values["name"] == "right"
    session.close()


@pytest.mark.parametrize("name", ["gz-sim-diff-drive-system", "libgazebo_ros_diff_drive.so"])
def test_a_static_model_has_nothing_to_drive(name):
    drive = f"""<static>1</static><plugin name="p" filename="{name}"><left_joint>left</left_joint>
      <right_joint>left</right_joint></plugin>"""
    session = Session(load_text(WORLD.format(drive), file="w.world"))
    (reported,) = [each for each in session.diagnostics if each.severity == "error"]
    assert reported.values["cause"] == running.STATIC_MODEL_DRIVEN.number
    session.close()


def test_names_that_ros_does_not_know_make_topics_that_it_does():
    states = '<plugin name="s" filename="gz-sim-joint-state-publisher-system"/>'
    text = WORLD.format(states).replace('name="cart"', 'name="3-wheeled cart"')
    session = Session(load_text(text, file="w.world"))
    topics = [topic.name for topic in session.graph.topics()]
    assert "/world/w/model/_3_wheeled_cart/joint_state" in topics
    session.close()


def test_a_sensor_that_lacks_something_costs_the_sensor():
    sensor = """<link name="c"><sensor name="nose" type="air_pressure"><air_pressure>
      <reference_altitude>low</reference_altitude></air_pressure></sensor></link>"""
    session = Session(load_text(WORLD.format(sensor), file="w.world"))
    (reported,) = [each for each in session.diagnostics if each.severity == "error"]
    assert reported.code is running.PLUGIN_LEFT_OUT
    assert reported.values["plugin"] == "nose"
    assert reported.values["cause"] == devices.PLUGIN_PARAMETER_INVALID.number
    session.close()


def test_a_nested_model_s_plugin_knows_its_own_joints():
    text = """<sdf version="1.9"><world name="w"><model name="outer"><link name="base"/>
      <model name="inner"><link name="a"/><link name="b"/>
      <joint name="j" type="revolute"><parent>a</parent><child>b</child>
      <axis><xyz>0 1 0</xyz></axis></joint>
      <plugin name="s" filename="gz-sim-joint-state-publisher-system">
      <joint_name>j</joint_name></plugin></model></model></world></sdf>"""
    session = Session(load_text(text, file="w.world"))
    assert [each for each in session.diagnostics if each.severity == "error"] == []
    session.close()


def test_a_plugin_that_names_what_is_not_there_costs_itself_where_that_is_wanted():
    text = WORLD.format(DRIVE).replace('<world name="w">', "").replace("</world>", "")
    empty = load_text('<sdf version="1.6"><world name="w"/></sdf>', file="w.world")
    session = Session(empty, lenient=True)
    session.spawn(load_text(text, file="r.sdf"))
    (reported,) = [each for each in session.diagnostics if each.severity == "error"]
    assert reported.code is running.PLUGIN_LEFT_OUT
    assert reported.values["cause"] == devices.PLUGIN_JOINT_UNKNOWN.number
    assert reported.origin is not None
    session.close()


def test_models_without_plugins_are_not_looked_for_in_their_world(monkeypatch):
    """Each search takes the more time the more models the world has."""
    searches = []
    original = registry._is_of_world

    def counted(part):
        searches.append(part.name)
        return original(part)

    monkeypatch.setattr(registry, "_is_of_world", counted)
    system = '<plugin filename="gz-sim-joint-state-publisher-system" name="p"/>'
    models = "".join(
        f'<model name="m{number}"><link name="l"/>{system if number == 7 else ""}</model>'
        for number in range(20)
    )
    Session(load_text(f'<sdf version="1.6"><world name="w">{models}</world></sdf>')).close()
    assert searches == ["m7"]
