"""PX4: a client of its protocol flies a quadcopter in lock step."""

import contextlib
import math

import numpy as np
import pytest
from tests.devices.autopilots.px4_client import (
    HOME,
    IDLE,
    Client,
    Pilot,
    controls,
    fields,
    heartbeat,
)
from tests.devices.autopilots.quadcopter import (
    FASTEST,
    SENSES,
    K,
    check_flight,
    check_loss,
    position,
    quadcopter,
    reported,
)
from tests.reserved import free_port

from cartwheel.codes import devices, wires
from cartwheel.devices.autopilots import mavlink
from cartwheel.geometry import Pose

STEP = 0.004
NOISELESS = "".join(
    f"<{sensor}{kind}>0</{sensor}{kind}>"
    for sensor in ("gyroscope", "accelerometer")
    for kind in ("NoiseDensity", "RandomWalk", "TurnOnBiasSigma")
)
GPS = """<sensor name="gps" type="gps"><plugin name="gps_plugin" filename="libgazebo_gps_plugin.so">
  <robotNamespace/></plugin></sensor>"""


def motors():
    return "".join(
        f"""<plugin name="motor_{n}" filename="libgazebo_motor_model.so"><robotNamespace/>
        <jointName>rotor_{n}_joint</jointName><linkName>rotor_{n}</linkName>
        <turningDirection>{"ccw" if sense > 0 else "cw"}</turningDirection>
        <motorConstant>{K}</motorConstant><momentConstant>0.016</momentConstant>
        <maxRotVelocity>{FASTEST}</maxRotVelocity><motorNumber>{n}</motorNumber></plugin>"""
        for n, sense in enumerate(SENSES)
    )


def interface(port, tags="", lock_step=1):
    channels = "".join(
        f"""<channel name="rotor{n}"><input_index>{n}</input_index><input_offset>0</input_offset>
        <input_scaling>{FASTEST - IDLE}</input_scaling><zero_position_armed>{IDLE}
        </zero_position_armed><joint_control_type>velocity</joint_control_type></channel>"""
        for n in range(4)
    )
    return f"""<plugin name="px4" filename="libgazebo_mavlink_interface.so"><robotNamespace/>
      <mavlink_addr>INADDR_ANY</mavlink_addr><mavlink_tcp_port>{port}</mavlink_tcp_port>
      <use_tcp>1</use_tcp><enable_lockstep>{lock_step}</enable_lockstep>{tags}
      <control_channels>{channels}</control_channels></plugin>"""


def sensors(noise=NOISELESS):
    return f"""<plugin name="truth" filename="libgazebo_groundtruth_plugin.so"/>
      <plugin name="mag" filename="libgazebo_magnetometer_plugin.so"><noiseDensity>0</noiseDensity>
      <randomWalk>0</randomWalk></plugin>
      <plugin name="baro" filename="libgazebo_barometer_plugin.so"/>
      <plugin name="imu" filename="libgazebo_imu_plugin.so"><linkName>body</linkName>{noise}
      </plugin>"""


def drone(make, port, *, noise=NOISELESS, **options):
    return quadcopter(make, interface(port, **options) + motors() + sensors(noise), GPS)


@contextlib.contextmanager
def flight(make, **options):
    """A quadcopter that a pilot controls, from the second step on. It faces east."""
    port = free_port()
    world = make.world(step=STEP)
    world.session.spawn(drone(make, port, **options))
    world.run(STEP)
    pilot = Pilot(port)
    pilot.start()
    connect(world)
    try:
        yield world, pilot
    finally:
        pilot.stop()


def connect(world, times=1):
    """Runs until an autopilot has connected."""
    while len(reported(world, wires.AUTOPILOT_CONNECTED)) < times:
        assert world.time < 60.0
        world.run(STEP)


