"""Drives execute a command between two runs at its time, as one of a timed action."""

from __future__ import annotations

from pathlib import Path

import pytest

import cartwheel as cw

ROBOTS = Path(__file__).parents[2] / "golden" / "robots"
DRIVES = ("ackermann-steering", "diff-drive", "mecanum-drive")
LIMIT = "<max_acceleration>2</max_acceleration></plugin>"


def path(text: str, *, between: bool) -> list[tuple[cw.Pose, list[float]]]:
    """Poses and joints of a robot whose commands change at 0.3 s and 0.55 s."""
    commands = ((0.3, 0.4, -0.2), (0.55, -0.1, 0.3))
    with cw.World("empty") as world:
        robot = world.spawn(text)
        (topic,) = (name for name in robot.topics if name.endswith("cmd_vel"))
        robot.publish(topic, linear_x=0.2, angular_z=0.1)
        states = []
        if not between:
            for time, forward, turn in commands:
                values = {"linear_x": forward, "angular_z": turn}
                world.on(time, lambda values=values: robot.publish(topic, **values))
        for time, forward, turn in (*commands, (0.9, 0.0, 0.0)):
            world.run(time - world.time)
            if between:
                robot.publish(topic, linear_x=forward, angular_z=turn)
            states.append((robot.pose, list(robot.joints.positions.values())))
        return states


@pytest.mark.parametrize("drive", DRIVES)
def test_a_drive_without_a_ramp_has_the_same_bits(drive: str) -> None:
    text = (ROBOTS / f"gz-sim-{drive}-system.urdf").read_text()
    states = path(text, between=True)
    assert states == path(text, between=False)
    assert states[-1][0] != states[0][0]


@pytest.mark.parametrize("drive", ["diff-drive", "mecanum-drive"])
def test_a_ramp_begins_at_the_next_update(drive: str) -> None:
    """10 ms later: 2 m/s² 10 ms 0.6 s = 12 mm at most."""
    text = (ROBOTS / f"gz-sim-{drive}-system.urdf").read_text().replace("</plugin>", LIMIT)
    (later, _), (sooner, _) = (path(text, between=between)[-1] for between in (True, False))
    assert later.x == pytest.approx(sooner.x, abs=0.012)
    assert later != sooner
