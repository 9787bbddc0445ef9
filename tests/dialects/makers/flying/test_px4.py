"""``libgazebo_mavlink_interface.so``: its tags, and the commands of its channels."""

import pytest
from tests.coded import coded, raises
from tests.devices.autopilots.px4_client import Client, controls, heartbeat
from tests.reserved import free_port

from cartwheel.codes import devices, wires
from cartwheel.errors import PluginError

STEP = 0.004


def channel(tags="", kind="velocity", index=1, joint="<joint_name>pivot</joint_name>"):
    return f"""<channel name="c"><input_index>{index}</input_index>
      <joint_control_type>{kind}</joint_control_type>{joint}{tags}</channel>"""


def spawn(make, channels, port=None, tags="<use_tcp>1</use_tcp>"):
    """A beam on a pivot, which a channel drives."""
    world = make.world(step=STEP, gravity=0.0)
    world.session.spawn(
        make.sdf(f"""<model name="beam"><link name="base"><inertial><mass>100</mass></inertial>
      </link><link name="arm"><inertial><mass>1</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy>
      <izz>0.1</izz></inertia></inertial></link>
      <joint name="anchor" type="fixed"><parent>world</parent><child>base</child></joint>
      <joint name="pivot" type="revolute"><parent>base</parent><child>arm</child>
      <axis><xyz>0 0 1</xyz></axis></joint>
      <plugin name="px4" filename="libgazebo_mavlink_interface.so"><robotNamespace/>
      <mavlink_tcp_port>{port or free_port()}</mavlink_tcp_port>{tags}
      <enable_lockstep>1</enable_lockstep><control_channels>{channels}</control_channels></plugin>
      </model>""")
    )
    return world


def fly(make, channels, output, seconds, *, armed=True):
    """Runs with an output on channel 1, and returns the world and the beam's joint."""
    port = free_port()
    world = spawn(make, channels, port)
    world.run(STEP)
    client = Client(port)
    client.send(heartbeat())
    while not coded(world, wires.AUTOPILOT_CONNECTED):
        world.run(STEP)
    for number in range(round(seconds / STEP)):
        client.send(controls(number, [0.0, output], armed=armed))
        world.run(STEP)
    client.close()
    return world, world.session.simulation.data.joint("beam::pivot")


PID = """<joint_control_pid><p>20</p><i>0</i><d>3</d><cmdMax>100</cmdMax><cmdMin>-100</cmdMin>
  {}</joint_control_pid>"""
SCALED = "<input_offset>0.5</input_offset><input_scaling>2</input_scaling>"


def test_an_output_is_a_velocity(make):
    tags = SCALED + "<zero_position_armed>-1</zero_position_armed>" + PID.format("")
    _, joint = fly(make, channel(tags), 0.25, 0.4)
    # (0.25 + 0.5) * 2 - 1
    assert joint.qvel[0] == pytest.approx(0.5, abs=1e-3)


def test_an_output_is_a_position(make):
    _, joint = fly(make, channel(SCALED + PID.format(""), "position"), -0.25, 2.0)
    assert joint.qpos[0] == pytest.approx(0.5, abs=0.01)


def test_a_position_error_is_limited(make):
    tags = SCALED + PID.format("<errMax>0.01</errMax>")
    _, joint = fly(make, channel(tags, "position"), -0.25, 2.0)
    # 20 N m/rad times 0.01 rad turn it at most at 0.2 / 3 rad/s.
    assert 0.05 < joint.qpos[0] < 0.134


def test_a_kinematic_position_is_reached_without_gains(make):
    _, joint = fly(make, channel(SCALED, "position_kinematic"), -0.25, 1.0)
    assert joint.qpos[0] == pytest.approx(0.5, abs=1e-3)


def test_a_disarmed_channel_has_its_own_command(make):
    tags = SCALED + "<zero_position_disarmed>-0.3</zero_position_disarmed>" + PID.format("")
    _, joint = fly(make, channel(tags, "position"), 0.25, 2.0, armed=False)
    assert joint.qpos[0] == pytest.approx(-0.3, abs=0.01)


def test_a_command_is_published(make):
    port = free_port()
    world = spawn(make, channel(SCALED, "position_gztopic", joint="<gztopic>/tilt</gztopic>"), port)
    box = world.mailbox("/beam/tilt")
    world.run(STEP)
    client = Client(port)
    client.send(heartbeat() + controls(1, [0.0, 0.25]))
    while not (messages := box.drain()):
        world.run(STEP)
    client.close()
    assert messages[0].data == 1.5


def test_channels_of_absent_joints_are_noted(make):
    world = spawn(make, channel(joint="<joint_name>wing::flap</joint_name>"))
    (note,) = coded(world, devices.PLUGIN_JOINT_UNKNOWN, joint="wing::flap")
    assert note.severity == "info"


@pytest.mark.parametrize(
    ("tags", "parameter"),
    [
        ("", "use_tcp"),
        ("<use_tcp>0</use_tcp>", "use_tcp"),
        ("<use_tcp>1</use_tcp><serialEnabled>1</serialEnabled>", "serialEnabled"),
        ("<use_tcp>1</use_tcp><hil_mode>1</hil_mode>", "hil_mode"),
        ("<use_tcp>1</use_tcp><mavlink_addr>0.0.0.0</mavlink_addr>", "mavlink_addr"),
    ],
)
def test_other_connections_are_reported(make, tags, parameter):
    world = spawn(make, channel(), tags=tags)
    assert coded(world, devices.PLUGIN_PARAMETER_UNSUPPORTED, parameter=parameter)


@pytest.mark.parametrize("address", ["127.0.0.1", "localhost", "INADDR_ANY"])
def test_addresses_of_this_computer_are_not_reported(make, address):
    tags = f"<use_tcp>1</use_tcp><mavlink_addr>{address}</mavlink_addr>"
    world = spawn(make, channel(), tags=tags)
    assert not coded(world, devices.PLUGIN_PARAMETER_UNSUPPORTED)


@pytest.mark.parametrize(
    ("channels", "parameter"),
    [
        (channel(kind="speed"), "joint_control_type"),
        (channel(index=16), "input_index"),
        (channel(index=-1), "input_index"),
        (channel() + channel(), "input_index"),
        (channel("<input_scaling>fast</input_scaling>"), "input_scaling"),
    ],
)
def test_wrong_tags_are_errors(make, channels, parameter):
    with raises(devices.PLUGIN_PARAMETER_INVALID, PluginError, parameter=parameter):
        spawn(make, channels)


@pytest.mark.parametrize("port", ["0", "65536", "-4560"])
def test_ports_have_a_range(make, port):
    with raises(devices.PLUGIN_PARAMETER_INVALID, PluginError, parameter="mavlink_tcp_port"):
        spawn(make, channel(), port)


def test_a_plugin_without_channels_is_reported(make):
    assert coded(spawn(make, ""), devices.PLUGIN_IDLE)
