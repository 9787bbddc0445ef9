"""Robots that are written in worlds."""

from tests.devices.drives.carts import cart_sdf
from tests.dialects.ros_control.arms import ros2_joint, ros2_system

from cartwheel.codes.robot import WHEEL_SEPARATION_MISMATCH
from cartwheel.corpus import survey, try_robot

TWO = {"left": (0.0, 0.15), "right": (0.0, -0.15)}
PLUGIN = """<plugin name="drive" filename="{file}"><topic>/{name}/cmd_vel</topic>
  <left_joint>left_joint</left_joint><right_joint>right_joint</right_joint>
  <wheel_separation>{apart}</wheel_separation><wheel_radius>0.1</wheel_radius></plugin>"""
CRATE = '<model name="crate"><link name="l"/><plugin name="p" filename="{}"/></model>'

CONTROLLERS = """
controller_manager:
  ros__parameters:
    drive: {type: diff_drive_controller/DiffDriveController}
drive:
  ros__parameters:
    {left_wheel_names: [left_joint], right_wheel_names: [right_joint],
     wheel_separation: 0.5, wheel_radius: 0.1}
"""
LISTED = f"""<robot name="cart"><link name="base"/>
  {ros2_system(*(ros2_joint(f"{side}_joint", "velocity") for side in ("left", "right")))}
  <link name="left"/><link name="right"/>
  <joint name="left_joint" type="continuous"><parent link="base"/><child link="left"/></joint>
  <joint name="right_joint" type="continuous"><parent link="base"/><child link="right"/></joint>
</robot>"""


def cart(name, *, apart=0.3, file="gz-sim-diff-drive-system", static=False):
    """A model with its own pose in the world."""
    text = cart_sdf(
        TWO,
        PLUGIN.format(name=name, apart=apart, file=file),
        balls=((0.15, 0.0), (-0.15, 0.0)),
    )
    model = text[text.index("<model") : text.rindex("</model>") + len("</model>")]
    start = model.index(">") + 1
    tag = "<static>1</static>" if static else ""
    return f'<model name="{name}"><pose>3 2 0 0 0 1</pose>{tag}{model[start:]}'


def world(folder, *models, name="yard.sdf"):
    file = folder / name
    file.parent.mkdir(parents=True, exist_ok=True)
    text = "\n".join(models)
    file.write_text(f'<sdf version="1.9"><world name="yard">\n{text}\n</world></sdf>')
    return file


def test_models_that_plugins_move_are_found(tmp_path):
    world(
        tmp_path,
        cart("first"),
        cart("parked", static=True),
        CRATE.format("gz-sim-pose-publisher-system"),
        CRATE.format("libgazebo_ros_control.so").replace("crate", "arm"),
        cart("own", file="libOwnSystem.so"),
        cart("measured", file="libJointStatePublisher.so"),
        "<include><uri>model://cart</uri></include>",
        name="worlds/yard.world",
    )
    found = survey(tmp_path)
    file = tmp_path / "worlds" / "yard.world"
    assert found.robots == ()
    # An unsupported plugin that names joints, and does not only publish, moves them.
    assert found.in_worlds == ((file, "first"), (file, "arm"), (file, "own"))
    assert survey(file).in_worlds == found.in_worlds


def test_included_models_that_the_world_moves_are_robots(tmp_path):
    text = cart("bare").replace("<plugin", "<!--").replace("</plugin>", "-->")
    (tmp_path / "models/bare").mkdir(parents=True)
    (tmp_path / "models/bare/model.sdf").write_text(f'<sdf version="1.9">{text}</sdf>')
    plugin = PLUGIN.format(name="{name}", apart=0.2, file="gz-sim-diff-drive-system")
    include = "<include>{more}<uri>model://bare</uri>{plugin}</include>"
    file = world(
        tmp_path,
        include.format(more="<name>one</name>", plugin=plugin.format(name="one")),
        include.format(more="<pose>9 9 0 0 0 0</pose>", plugin=plugin.format(name="two")),
        include.format(more="<name>still</name><static>1</static>", plugin=plugin),
        include.format(more="<name>other</name>", plugin=""),
        name="worlds/yard.sdf",
    )
    found = survey(tmp_path, package_path=[tmp_path / "models"])
    assert found.in_worlds == ((file, "one"), (file, "bare"))
    verdict = try_robot(file, model="one", package_path=[tmp_path / "models"])
    (drive,) = verdict.drives
    assert drive.topic == "/one/cmd_vel"
    assert WHEEL_SEPARATION_MISMATCH in {each.reason.code for each in verdict.faults if each.reason}