@pytest.mark.parametrize("noise", [NOISELESS, ""], ids=["noiseless", "noisy"])
def test_a_quadcopter_takes_off_hovers_and_lands(make, noise):
    with flight(make, noise=noise) as (world, pilot):
        start = world.time
        check_flight(world)
        # One state for each step, except for the last one, which the pilot may not have read.
        assert len(pilot.motions) == pytest.approx((world.time - start) / STEP, abs=2)
    assert not reported(world, wires.AUTOPILOT_LOST)
    (connected,) = reported(world, wires.AUTOPILOT_CONNECTED)
    assert connected.severity == "info"
    assert pilot.numbers == {
        mavlink.HEARTBEAT, mavlink.SYSTEM_TIME, mavlink.SENSOR, mavlink.GPS, mavlink.STATE
    }  # fmt: skip


def test_two_flights_in_lock_step_are_equal(make):
    places = []
    for _ in range(2):
        port = free_port()
        world = make.world(step=STEP)
        world.session.spawn(drone(make, port, noise=""))
        world.run(STEP)
        client = Client(port)
        client.send(heartbeat())
        connect(world)
        begin = world.time
        for number in range(200):
            client.send(controls(number, [0.8, 0.8, 0.8, 0.8]))
            world.run(STEP)
        places.append((position(world) - 0.0).tolist())
        client.close()
        assert world.time == pytest.approx(begin + 200 * STEP)
    assert places[0][2] > 0.3
    assert places[0] == places[1]


def test_measurements_have_axes_forward_right_down(make):
    with flight(make) as (world, pilot):
        world.run(6.0)
    sensor, motion = pilot.sensors[-1], pilot.motions[-1]
    # Hovering: the proper acceleration is upward, and down is positive.
    assert sensor[1:4] == pytest.approx([0.0, 0.0, -9.8], abs=0.3)
    # The vehicle faces along the x axis, which is east.
    assert np.abs(motion.quaternion) == pytest.approx([0.5**0.5, 0, 0, 0.5**0.5], abs=0.02)
    (height,) = {round(each[3] * 1e-3 - HOME[2], 0) for each in pilot.fixes[-3:]}
    assert height == 2.0
    fix = pilot.fixes[-1]
    assert fix[1] * 1e-7 == pytest.approx(HOME[0], abs=1e-5)
    assert fix[2] * 1e-7 == pytest.approx(HOME[1], abs=1e-5)
    assert fix[11] == 3
    # In Zurich, the field has 0.48 Gauss, points 63 degrees down and 3 degrees east of north; north
    # is on the left.
    field = np.array(next(each for each in reversed(pilot.sensors) if each[14] & 0x1C0)[7:10])
    assert np.linalg.norm(field) == pytest.approx(0.48, abs=0.005)
    assert math.degrees(math.asin(field[2] / np.linalg.norm(field))) == pytest.approx(63, abs=1.5)
    assert field[1] < -0.2
    pressure = next(each for each in reversed(pilot.sensors) if each[14] & 0x200)
    # 490 m above sea level in the International Standard Atmosphere.
    assert pressure[10] == pytest.approx(955.8, abs=0.2)
    assert pressure[12] == pytest.approx(490.0, abs=1.5)
    assert pressure[13] == pytest.approx(11.8, abs=0.1)


def test_positions_arrive_with_the_delay_of_the_receiver(make):
    port = free_port()
    world = make.world(step=STEP)
    world.session.spawn(drone(make, port))
    world.run(STEP)
    client = Client(port)
    client.send(heartbeat())
    connect(world)
    world.run(1.0)
    now, ages = None, []
    client.socket.settimeout(0.2)
    while (frame := client.receive()) is not None:
        if frame.number == mavlink.SENSOR:
            now = fields(frame)[0]
        elif frame.number == mavlink.GPS:
            ages.append(now - fields(frame)[0])
    client.close()
    assert len(ages) in (4, 5)
    assert set(ages) == {120_000}


def test_motors_stand_still_while_disarmed(make):
    port = free_port()
    world = make.world(step=STEP)
    world.session.spawn(drone(make, port))
    box = world.mailbox("/drone/gazebo/command/motor_speed")
    world.run(STEP)
    client = Client(port)
    client.send(heartbeat())
    connect(world)
    for armed in (False, True):
        client.send(controls(1, [0.5, math.nan, 9.0], armed=armed))
        world.run(STEP)
    client.close()
    disarmed, armed = [message.angular_velocities.tolist() for message in box.drain()]
    assert disarmed == [0.0] * 16
    # Not a number switches a motor off; outputs are at most 1.
    assert armed[:4] == [IDLE + 0.5 * (FASTEST - IDLE), 0.0, FASTEST, IDLE]


