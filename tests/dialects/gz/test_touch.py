"""A model that reports what it has touched for some time."""

import pytest
from tests.coded import coded

from cartwheel.codes import devices
from cartwheel.geometry import Pose

SENSOR = '<sensor name="s" type="contact"><contact><collision>c</collision></contact></sensor>'


def ball(make, *, enabled="true", target="pad", sensor=SENSOR, seconds=0.5):
    return make.sdf(f"""<model name="ball"><link name="link"><inertial><mass>1</mass><inertia>
      <ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia></inertial><collision name="c">
      <geometry><box><size>0.2 0.2 0.2</size></box></geometry></collision>{sensor}</link>
      <plugin name="t" filename="gz-sim-touchplugin-system"><target>{target}</target>
      <time>{seconds}</time><namespace>ball</namespace><enabled>{enabled}</enabled></plugin>
      </model>""")


@pytest.fixture
def world(make):
    return make.world(make.box("pad", (1, 1, 0.1), static=True, pose=Pose((0, 0, 0.05))))


def spawned(world, model):
    """The times of the messages after the model was spawned just above the pad."""
    world.session.spawn(model, pose=Pose((0, 0, 0.2)))
    times = []
    simulation = world.session.simulation
    world.graph.subscribe("/ball/touched", lambda m: times.append((simulation.time_ns, m.data)))
    return times


def test_it_reports_once_after_the_time(world, make):
    times = spawned(world, ball(make))
    world.run(2.0)
    ((when, data),) = times
    assert data is True
    # It touches the pad within a few steps.
    assert when * 1e-9 == pytest.approx(0.5, abs=0.03)


def test_other_models_do_not_count(world, make):
    times = spawned(world, ball(make, target="wall"))
    world.run(1.0)
    assert times == []


def test_the_service_enables_it_again(world, make):
    times = spawned(world, ball(make, enabled="false"))
    world.run(1.0)
    assert times == []
    for _ in range(2):
        assert world.call("/ball/enable", {"data": True}).success
        world.run(1.0)
    assert [when * 1e-9 for when, _ in times] == pytest.approx([1.5, 2.5], abs=0.02)


def test_a_lift_ends_the_contact(world, make):
    times = spawned(world, ball(make))
    world.run(0.3)
    world.model("ball").pose = Pose((0, 0, 1.0))
    world.run(0.6)
    assert times == []
    world.run(1.5)
    assert len(times) == 1


def test_a_model_without_contact_sensors_is_reported(world, make):
    spawned(world, ball(make, sensor=""))
    (reported,) = coded(world, devices.PLUGIN_IDLE)
    assert reported.origin.line == 4
