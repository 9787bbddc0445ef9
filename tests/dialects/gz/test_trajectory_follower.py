"""A boat that moves to waypoints by a force and a torque."""

import math

import pytest
from tests.coded import coded, raises

import cartwheel as cw
from cartwheel.codes import devices, running
from cartwheel.description import load_text
from cartwheel.errors import PluginError, UnknownNameError

WORLD = '<sdf version="1.9"><world name="w"><gravity>0 0 0</gravity></world></sdf>'
DAMPING = (
    '<plugin name="water" filename="gz-sim-hydrodynamics-system"><link_name>base</link_name>'
    "<xU>-60</xU><yV>-200</yV><zW>-200</zW><kP>-50</kP><mQ>-50</mQ><nR>-50</nR></plugin>"
)
"""With a force of 60 N and a torque of 50 N m: 1 m/s and 1 rad/s."""
BODY = (
    '<link name="base"><inertial><mass>20</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz>'
    "</inertia></inertial></link>"
)
SQUARE = "".join(f"<waypoint>{x} {y}</waypoint>" for x, y in ((4, 0), (4, 4), (0, 4), (0, 0)))


SYSTEM = "gz-sim-trajectory-follower-system"


class Boat:
    def __init__(self, worlds, path, *, tags="", yaw=0.0, name=SYSTEM, damping=DAMPING):
        self.world = cw.World(WORLD)
        worlds.append(self.world)
        plugin = (
            f'<plugin name="follow" filename="{name}"><link_name>base</link_name>{path}{tags}'
            "</plugin>"
        )
        text = f'<sdf version="1.9"><model name="boat">{BODY}{damping}{plugin}</model></sdf>'
        self.model = self.world.spawn(load_text(text, file="boat.sdf"), yaw=yaw)

    def reaches(self, place, seconds, within=0.55):
        """Whether it comes near a place."""
        for _ in range(round(seconds * 10)):
            self.world.run(0.1)
            if math.dist(self.model.pose.position[:2], place) <= within:
                return True
        return False


@pytest.fixture
def boat():
    worlds = []
    yield lambda *given, **more: Boat(worlds, *given, **more)
    for each in worlds:
        each.close()


def test_it_visits_the_waypoints_in_order(boat):
    made = boat(f"<waypoints>{SQUARE}</waypoints>")
    for place in ((4, 0), (4, 4), (0, 4), (0, 0)):
        assert made.reaches(place, 12.0)
    made.world.run(10.0)
    assert math.hypot(*made.model.pose.position[:2]) < 0.55


def test_it_moves_at_the_speed_that_force_and_damping_give(boat):
    made = boat("<waypoints><waypoint>100 0</waypoint></waypoints>")
    made.world.run(3.0)
    before = made.model.pose.x
    made.world.run(2.0)
    assert made.model.pose.x - before == pytest.approx(2.0, rel=0.05)


def test_a_loop_starts_again(boat):
    made = boat(f"<waypoints>{SQUARE}</waypoints>", tags="<loop>true</loop>")
    for place in ((4, 0), (4, 4), (0, 4), (0, 0), (4, 0), (4, 4)):
        assert made.reaches(place, 12.0)


def test_a_circle_is_about_the_first_place(boat):
    made = boat("<circle><radius>3</radius></circle>", tags="<loop>true</loop>")
    for number in (*range(8), 0):
        angle = math.pi / 4 * number
        assert made.reaches((3 * math.cos(angle), 3 * math.sin(angle)), 12.0)


def test_a_line_begins_at_the_first_heading(boat):
    """It goes to the left of a boat that faces north, and back again."""
    made = boat(
        "<line><direction>1.5707963</direction><length>5</length></line>",
        tags="<loop>true</loop>",
        yaw=math.pi / 2,
    )
    assert made.reaches((-5, 0), 15.0)
    assert made.reaches((0, 0), 15.0)


