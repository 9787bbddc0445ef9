"""The example plugins with a topic, a service, an action and a device."""

from pathlib import Path

import pytest

import cartwheel as cw

EXAMPLES = Path(__file__).parents[2] / "examples" / "plugin"
LIFT = """<sdf version="1.9"><model name="forklift">
  <link name="base"><inertial><mass>20</mass></inertial>
    <collision name="c"><geometry><box><size>0.5 0.5 0.1</size></box></geometry></collision></link>
  <link name="platform"><pose>0 0 0.2 0 0 0</pose><inertial><mass>2</mass></inertial></link>
  <joint name="lift_joint" type="prismatic"><parent>base</parent><child>platform</child>
    <axis><xyz>0 0 1</xyz><limit><lower>0</lower><upper>1</upper></limit></axis></joint>
  <plugin name="lift" filename="libplain_lift.so"/>
</model></sdf>"""


def test_a_lift_is_moved_by_a_topic_a_service_and_an_action() -> None:
    with cw.World(strict=True, plugins=[EXAMPLES / "lift.py"]) as world:
        lift = world.spawn(LIFT, z=0.05)
        lift.publish("/height", data=0.3)
        world.run(seconds=3)
        assert lift.joint("lift_joint") == pytest.approx(0.3, abs=1e-3)

        goal = world.send_goal("/lift", command={"position": 0.5})
        refused = world.send_goal("/lift", command={"position": 0.1})
        assert goal.result(timeout=3).reached_goal and goal.status == "succeeded"
        assert 0.4 < goal.feedback.position < 0.5
        assert refused.status == "rejected"

        stopped = world.send_goal("/lift", command={"position": 0.0})
        world.run(seconds=0.5)
        stopped.cancel()
        world.run(seconds=0.5)
        assert stopped.status == "cancelled"
        assert lift.joint("lift_joint") == pytest.approx(0.4, abs=0.02)  # 0.5 s at 0.2 m/s

        assert world.call("/lower").success
        world.run(seconds=3)
        assert lift.joint("lift_joint") == pytest.approx(0.0, abs=1e-3)

        aborted = world.send_goal("/lift", command={"position": 0.5})
        world.run(seconds=0.5)
        world.reset()
        assert aborted.status == "aborted"
        again = world.send_goal("/lift", command={"position": 0.1})
        assert again.result(timeout=3).reached_goal


def rover() -> str:
    """A base with two wheels and a sliding ball."""
    wheels = "".join(
        f'<link name="{name}_wheel"><pose>0.05 {y} 0 -1.5707963 0 0</pose>'
        "<inertial><mass>0.5</mass><inertia><ixx>0.0015</ixx><iyy>0.0015</iyy><izz>0.0025</izz>"
        '</inertia></inertial><collision name="c"><geometry><cylinder><radius>0.1</radius>'
        f'<length>0.04</length></cylinder></geometry></collision></link><joint name="{name}" '
        f'type="continuous"><parent>base_link</parent><child>{name}_wheel</child>'
        "<axis><xyz>0 0 1</xyz></axis></joint>"
        for name, y in (("left", 0.15), ("right", -0.15))
    )
    ball = (
        '<collision name="ball"><pose>-0.15 0 -0.05 0 0 0</pose><geometry><sphere><radius>0.05'
        "</radius></sphere></geometry><surface><friction><ode><mu>0</mu><mu2>0</mu2></ode>"
        "</friction></surface></collision>"
    )
    return (
        f'<sdf version="1.9"><model name="rover"><link name="base_link"><inertial><mass>4</mass>'
        "<inertia><ixx>0.05</ixx><iyy>0.05</iyy><izz>0.05</izz></inertia></inertial>"
        f'{ball}</link>{wheels}<plugin name="drive" filename="libtwo_wheels.so"><left>left</left>'
        "<right>right</right><track>0.3</track><tyre>0.2</tyre></plugin></model></sdf>"
    )


def test_a_plugin_with_its_own_tags_uses_the_differential_drive() -> None:
    with cw.World(strict=True, plugins=[EXAMPLES / "two_wheels.py"]) as world:
        robot = world.spawn(rover(), z=0.1)
        odometry = world.mailbox("/odom")
        robot.publish("/cmd_vel", linear_x=0.3, angular_z=0.2)
        world.run(seconds=3)
        # From rest it lags by what its motors need to accelerate, a few ms.
        assert robot.pose.rpy[2] == pytest.approx(0.6, rel=0.02)
        measured = odometry.drain()[-1].pose.pose.position
        assert (measured.x, measured.y) == pytest.approx(robot.pose.position[:2], abs=0.01)


def test_a_bad_value_of_the_drive_is_an_error() -> None:
    text = rover().replace("<track>0.3<", "<track>0<")
    with (
        cw.World(plugins=[EXAMPLES / "two_wheels.py"]) as world,
        pytest.raises(cw.CartwheelError) as error,
    ):
        world.spawn(text)
    assert error.value.code is not None
