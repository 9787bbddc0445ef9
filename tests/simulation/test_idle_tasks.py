"""Tasks that would change nothing do not interrupt the physics, and have no effect on results."""

import numpy as np
import pytest

import cartwheel as cw
from cartwheel.simulation import MotorHandle

COMMAND = "/part2_cmr/cmd_vel"
CONTROL = 100
"""Rate of the cart's drive, Hz."""


@pytest.fixture
def pieces(monkeypatch):
    """Steps of each call of the physics."""
    found = []

    def watch(world):
        engine = world.session.simulation.engine
        advance = engine.advance

        def counted(count, forwarded):
            found.append(count)
            advance(count, forwarded)

        monkeypatch.setattr(engine, "advance", counted)
        return found

    return watch


def cart(make, *others):
    world = make.world(*others)
    world.spawn("rosbots.xacro", z=0.05)
    return world


def wall(make, x):
    return make.box("wall", (0.2, 2, 0.4), static=True, pose=cw.Pose((x, 0, 0.2)))


def motor_of(world):
    parts = [each.part for each in world.session.simulation.population.residents.values()]
    return next(h for part in parts for h in part.handles if isinstance(h, MotorHandle))


def state(world):
    data = world.session.simulation.data
    return np.concatenate([data.qpos, data.qvel]).tobytes()


def test_a_drive_at_constant_speed_does_not_interrupt_the_physics(make, pieces):
    world = cart(make)
    world.run(1.0)
    found = pieces(world)
    world.run(1.0)
    assert found == [20] * 10
    found.clear()
    world.publish(COMMAND, linear_x=0.4)
    world.run(1.0)
    # It accelerates at 1 m/s².
    assert sum(found) == 200
    assert 0.4 * CONTROL <= len(found) <= 0.4 * CONTROL + 12


def test_results_do_not_depend_on_whether_an_idle_drive_runs(make):
    """It runs at the end of each `run`, and if a sensor is due at the same time."""

    def driven(seconds, topics):
        world = cart(
            make, make.box("wall", (0.2, 2, 0.4), static=True, pose=cw.Pose((1.2, 0, 0.2)))
        )
        for topic in topics:
            world.subscribe(topic, lambda message: None)
        found = []
        for speed, turn in ((0.4, 0.0), (0.4, 0.0), (0.6, 0.3), (-0.2, 0.1)):
            world.publish(COMMAND, linear_x=speed, angular_z=turn)
            for _ in range(round(1.2 / seconds)):
                world.run(seconds)
            found.append(state(world))
        return found

    expected = driven(1.2, ())
    assert driven(0.015, ()) == expected
    assert driven(1.2, ("/odom", "/imu/data", "/joint_states")) == expected
    assert driven(0.3, ("/imu/data",)) == expected


def test_a_command_of_another_plugin_is_replaced_at_the_next_update(make):
    world = cart(make)
    world.publish(COMMAND, linear_x=0.3)
    world.run(1.0)
    motor = motor_of(world)
    wanted = motor.target
    assert wanted > 0
    motor.command(0.0)
    world.run(0.005)
    assert motor.target == 0
    world.run(0.01)
    assert motor.target == wanted


def test_rotors_keep_the_commanded_speed(make):
    """The torque at a wall would change it."""
    world = cart(make, wall(make, 0.6))
    world.publish(COMMAND, linear_x=0.3)
    world.run(2.96)
    motor = motor_of(world)
    assert motor.rotors[motor.dof] != motor.target
    assert motor.rotors[motor.dof] == pytest.approx(motor.target, abs=1e-5)
    world.run(0.04)
    assert motor.rotors[motor.dof] == motor.target