def test_worlds_without_robots_and_unreadable_files_have_none(tmp_path):
    world(tmp_path, CRATE.format("gz-sim-pose-publisher-system"))
    (tmp_path / "torn.sdf").write_text('<sdf><world name="w"><model name="m"><plugin')
    (tmp_path / "cart.sdf").write_text(f'<sdf version="1.9">{cart("alone")}</sdf>')
    found = survey(tmp_path)
    assert found.in_worlds == ()
    assert tmp_path / "cart.sdf" in found.robots


def test_a_model_with_a_parameter_named_world_is_no_world(tmp_path):
    file = tmp_path / "cart.sdf"
    text = cart("alone").replace("</plugin>", "<world>yard</world></plugin>", 1)
    file.write_text(f'<sdf version="1.9">{text}</sdf>')
    assert survey(file).robots == survey(tmp_path).robots == (file,)


def test_each_model_is_tested_alone_and_with_its_own_findings(tmp_path):
    file = world(tmp_path, cart("good"), cart("wide", apart=0.5), cart("last"))
    for name in ("good", "wide", "last"):
        verdict = try_robot(file, model=name, standing=1.0)
        assert (verdict.file, verdict.model, verdict.name) == (file, name, name)
        (drive,) = verdict.drives
        assert drive.topic == f"/{name}/cmd_vel"
        assert verdict.good == (name != "wide"), verdict.faults
        codes = [fault.code for fault in verdict.faults]
        assert codes == [WHEEL_SEPARATION_MISMATCH] * (name == "wide")
        lines = {fault.reason.origin.line for fault in verdict.faults}
        text = file.read_text()
        assert all(text[: text.index('"last"')].count("\n") >= line for line in lines)


def test_an_unknown_model_is_a_fault(tmp_path):
    verdict = try_robot(world(tmp_path, cart("good")), model="god")
    assert not verdict.loaded
    (fault,) = verdict.faults
    assert fault.test == "load"
    assert fault.reason.values["meant"] == "good"


def test_a_finding_in_the_controller_file_of_a_model_explains_its_failure(tmp_path):
    """The controller file is stated with the path of another computer."""
    (tmp_path / "package.xml").write_text("<package><name>yard</name></package>")
    (tmp_path / "config").mkdir()
    (tmp_path / "config/drive.yaml").write_text(CONTROLLERS)
    control = """<plugin name="c" filename="libgazebo_ros2_control.so"><parameters>
      /opt/me/ws/install/yard/share/yard/config/drive.yaml</parameters></plugin>"""
    text = cart("cart", file="none.so")
    start, end = text.index("<plugin"), text.index("</plugin>") + len("</plugin>")
    file = world(tmp_path, text[:start] + control + text[end:])
    (tmp_path / "cart.urdf").write_text(LISTED)
    verdict = try_robot(file, model="cart", standing=1.0)
    (fault,) = verdict.faults
    assert (fault.test, fault.code) == ("turn", WHEEL_SEPARATION_MISMATCH)
    assert fault.reason.origin.file == str(tmp_path / "config/drive.yaml")


def test_a_model_on_a_slope_is_tested_on_level_ground(tmp_path):
    """Its world, which a program saved, contains uneven ground."""
    state = """<state world_name="yard"><model name="cart"><pose>3 2 0.3 0.15 -0.2 1</pose></model>
      </state>"""
    verdict = try_robot(world(tmp_path, cart("cart"), state), model="cart", standing=2.0)
    assert verdict.good, verdict.faults
    assert verdict.stand.tilt < 0.01
