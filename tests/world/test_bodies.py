"""Joints and shapes of a description as they come out of the engine's compiler."""

import numpy as np
import pytest

import cartwheel as cw
from cartwheel.codes.world import LOOP_WITHOUT_ROOT, PLANE_NOT_STATIC
from cartwheel.description import load_text
from cartwheel.errors import WorldError

PLANAR = """<robot name="r">
  <link name="base">
    <inertial><mass value="9"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <link name="puck">
    <inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <joint name="j" type="planar">
    <parent link="base"/><child link="puck"/><axis xyz="{axis}"/>
  </joint>
</robot>"""

CONE = """<sdf version="1.10"><model name="pile"><link name="link">
  <inertial><mass>1</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial>
  <collision name="c"><geometry><cone><radius>0.5</radius><length>1</length></cone></geometry>
  </collision></link></model></sdf>"""


HALL = """<sdf version="1.10"><world name="w"><model name="hall">{static}
  <link name="frame"/>
  <link name="floor"><pose>0 0 0.3 0 0 0</pose>
    <collision name="c"><geometry><plane/></geometry></collision></link>
  <joint name="held" type="{held}"><parent>{parent}</parent><child>{child}</child></joint>
  <joint name="laid" type="{laid}"><parent>frame</parent><child>floor</child>
    <axis><xyz>0 0 1</xyz></axis></joint>
  </model>
  <model name="crate"><pose>0 0 0.45 0 0 0</pose><link name="link">
    <collision name="c"><geometry><box><size>0.2 0.2 0.2</size></box></geometry></collision>
  </link></model></world></sdf>"""
HELD = {"static": "", "parent": "world", "child": "frame", "held": "fixed", "laid": "fixed"}


@pytest.mark.parametrize(
    "changed", [{}, {"parent": "frame", "child": "world"}, {"static": "<static>1</static>"}]
)
def test_a_plane_that_fixed_joints_hold_to_the_world_is_a_floor(tmp_path, changed) -> None:
    path = tmp_path / "hall.world"
    path.write_text(HALL.format(**(HELD | changed)))
    with cw.World(path) as world:
        world.run(1.0)
        assert world.model("crate").pose.z == pytest.approx(0.4, abs=2e-3)


@pytest.mark.parametrize("changed", [{"held": "revolute"}, {"laid": "revolute"}])
def test_a_plane_of_a_link_that_can_move_is_an_error(tmp_path, changed) -> None:
    path = tmp_path / "hall.world"
    path.write_text(HALL.format(**(HELD | changed)))
    with pytest.raises(WorldError) as caught:
        cw.World(path)
    assert caught.value.code is PLANE_NOT_STATIC


@pytest.mark.parametrize("axis", ["0 0 1", "1 0 0", "1 1 1"])
def test_a_planar_joint_slides_across_its_axis_and_turns_about_it(axis: str) -> None:
    with cw.World("empty") as world:
        world.spawn(load_text(PLANAR.format(axis=axis), file="r.urdf"))
        model = world.session.simulation.model
        ids = [model.joint(f"r::j{suffix}").id for suffix in ("::x", "::y", "")]
        normal = np.array([float(word) for word in axis.split()])
        expected = normal / np.linalg.norm(normal)
        x, y, turn = model.jnt_axis[ids]
        assert np.cross(x, y) == pytest.approx(expected, abs=1e-9)
        assert turn == pytest.approx(expected, abs=1e-9)


def test_a_cone_stands_on_its_base() -> None:
    with cw.World("empty") as world:
        pile = world.spawn(load_text(CONE, file="c.sdf"), z=0.51)
        world.run(2.0)
        assert pile.pose.z == pytest.approx(0.5, abs=2e-3)
        assert abs(pile.pose.rpy[0]) + abs(pile.pose.rpy[1]) < 0.01


def bar(name: str, length: float) -> str:
    """A link of 1 kg along x, its mass at the middle."""
    inertia = length**2 / 12
    return f"""<link name="{name}"><inertial><origin xyz="{length / 2} 0 0"/><mass value="1"/>
      <inertia ixx="0.001" iyy="{inertia}" izz="{inertia}" ixy="0" ixz="0" iyz="0"/></inertial>
    </link>"""


