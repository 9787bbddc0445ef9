"""``ArduPilotPlugin``: its tags, and the commands of its channels."""

import pytest
from tests.coded import coded, raises
from tests.devices.autopilots.ardupilot_client import Client, servo_packet
from tests.reserved import free_port

from cartwheel.codes import devices
from cartwheel.errors import PluginError, UnknownNameError

STEP = 0.001


def spawn(make, tags, port=None, imu="imu"):
    """A beam on a pivot, which a channel drives."""
    world = make.world(step=STEP, gravity=0.0)
    world.session.spawn(
        make.sdf(f"""<model name="beam"><link name="base"><inertial><mass>100</mass></inertial>
      <sensor name="{imu}" type="imu"/></link>
      <link name="arm"><inertial><mass>1</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz>
      </inertia></inertial></link>
      <joint name="anchor" type="fixed"><parent>world</parent><child>base</child></joint>
      <joint name="pivot" type="revolute"><parent>base</parent><child>arm</child>
      <axis><xyz>0 0 1</xyz></axis></joint>
      <plugin name="ardupilot" filename="libArduPilotPlugin.so"><imuName>base::imu</imuName>
      <fdm_port_in>{port or 9002}</fdm_port_in><lock_step>1</lock_step>{tags}</plugin></model>""")
    )
    return world


def control(tags, kind="VELOCITY", attributes='channel="1"'):
    return f"""<control {attributes}><jointName>pivot</jointName><type>{kind}</type>{tags}
      </control>"""


def fly(make, tags, widths, seconds):
    """Runs with pulse widths on the first channels, and returns the world and the beam's joint."""
    port = free_port()
    world = spawn(make, tags, port)
    world.run(STEP)
    client = Client(port)
    for frame in range(round(seconds / STEP)):
        client.send(servo_packet(frame, widths))
        world.run(STEP)
        assert client.receive() is not None
    client.close()
    return world, world.session.simulation.data.joint("beam::pivot")


GAINS = "<p_gain>20</p_gain><d_gain>3</d_gain><cmd_max>100</cmd_max><cmd_min>-100</cmd_min>"


@pytest.mark.parametrize(
    ("tags", "width", "velocity"),
    [
        ("<multiplier>4</multiplier><offset>-0.5</offset>", 1750, 1.0),
        ("<multiplier>4</multiplier><offset>-0.5</offset>", 1250, -1.0),
        ("<multiplier>4</multiplier><servo_min>1100</servo_min><servo_max>1900</servo_max>",
         1300, 1.0),
        ("<multiplier>4</multiplier>", 3000, 4.0),
        ("<multiplier>4</multiplier>", 500, 0.0),
        ("<multiplier>4</multiplier><rotorVelocitySlowdownSim>2</rotorVelocitySlowdownSim>",
         1500, 1.0),
        ("<turningDirection>cw</turningDirection>", 2000, -1.0),
    ],
)  # fmt: skip
def test_a_pulse_width_is_a_velocity(make, tags, width, velocity):
    _, joint = fly(make, control(tags + GAINS), [0, width], 0.2)
    assert joint.qvel[0] == pytest.approx(velocity, abs=1e-3)


def test_a_pulse_width_is_a_velocity_without_a_controller(make):
    tags = control("<useForce>0</useForce><multiplier>2</multiplier>")
    _, joint = fly(make, tags, [0, 1500], 0.1)
    assert joint.qvel[0] == pytest.approx(1.0, abs=1e-3)


def test_a_pulse_width_is_a_position(make):
    _, joint = fly(make, control("<multiplier>1</multiplier>" + GAINS, "POSITION"), [0, 1500], 2.0)
    assert joint.qpos[0] == pytest.approx(0.5, abs=0.01)


def test_a_pulse_width_is_a_torque(make):
    _, joint = fly(make, control("<multiplier>0.2</multiplier>", "EFFORT"), [0, 1500], 0.1)
    # 0.1 N m accelerate 0.1 kg m² at 1 rad/s².
    assert joint.qvel[0] == pytest.approx(0.1, rel=0.01)


def test_a_pulse_width_of_zero_drives_nothing(make):
    _, joint = fly(make, control("<offset>1</offset>" + GAINS), [0, 0], 0.1)
    assert joint.qvel[0] == 0.0


