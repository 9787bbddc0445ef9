"""The force of wind on a link."""

import pytest
from tests.coded import coded

from cartwheel.codes import devices
from cartwheel.geometry import Pose

PLUGIN = """<plugin name="wind" filename="librotors_gazebo_wind_plugin.so">
  <linkName>link</linkName><windForceMean>4</windForceMean><windDirection>0 2 0</windDirection>
  <windGustForceMean>6</windGustForceMean><windGustDirection>1 0 0</windGustDirection>
  <windGustStart>0.5</windGustStart><windGustDuration>0.25</windGustDuration>{more}</plugin>"""


def body(make, more=""):
    """2 kg with its centre of mass beside the origin of the link."""
    return make.sdf(f"""<model name="kite"><link name="link"><inertial><pose>0.3 0 0 0 0 0</pose>
      <mass>2</mass><inertia><ixx>0.5</ixx><iyy>0.5</iyy><izz>0.5</izz></inertia></inertial></link>
      {PLUGIN.format(more=more)}</model>""")


@pytest.fixture
def flying(make):
    def fly(more=""):
        world = make.world(gravity=0.0, ground=None)
        world.session.spawn(body(make, more), pose=Pose((0, 0, 1)))
        return world

    return fly


def test_wind_accelerates_and_a_gust_is_added(flying):
    world = flying()
    forces = []
    world.graph.subscribe("/external_force", lambda m: forces.append(m.wrench.force))
    world.run(0.5)
    kite = world.model("kite").link("link")
    # 4 N on 2 kg for 0.5 s, then 6 N forward for 0.25 s.
    assert kite.velocity.linear == pytest.approx((0.0, 1.0, 0.0), abs=0.012)
    world.run(0.5)
    assert kite.velocity.linear == pytest.approx((0.75, 2.0, 0.0), abs=0.02)
    # It acts at the centre of mass.
    assert kite.velocity.angular == pytest.approx((0.0, 0.0, 0.0), abs=1e-6)
    assert {(each.x, each.y) for each in forces} == {(0.0, 4.0), (6.0, 4.0)}


def test_an_offset_turns_the_link(flying):
    world = flying("<xyzOffset>0.1 0 0</xyzOffset>")
    world.run(0.25)
    # 4 N at 0.1 m turn 0.5 kg m^2.
    turned = world.model("kite").link("link").velocity.angular
    assert turned == pytest.approx((0.0, 0.0, 0.8 * 0.25), abs=0.006)


def test_wind_fields_are_not_supported(flying):
    world = flying("<useCustomStaticWindField>true</useCustomStaticWindField>")
    (reported,) = coded(world, devices.PLUGIN_PARAMETER_IGNORED)
    assert reported.values["parameter"] == "useCustomStaticWindField"