def test_a_closed_connection_stops_the_motors(make):
    with flight(make) as (world, pilot):
        world.run(4.0)
        assert position(world)[2] > 1.5
        port = pilot.client.socket.getpeername()[1]
    check_loss(world)
    client = Client(port)
    client.send(heartbeat())
    connect(world, times=2)
    client.close()


def test_a_silent_autopilot_is_lost(make):
    port = free_port()
    world = make.world(step=STEP)
    world.session.spawn(drone(make, port))
    world.run(STEP)
    client = Client(port)
    client.send(heartbeat() + controls(1, [1.0] * 4))
    connect(world)
    # One wait of 0.1 s, and then waits of 10 ms until 1 s has passed.
    world.run(90 * STEP)
    assert not reported(world, wires.AUTOPILOT_LOST)
    world.run(4 * STEP)
    assert reported(world, wires.AUTOPILOT_LOST)
    client.close()


def test_another_program_cannot_take_the_vehicle_over(make):
    with flight(make) as (world, pilot):
        world.run(3.0)
        port = pilot.client.socket.getpeername()[1]
        intruder = Client(port)
        with contextlib.suppress(OSError):
            intruder.send(controls(0, [0.0] * 4, armed=False))
        world.run(2.0)
        assert position(world)[2] > 1.5
        assert intruder.receive() is None
        intruder.close()
    (ignored,) = reported(world, wires.AUTOPILOT_PACKET_IGNORED)
    assert ignored.values["reason"] == "sender"


def test_a_program_that_sends_no_frame_makes_way(make):
    port = free_port()
    world = make.world(step=STEP)
    world.session.spawn(drone(make, port))
    world.run(STEP)
    idle, noise = Client(port), Client(port)
    noise.send(b"GET / HTTP/1.1\r\n\r\n" * 200)
    world.run(10 * STEP)
    assert not reported(world, wires.AUTOPILOT_CONNECTED)
    (ignored,) = reported(world, wires.AUTOPILOT_PACKET_IGNORED)
    assert ignored.values["reason"] == "frame"
    client = Client(port)
    client.send(heartbeat())
    connect(world)
    for each in (idle, noise, client):
        each.close()


def test_two_vehicles_cannot_use_one_port(make):
    world = make.world(step=STEP)
    port = free_port()
    for y in (0.0, 2.0):
        world.session.spawn(drone(make, port), name=f"drone{y:g}", pose=Pose((0.0, y, 0.0)))
    world.run(STEP)
    (taken,) = reported(world, wires.ADDRESS_UNAVAILABLE)
    assert taken.values == {"host": "127.0.0.1", "port": port}


def test_two_vehicles_fly_on_two_ports(make):
    world = make.world(step=STEP)
    ports = [free_port(), free_port()]
    for y, port in zip((0.0, 3.0), ports, strict=True):
        world.session.spawn(drone(make, port), name=f"drone{y:g}", pose=Pose((0.0, y, 0.0)))
    world.run(STEP)
    clients = [Client(port) for port in ports]
    for client in clients:
        client.send(heartbeat())
    connect(world, times=2)
    for number in range(100):
        for client, output in zip(clients, (0.8, 0.0), strict=True):
            client.send(controls(number, [output] * 4))
        world.run(STEP)
    heights = [world.session.simulation.data.joint(f"drone{y}::body").qpos[2] for y in (0, 3)]
    for client in clients:
        client.close()
    assert heights[0] > 0.1
    assert heights[1] == pytest.approx(0.05, abs=0.01)


def test_a_long_time_step_is_reported(make):
    world = make.world(step=0.005)
    world.session.spawn(drone(make, free_port()))
    world.run(0.005)
    (slow,) = reported(world, devices.RATE_ABOVE_PHYSICS)
    assert slow.values == {"rate": 250.0, "physics": 200.0}