def test_a_command_is_published(make):
    port = free_port()
    tags = control("<multiplier>2</multiplier><cmd_topic>/tilt</cmd_topic>", "COMMAND")
    world = spawn(make, tags, port)
    box = world.mailbox("/tilt")
    world.run(STEP)
    client = Client(port)
    client.send(servo_packet(0, [0, 1500]))
    world.run(STEP)
    client.close()
    assert [message.data for message in box.drain()] == [1.0]


def test_channels_without_a_number_are_counted(make):
    tags = control("<multiplier>1</multiplier>" + GAINS, attributes="")
    _, joint = fly(make, tags, [1500], 0.1)
    assert joint.qvel[0] == pytest.approx(0.5, abs=1e-3)


@pytest.mark.parametrize("address", ["0.0.0.0", "192.168.1.5", "example.com", "::"])
def test_other_computers_cannot_connect(make, address):
    world = spawn(make, control("") + f"<fdm_addr>{address}</fdm_addr>")
    values = {"parameter": "fdm_addr", "value": address}
    assert coded(world, devices.PLUGIN_PARAMETER_UNSUPPORTED, **values)


@pytest.mark.parametrize("address", ["127.0.0.1", "127.0.0.2", "localhost", "::1"])
def test_loopback_addresses_are_127_0_0_1(make, address):
    world = spawn(make, control("") + f"<fdm_addr>{address}</fdm_addr>")
    assert not coded(world, devices.PLUGIN_PARAMETER_UNSUPPORTED)


@pytest.mark.parametrize(
    ("tags", "code", "parameter"),
    [
        (control("", "SPEED"), devices.PLUGIN_PARAMETER_INVALID, "type"),
        (control("", attributes='channel="32"'), devices.PLUGIN_PARAMETER_INVALID, "control"),
        (control("", attributes='channel="-1"'), devices.PLUGIN_PARAMETER_INVALID, "control"),
        (control("<servo_min>2000</servo_min>"), devices.PLUGIN_RANGE_REVERSED, "servo_min"),
        (control("<turningDirection>up</turningDirection>"),
         devices.PLUGIN_PARAMETER_INVALID, "turningDirection"),
        ("<control><type>EFFORT</type></control>", devices.PLUGIN_PARAMETER_MISSING, "jointName"),
        ("<gazeboXYZToNED>0 0 0</gazeboXYZToNED>",
         devices.PLUGIN_PARAMETER_INVALID, "gazeboXYZToNED"),
        ("<connectionTimeoutMaxCount>-1</connectionTimeoutMaxCount>",
         devices.PLUGIN_PARAMETER_INVALID, "connectionTimeoutMaxCount"),
        ("<sensor><index>7</index><topic>a</topic></sensor>",
         devices.PLUGIN_PARAMETER_INVALID, "index"),
        ("<sensor><index>2</index><topic>a</topic></sensor>",
         devices.PLUGIN_PARAMETER_MISSING, "sensor with the <index> 1"),
    ],
)  # fmt: skip
def test_invalid_tags_are_errors(make, tags, code, parameter):
    with raises(code, PluginError, parameter=parameter):
        spawn(make, tags)


@pytest.mark.parametrize("port", ["-1", "65536"])
def test_a_port_has_16_bits(make, port):
    with raises(devices.PLUGIN_PARAMETER_INVALID, PluginError, parameter="fdm_port_in"):
        spawn(make, "", port)


def test_the_imu_must_exist(make):
    with raises(devices.PLUGIN_PARAMETER_INVALID, UnknownNameError, name="base::imu"):
        spawn(make, control(""), imu="gyro")


def test_settings_without_an_effect_are_reported(make):
    world = spawn(
        make, control("<useForce>0</useForce>", "POSITION") + "<anemometer>a</anemometer>"
    )
    assert coded(world, devices.PLUGIN_PARAMETER_UNSUPPORTED, parameter="useForce")
    assert coded(world, devices.PLUGIN_PARAMETER_UNKNOWN, parameter="anemometer")


def test_a_plugin_without_channels_is_idle(make):
    assert coded(spawn(make, ""), devices.PLUGIN_IDLE)