MIMIC = f"""<robot name="r"><link name="world"/>{bar("a", 0.5)}{bar("b", 0.5)}
  <joint name="lead" type="continuous"><parent link="world"/><child link="a"/>
    <origin xyz="0 0 2"/><axis xyz="0 1 0"/></joint>
  <joint name="follow" type="continuous"><parent link="world"/><child link="b"/>
    <origin xyz="0 1 2"/><axis xyz="0 1 0"/><mimic joint="lead" multiplier="-2" offset="0.3"/>
  </joint></robot>"""

FOUR_BARS = """<sdf version="1.10"><model name="linkage">
  {links}
  <joint name="stand" type="fixed"><parent>world</parent><child>ground</child></joint>
  <joint name="left" type="revolute"><parent>ground</parent><child>crank</child>
    <axis><xyz>0 1 0</xyz></axis></joint>
  <joint name="top" type="revolute"><parent>crank</parent><child>coupler</child>
    <axis><xyz>0 1 0</xyz></axis></joint>
  <joint name="right" type="revolute"><parent>ground</parent><child>rocker</child>
    <axis><xyz>0 1 0</xyz></axis></joint>
  <joint name="loop" type="revolute"><parent>coupler</parent><child>rocker</child>
    <pose>0 0 0.5 0 0 0</pose><axis><xyz>0 1 0</xyz></axis></joint>
</model></sdf>"""


def test_a_mimic_joint_follows_its_leader() -> None:
    with cw.World("empty") as world:
        world.spawn(load_text(MIMIC, file="r.urdf"))
        simulation = world.session.simulation
        turned = []
        for _ in range(20):
            world.run(0.1)
            lead, follow = (simulation.joint_position("r", name) for name in ("lead", "follow"))
            turned.append(lead)
            assert follow == pytest.approx(-2 * lead + 0.3, abs=0.02)
        assert max(turned) - min(turned) > 0.05


STAND = '<joint name="stand" type="fixed"><parent>world</parent><child>ground</child></joint>'
RIGHT = "<parent>ground</parent><child>rocker</child>"
BACK = '<pose relative_to="rocker"/><parent>rocker</parent><child>ground</child>'


@pytest.mark.parametrize(
    "model",
    [
        FOUR_BARS,
        # Each link is the child of a joint, so the first one is the root. The model falls freely.
        FOUR_BARS.replace(STAND, "").replace(RIGHT, BACK),
        # The joint to the world is the second one above its link.
        FOUR_BARS.replace(STAND, "").replace(RIGHT, BACK).replace("</model>", STAND + "</model>"),
    ],
)
def test_a_loop_of_links_stays_closed(model: str) -> None:
    """A parallelogram of bars: its coupler stays level however it swings."""
    places = {"ground": "0 0 2", "crank": "0 0 2", "coupler": "0 0 2.5", "rocker": "1 0 2"}
    links = "".join(
        f"""<link name="{name}"><pose>{place} 0 0 0</pose><inertial>
          <pose>0 0 {0.25 if name in ("crank", "rocker") else 0} 0 0 0</pose><mass>1</mass>
          <inertia><ixx>0.02</ixx><iyy>0.02</iyy><izz>0.02</izz></inertia></inertial></link>"""
        for name, place in places.items()
    )
    with cw.World("empty") as world:
        world.spawn(load_text(model.format(links=links), file="linkage.sdf"), z=50.0)
        simulation = world.session.simulation
        simulation.data.joint("linkage::left").qvel = 1.0
        if RIGHT in model:
            simulation.data.joint("linkage::right").qvel = 1.0
        else:
            simulation.data.joint("linkage::loop").qvel = 1.0
        simulation.data.joint("linkage::top").qvel = -1.0
        swung = []
        for _ in range(20):
            world.run(0.1)
            left, top = (simulation.joint_position("linkage", name) for name in ("left", "top"))
            swung.append(abs(left))
            assert left + top == pytest.approx(0.0, abs=0.02)
        assert max(swung) > 0.5


PAIRS = ["ab", "ba", "cd", "dc", "ac"]