def test_it_can_be_paused(boat):
    made = boat("<waypoints><waypoint>100 0</waypoint></waypoints>")
    made.world.run(2.0)
    made.world.publish("/model/boat/trajectory_follower/pause", data=True)
    made.world.run(3.0)
    before = made.model.pose.x
    made.world.run(1.0)
    assert made.model.pose.x - before < 0.01
    made.world.publish("/model/boat/trajectory_follower/pause", data=False)
    made.world.run(3.0)
    assert made.model.pose.x - before > 1.0


def test_tolerances_decide_when_it_turns_and_stops(boat):
    tags = "<range_tolerance>2</range_tolerance><bearing_tolerance>60</bearing_tolerance>"
    made = boat("<waypoints><waypoint>4 2</waypoint></waypoints>", tags=tags)
    made.world.run(1.0)
    # The waypoint is less than 60° to the left, so it does not turn.
    assert made.model.pose.yaw == pytest.approx(0.0, abs=1e-6)
    assert made.model.pose.x > 0.3
    made.world.run(10.0)
    assert math.dist(made.model.pose.position[:2], (4, 2)) == pytest.approx(2.0, abs=0.6)


def test_the_rotation_can_stop_at_the_bearing(boat):
    """Without a stop and with little damping, it turns to and fro."""
    fastest = {}
    for stops in ("true", "false"):
        made = boat(
            "<waypoints><waypoint>0 100</waypoint></waypoints>",
            tags=f"<zero_vel_on_bearing_reached>{stops}</zero_vel_on_bearing_reached>"
            "<bearing_tolerance>20</bearing_tolerance><torque>5</torque>",
            damping=DAMPING.replace("<nR>-50</nR>", "<nR>-1</nR>"),
        )
        made.world.run(3.0)
        rates = []
        for _ in range(10):
            before = made.model.pose.yaw
            made.world.run(0.1)
            rates.append(abs(made.model.pose.yaw - before) / 0.1)
        fastest[stops] = max(rates)
    assert fastest["true"] < 0.02
    assert fastest["false"] > 0.1


def test_a_reset_begins_with_the_first_waypoint(boat):
    made = boat(f"<waypoints>{SQUARE}</waypoints>")
    assert made.reaches((4, 4), 20.0)
    made.world.reset()
    assert made.reaches((4, 0), 12.0)
    assert made.reaches((4, 4), 12.0)


def test_old_names_are_understood(boat):
    path = "<waypoints><waypoint>3 0</waypoint></waypoints>"
    assert boat(path, name="ignition-gazebo4-trajectory-follower-system").reaches((3, 0), 12.0)


def test_without_a_path_it_stays(boat):
    made = boat("")
    assert coded(made.world, devices.PLUGIN_IDLE)
    made.world.run(1.0)
    assert made.model.pose.position == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    "path",
    [
        "<waypoints/>",
        "<circle/>",
        "<line><length>3</length></line>",
        "<line><direction>3</direction></line>",
    ],
)
def test_missing_tags_are_reported(boat, path):
    with raises(devices.PLUGIN_PARAMETER_MISSING, PluginError):
        boat(path)


def test_bad_values_are_reported(boat):
    with raises(devices.PLUGIN_PARAMETER_INVALID, PluginError):
        boat("<waypoints><waypoint>1</waypoint></waypoints>")
    with raises(devices.PLUGIN_PARAMETER_INVALID, PluginError, parameter="range_tolerance"):
        boat("", tags="<range_tolerance>-1</range_tolerance>")


def test_an_unknown_link_is_reported(boat):
    with raises(running.UNKNOWN_LINK, UnknownNameError):
        boat("", tags="").world.spawn(
            load_text(
                f'<sdf version="1.9"><model name="b">{BODY}<plugin name="f" '
                'filename="gz-sim-trajectory-follower-system"><link_name>x</link_name></plugin>'
                "</model></sdf>",
                file="b.sdf",
            )
        )
