"""ArduPilot: a client of its protocols flies a quadcopter in lock step."""

import contextlib
import json
from pathlib import Path

import numpy as np
import pytest
from tests.devices.autopilots.ardupilot_client import Client, Pilot, servo_packet
from tests.devices.autopilots.quadcopter import (
    IMU,
    STEP,
    blades,
    check_flight,
    check_loss,
    controls,
    position,
    quadcopter,
    reported,
)
from tests.reserved import free_port

import cartwheel as cw
from cartwheel.codes import wires
from cartwheel.geometry import Pose

FILE = Path(__file__).parents[3] / "docs/how-to/files/sitl/quadcopter.sdf"


def plugin(port, tags=""):
    return f"""<plugin name="ardupilot" filename="ArduPilotPlugin">
      <fdm_port_in>{port}</fdm_port_in><lock_step>1</lock_step><imuName>imu</imuName>
      <gazeboXYZToNED degrees="true">0 0 0 180 0 90</gazeboXYZToNED>{controls()}{tags}</plugin>"""


@contextlib.contextmanager
def flight(make, **options):
    """A quadcopter that a pilot controls, from the second step on. It faces east."""
    port = free_port()
    world = make.world(step=STEP)
    world.session.spawn(quadcopter(make, blades() + plugin(port)))
    world.run(STEP)
    pilot = Pilot(port, **options)
    pilot.start()
    assert pilot.began.wait(timeout=30)
    try:
        yield world, pilot
    finally:
        pilot.stop()


def test_the_quadcopter_of_the_documentation_flies(make, tmp_path):
    port = free_port()
    text = FILE.read_text().replace(">9002<", f">{port}<").replace(">0.001<", f">{STEP}<")
    (tmp_path / "quadcopter.sdf").write_text(text)
    with contextlib.closing(cw.World(tmp_path / "quadcopter.sdf")) as world:
        world.run(STEP)
        pilot = Pilot(port)
        pilot.start()
        assert pilot.began.wait(timeout=30)
        world.run(4.0)
        pilot.stop()
        assert position(world) == pytest.approx([0.0, 0.0, 2.05], abs=0.2)


@pytest.mark.parametrize("binary", [False, True], ids=["json", "binary"])
def test_a_quadcopter_takes_off_hovers_and_lands(make, binary):
    with flight(make, binary=binary) as (world, pilot):
        start = world.time
        check_flight(world)
        # One state for each step, except for the last ones, which the pilot may not have read.
        assert len(pilot.motions) == pytest.approx((world.time - start) / STEP, abs=3)
    (connected,) = reported(world, wires.AUTOPILOT_CONNECTED)
    assert connected.severity == "info"
    assert not reported(world, wires.AUTOPILOT_LOST)


def test_states_have_axes_north_east_down(make):
    with flight(make) as (world, pilot):
        world.run(1.0)
        motion = pilot.motions[-1]
        height = position(world)[2] - 0.05
    assert motion.position == pytest.approx([0.0, 0.0, -height - 0.05], abs=0.02)
    # The vehicle faces along the x axis, which is east: it is turned by 90 degrees about down.
    assert np.abs(motion.quaternion) == pytest.approx([0.5**0.5, 0, 0, 0.5**0.5], abs=0.01)
    assert motion.velocity[2] < -0.2


def test_lost_packets_do_not_change_the_flight(make):
    places = []
    for lost in ((), (10, 200)):
        with flight(make, lost=lost) as (world, _):
            world.run(1.5)
            places.append(position(world).tolist())
    assert places[0] == places[1]
    assert places[0][2] > 0.2


def test_another_program_cannot_take_the_vehicle_over(make):
    with flight(make) as (world, pilot):
        world.run(1.0)
        port = pilot.client.socket.getpeername()[1]
        intruder = Client(port)
        intruder.send(servo_packet(1_000_000, [1000] * 4))
        intruder.send(b"\xff" * 5000)
        world.run(2.0)
        assert position(world)[2] > 1.0
        assert intruder.receive() is None
        intruder.close()
    ignored = reported(world, wires.AUTOPILOT_PACKET_IGNORED)
    assert {each.values["reason"] for each in ignored} == {"sender", "length"}


def test_without_its_autopilot_the_vehicle_is_no_longer_driven(make):
    with flight(make) as (world, pilot):
        world.run(3.0)
        port = pilot.client.socket.getpeername()[1]
    check_loss(world)
    # Another program can connect then.
    client = Client(port)
    client.send(servo_packet(0, [1000] * 4))
    world.run(STEP)
    assert client.receive() is not None
    client.close()
    assert len(reported(world, wires.AUTOPILOT_CONNECTED)) == 2


def test_two_vehicles_cannot_use_one_port(make):
    world = make.world(step=STEP)
    port = free_port()
    for y in (0.0, 2.0):
        world.session.spawn(
            quadcopter(make, plugin(port)), name=f"drone{y:g}", pose=Pose((0.0, y, 0.0))
        )
    world.run(STEP)
    (taken,) = reported(world, wires.ADDRESS_UNAVAILABLE)
    assert taken.values == {"host": "127.0.0.1", "port": port}


def test_a_deleted_vehicle_closes_its_port(make):
    world = make.world(step=STEP)
    port = free_port()
    for _ in range(2):
        world.session.spawn(quadcopter(make, plugin(port)))
        world.run(STEP)
        world.session.simulation.delete("drone")
    assert not reported(world, wires.ADDRESS_UNAVAILABLE)


def test_rangefinders_are_part_of_the_state(make):
    world = make.world(step=STEP)
    port = free_port()
    below = (
        '<sensor name="down" type="gpu_lidar"><pose>0 0 -0.06 0 1.5707963267948966 0</pose>'
        "<update_rate>50</update_rate><topic>/down</topic><lidar><scan><horizontal>"
        "<samples>1</samples><min_angle>0</min_angle><max_angle>0</max_angle></horizontal></scan>"
        "<range><min>0.01</min><max>20</max></range></lidar></sensor>"
    )
    tags = "<sensor><type>sonar</type><index>1</index><topic>/down</topic></sensor>"
    model = quadcopter(make, plugin(port, tags), IMU + below)
    world.session.spawn(model, pose=Pose((0.0, 0.0, 3.0)))
    client = Client(port)
    world.run(STEP)
    measured = []
    for frame in range(30):
        client.send(servo_packet(frame, [0] * 4, count=32))
        world.run(STEP)
        measured.append(json.loads(client.receive())["rng_1"])
    client.close()
    assert measured[0] in (-1.0, pytest.approx(2.99, abs=0.01))
    # The vehicle falls at 1.2 m/s, and the rangefinder measures every 0.02 s.
    assert measured[-1] == pytest.approx(position(world)[2] - 0.06, abs=0.03)