@pytest.mark.parametrize("pairs", [PAIRS, [*PAIRS, "ca"]])
def test_loops_that_joints_connect_in_both_directions_have_no_root(pairs: list[str]) -> None:
    links = "".join(f'<link name="{name}"/>' for name in "abcd")
    ends = "".join(
        f'<joint name="{a}{b}" type="fixed"><parent>{a}</parent><child>{b}</child></joint>'
        for a, b in pairs
    )
    robot = load_text(
        f'<sdf version="1.7"><model name="m">{links}{ends}</model></sdf>', file="m.sdf"
    )
    with cw.World("empty") as world:
        if "ca" not in pairs:
            world.spawn(robot)
            return
        with pytest.raises(WorldError) as caught:
            world.spawn(robot)
        assert caught.value.code is LOOP_WITHOUT_ROOT
        assert caught.value.values["link"] == "a"


def test_a_thin_plate_beyond_the_edge_by_rounding_is_built() -> None:
    """ixx + iyy = izz: turned, and in binary digits, the sum is a little less."""
    inertia = 'ixx="5.445e-05" iyy="5.445e-05" izz="1.089e-04" ixy="0" ixz="0" iyz="0"'
    text = f"""<robot name="r"><link name="plate"><inertial><origin rpy="-1.57 0 0"/>
      <mass value="0.1"/><inertia {inertia}/></inertial></link></robot>"""
    with cw.World("empty") as world:
        world.spawn(load_text(text, file="r.urdf"), z=1.0)
        model = world.session.simulation.model
        moments = sorted(model.body_inertia[model.body("r::plate").id])
        assert moments == pytest.approx([5.445e-05, 5.445e-05, 1.089e-04], rel=1e-6)


@pytest.mark.parametrize(("written", "half"), [("2 0.5", (1.0, 0.25)), ("100 100", (200.0, 200.0))])
def test_a_small_plane_is_drawn_as_large_as_it_says_and_a_ground_to_the_horizon(
    make, written, half
):
    sign = make.sdf(
        f"""<model name="sign"><static>true</static><link name="l"><visual name="v"><geometry>
        <plane><normal>1 0 0</normal><size>{written}</size></plane></geometry></visual></link>
        </model>"""
    )
    model, _ = make.world(sign, ground=None).session.simulation.engine.visuals.current()
    assert model.geom_size[0, :2] == pytest.approx(half)


def block(name: str, z: float) -> str:
    """A cube of 0.2 m and 1 kg."""
    return f"""<link name="{name}"><inertial><origin xyz="0 0 {z}"/><mass value="1"/>
      <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial><collision>
      <origin xyz="0 0 {z}"/><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>"""


@pytest.mark.parametrize("stands", [True, False])
def test_links_that_a_joint_connects_do_not_collide(stands: bool) -> None:
    # The tip is fixed to the link that turns, and with it connected to the base; the far one is
    # connected to that, 0.1 m inside of the base.
    anchor = """<link name="world"/><joint name="stand" type="fixed"><parent link="world"/>
      <child link="base"/></joint>"""
    urdf = f"""<robot name="r">{block("base", 0.0)}{block("turn", 0.3)}{block("tip", 0.1)}
      {block("far", 0.0)}{anchor if stands else ""}
      <joint name="j1" type="continuous"><parent link="base"/><child link="turn"/>
        <axis xyz="0 0 1"/></joint>
      <joint name="held" type="fixed"><parent link="turn"/><child link="tip"/></joint>
      <joint name="j2" type="continuous"><parent link="tip"/><child link="far"/>
        <origin xyz="0 0 0.1"/><axis xyz="0 0 1"/></joint>
      <gazebo><self_collide>true</self_collide></gazebo></robot>"""
    with cw.World("empty") as world:
        world.spawn(load_text(urdf, file="r.urdf"), z=5.0)
        world.run(0.01)
        simulation = world.session.simulation
        touching = {
            frozenset(simulation.model.geom(geom).name.split("::")[1] for geom in pair)
            for pair in simulation.data.contact.geom
        }
        assert touching == {frozenset(("base", "far"))}
