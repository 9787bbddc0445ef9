"""The plane on which a robot stands, and wheels that do not touch it."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

import cartwheel
from cartwheel.checks.resting import Surfaces, rest_of, starting_poses
from cartwheel.checks.robot import Robot
from cartwheel.codes.robot import UNBALANCED
from cartwheel.description import load_text
from cartwheel.description.kinematics import center_of_mass
from cartwheel.description.model import RobotDescription
from cartwheel.geometry import rotate

RULE = "wheels-off-ground"
RADIUS, BALL = 0.05, 0.02
FOUR = {
    "ahead": (0.15, 0),
    "behind": (-0.15, 0),
    "left_ball": (-0.15, 0.1),
    "right_ball": (-0.15, -0.1),
}
TWO = {"ahead": (0.15, 0), "behind": (-0.15, 0)}
ONE = {"ahead": (0.15, 0)}


def link(name, mass, shape, rpy="0 0 0"):
    inertia = f'ixx="{mass / 100}" iyy="{mass / 100}" izz="{mass / 100}" ixy="0" ixz="0" iyz="0"'
    return (
        f'<link name="{name}"><inertial><mass value="{mass}"/><inertia {inertia}/></inertial>\n'
        f'<collision><origin rpy="{rpy}"/><geometry>{shape}</geometry></collision></link>\n'
    )


def joint(child, kind, xyz, *, parent="base_link", axis="0 1 0"):
    limit = '<limit upper="0.02" effort="9" velocity="1"/>' if kind == "prismatic" else ""
    return (
        f'<joint name="{child}_joint" type="{kind}"><parent link="{parent}"/>'
        f'<child link="{child}"/><origin xyz="{xyz}"/><axis xyz="{axis}"/>{limit}</joint>\n'
    )


def cart(gap=0.0, *, places=None, sprung=(), rolling=(), more=""):
    """A cart whose balls are below its driven wheels.

    Args:
        gap: How far below, m.
        places: Name to place of each ball; None for four.
        sprung: Balls and wheels that a prismatic joint holds.
        rolling: Balls that roll.
        more: Further elements.
    """
    parts = [link("base_link", 5, '<box size="0.4 0.3 0.05"/>')]
    for name, y in (("left", 0.17), ("right", -0.17)):
        wheel = f'<cylinder radius="{RADIUS}" length="0.03"/>'
        parts.append(link(name, 0.25, wheel, "1.5707963 0 0"))
        parent, place = "base_link", f"0 {y} 0"
        if name in sprung:
            parts.append(link(f"{name}_arm", 0.1, '<sphere radius="0.001"/>'))
            parts.append(joint(f"{name}_arm", "prismatic", place, axis="0 0 1"))
            parent, place = f"{name}_arm", "0 0 0"
        parts.append(joint(name, "continuous", place, parent=parent))
        parts.append(f'<gazebo reference="{name}"><mu1>1</mu1><mu2>1</mu2></gazebo>')
    for name, (x, y) in (FOUR if places is None else places).items():
        kind = "prismatic" if name in sprung else "continuous" if name in rolling else "fixed"
        axis = "0 0 1" if kind == "prismatic" else "0 1 0"
        parts.append(link(name, 0.05, f'<sphere radius="{BALL}"/>'))
        parts.append(joint(name, kind, f"{x} {y} {BALL - RADIUS - gap}", axis=axis))
        parts.append(f'<gazebo reference="{name}"><mu1>0.1</mu1><mu2>0.1</mu2></gazebo>')
    return f"""<robot name="cart">{"".join(parts)}{more}
    <gazebo><plugin name="d" filename="libgazebo_ros_diff_drive.so">
    <leftJoint>left_joint</leftJoint><rightJoint>right_joint</rightJoint>
    <wheelSeparation>0.34</wheelSeparation><wheelDiameter>{2 * RADIUS}</wheelDiameter>
    <wheelTorque>10</wheelTorque></plugin></gazebo></robot>"""


def weight(place):
    return link("weight", 2, '<sphere radius="0.01"/>') + joint("weight", "fixed", place)


def as_robot(text):
    description = load_text(text)
    assert isinstance(description, RobotDescription)
    return Robot(description, None)


@pytest.mark.parametrize("places", [TWO, FOUR], ids=["two", "four"])
@pytest.mark.parametrize(("gap", "drives"), [(0.0, True), (0.0005, False), (0.003, False)])
def test_a_cart_drives_if_nothing_is_found(bench, make, places, gap, drives):
    text = cart(gap, places=places)
    assert (bench.find(text, RULE) == []) == drives
    world = make.world()
    robot = world.spawn(load_text(text), z=RADIUS + gap + 0.001)
    world.run(1)
    start = robot.pose
    world.publish("/cmd_vel", linear_x=0.3)
    world.run(2)
    driven = (start.inverse() @ robot.pose).position[0]
    assert driven == pytest.approx(0.6, rel=0.05) if drives else abs(driven) < 0.1


def test_the_parts_on_which_it_stands(bench):
    (found,) = bench.find(cart(0.0023), RULE)
    assert found.values["links"] == tuple(FOUR)
    assert found.values["depth"] == pytest.approx(0.0023)
    text = cart(0.0023)
    assert found.origin.line == text[: text.index("<sphere")].count("\n") + 1


@pytest.mark.wording
def test_the_advice_says_how_far_to_raise_them(bench):
    (found,) = bench.find(cart(0.0023), RULE)
    assert 'stands on "ahead", "behind", "left_ball" and "right_ball"' in found.message
    assert '"left" and "right" do not touch the ground' in found.message
    assert 'Raise "ahead" by 2.3 mm' in found.hint


@pytest.mark.wording
def test_between_two_casters_it_leans_on_one_wheel(bench):
    (found,) = bench.find(cart(0.001, places=TWO, more=weight("0 0.1 0")), RULE)
    assert found.values["links"] == ("ahead", "behind")
    assert '"right"' in found.message and '"left"' not in found.message


@pytest.mark.parametrize(
    "text",
    [
        cart(0.0002),
        cart(0.003, places=ONE | {"behind": (-0.15, 0)}, sprung=("behind",)),
        cart(0.003, sprung=("left", "right")),
        cart(0.003, more='<gazebo reference="ahead"><kp>1000</kp></gazebo>'),
        cart(-0.001),
        cart(0.003).replace("<robot", '<robot static="1"').replace(
            "</robot>", '<link name="world"/><joint name="w" type="fixed"><parent link="world"/>'
            '<child link="base_link"/></joint></robot>'),
    ],
    ids=["0.2 mm", "sprung caster", "sprung wheels", "soft", "higher", "held"],
)  # fmt: skip
def test_nothing_is_found(bench, text):
    assert bench.find(text, RULE) == []


def test_a_robot_that_leans_forward_stands_on_its_wheels(bench):
    """Its weight is ahead of the wheels, so only the caster and the wheels carry it."""
    assert bench.find(cart(0.003, places=ONE, more=weight("0.1 0 0.05")), RULE) == []


def test_rolling_casters_carry_it(bench):
    assert bench.find(cart(0.001, rolling=tuple(FOUR)), RULE)


@pytest.mark.parametrize("seed", range(20))
def test_the_plane_is_that_of_the_lower_hull(seed):
    """Against all triangles of corners around the centre of mass."""
    random = np.random.default_rng(seed)
    parts = [link("body", 5, '<box size="0.1 0.1 0.1"/>')]
    for number, (x, y) in enumerate(itertools.product((-0.2, 0.2), repeat=2)):
        size = " ".join(f"{each:.4f}" for each in random.uniform(0.02, 0.08, 3))
        at = f"{x} {y} {random.uniform(-0.11, -0.1):.5f}"
        parts.append(link(f"foot{number}", 0.2, f'<box size="{size}"/>'))
        parts.append(joint(f"foot{number}", "fixed", at, parent="body"))
    robot = as_robot(f'<robot name="r">{"".join(parts)}</robot>')
    center = center_of_mass(robot.description, starting_poses(robot))
    rest = rest_of(robot, robot.links)
    assert center is not None and rest is not None
    cloud = np.unique(
        np.concatenate(
            [s.placed(robot.links[n].pose) for n, ss in robot.collisions.items() for s in ss]
        ).round(9),
        axis=0,
    )
    assert ((cloud @ rest.normal) >= rest.offset - 2e-6).all()
    lowest = np.inf
    for three in itertools.combinations(cloud, 3):
        matrix = np.column_stack([np.array(three)[:, :2], np.ones(3)]).T
        if abs(np.linalg.det(matrix)) > 1e-12:
            weights = np.linalg.solve(matrix, [center[0], center[1], 1])
            if weights.min() >= -1e-9:
                lowest = min(lowest, float(weights @ np.array(three)[:, 2]))
    level = (rest.offset - rest.normal[:2] @ center[:2]) / rest.normal[2]
    assert level == pytest.approx(lowest, abs=3e-6)


def test_round_shapes_are_exact():
    """A turned wheel of 32 corners would be up to 0.5 % of its radius too high."""
    shapes = (
        '<sphere radius="0.2"/>',
        '<cylinder radius="0.2" length="0.1"/>',
        '<capsule radius="0.2" length="0.1"/>',
    )
    for shape in shapes:
        for angle in (0.03, 0.1, 1.234):
            text = link("a", 1, shape, f"1.5707963267948966 {angle} 0")
            robot = as_robot(f'<robot name="r">{text}</robot>')
            point = Surfaces(robot, ["a"]).lowest(np.array([0.0, 0.0, 1.0]))
            assert point is not None
            assert point[2] == pytest.approx(-0.2, abs=1e-9)


def test_the_search_is_bounded(monkeypatch):
    """A bowl of a thousand balls."""
    parts = [link("body", 5, '<sphere radius="0.001"/>')]
    for number, angle in enumerate(np.linspace(0, 50, 1000)):
        far = number / 1000
        at = f"{far * np.cos(angle)} {far * np.sin(angle)} {far**2 / 10 - 0.5}"
        parts.append(link(f"ball{number}", 0.001, '<sphere radius="0.01"/>'))
        parts.append(joint(f"ball{number}", "fixed", at, parent="body"))
    robot = as_robot(f'<robot name="r">{"".join(parts)}</robot>')
    calls = []
    lowest = Surfaces.lowest
    monkeypatch.setattr(Surfaces, "lowest", lambda *a: calls.append(1) or lowest(*a))
    assert rest_of(robot, robot.links) is not None
    assert len(calls) < 40


@pytest.mark.parametrize("driven", [True, False])
def test_rockers_do_not_carry_it(bench, driven):
    """A ball below two rolling joints, of which the plugin may drive the upper one."""
    more = (
        link("rocker", 0.05, '<sphere radius="0.001"/>')
        + joint("rocker", "continuous", "0.15 0 0")
        + link("rocker_ball", 0.05, f'<sphere radius="{BALL}"/>')
        + joint("rocker_ball", "continuous", f"0 0 {BALL - RADIUS - 0.003}", parent="rocker")
    )
    behind = {name: place for name, place in FOUR.items() if name != "ahead"}
    text = cart(0.003, places=behind, more=more + weight("0.1 0 0.05"))
    if driven:
        text = text.replace(
            "</robot>", '<transmission name="t"><joint name="rocker_joint"/></transmission></robot>'
        )
    assert (bench.find(text, RULE) != []) == driven


def test_a_robot_that_tips_over_has_no_plane():
    parts = link("body", 5, '<box size="0.1 0.1 0.1"/>') + link(
        "far", 50, '<sphere radius="0.01"/>'
    )
    parts += joint("far", "fixed", "1 0 0.5", parent="body")
    robot = as_robot(f'<robot name="r">{parts}</robot>')
    assert rest_of(robot, robot.links) is None
    assert rest_of(robot, []) is None


def test_wheels_of_a_controller_hang_like_those_of_a_plugin(bench, tmp_path):
    yaml = tmp_path / "drive.yaml"
    yaml.write_text(
        "drive:\n  type: diff_drive_controller/DiffDriveController\n  left_wheel: left_joint\n"
        "  right_wheel: right_joint\n  wheel_separation: 0.34\n  wheel_radius: 0.05\n"
    )
    text = cart(0.003)
    plugin = text[text.index("<gazebo>") : text.rindex("</gazebo>") + len("</gazebo>")]
    control = '<gazebo><plugin name="c" filename="libgazebo_ros_control.so"/></gazebo>'
    controlled = text.replace(plugin, control)
    assert bench.find(text, RULE)
    assert bench.find(controlled, RULE) == []
    (finding,) = bench.find(controlled, RULE, controller_files=[yaml])
    assert finding.message == bench.find(text, RULE)[0].message


def test_wheels_with_limits_many_turns_away_hang_as_well(bench):
    text = cart(0.003)
    for side in ("left", "right"):
        text = text.replace(
            f'<joint name="{side}_joint" type="continuous">',
            f'<joint name="{side}_joint" type="revolute">'
            '<limit lower="-1000" upper="1000" effort="9" velocity="99"/>',
        )
    assert bench.find(text, RULE)
    assert {each.severity for each in bench.find(text, "drive-joint-not-continuous")} == {"info"}
    near = text.replace("1000", "180")
    assert {each.severity for each in bench.find(near, "drive-joint-not-continuous")} == {"warning"}


def drive(*more):
    """Two driven wheels beside a body, and further links."""
    wheel = f'<cylinder radius="{RADIUS}" length="0.02"/>'
    text = link("base_link", 2, '<box size="0.2 0.1 0.02"/>')
    for name, y in (("left", 0.1), ("right", -0.1)):
        text += link(name, 0.2, wheel, "1.5708 0 0") + joint(name, "continuous", f"0 {y} 0")
    return f"""<robot name="cart">{text}{"".join(more)}<gazebo><plugin name="drive"
      filename="libgazebo_ros_diff_drive.so"><leftJoint>left_joint</leftJoint>
      <rightJoint>right_joint</rightJoint><wheelSeparation>0.2</wheelSeparation>
      <wheelDiameter>{2 * RADIUS}</wheelDiameter></plugin></gazebo></robot>"""


def balanced(tmp_path, text):
    path = tmp_path / "cart.urdf"
    path.write_text(text)
    return [each for each in cartwheel.check(path).findings if each.code is UNBALANCED]


@pytest.mark.parametrize(("z", "tilt"), [(-0.03, None), (-0.025, None), (-0.005, 0.16)])
def test_a_robot_whose_casters_are_too_high_tilts(tmp_path, z, tilt):
    """A ball of 0.02 m at 0.15 m ahead, so its centre should be 0.03 m below the axle."""
    ball = f'<sphere radius="{BALL}"/>'
    more = link("ball", 1.0, ball) + joint("ball", "fixed", f"0.15 0 {z}")
    found = balanced(tmp_path, drive(more))
    if tilt is None:
        assert found == []
        return
    (finding,) = found
    # Tangent to the wheel and to the ball: the difference of the radii and heights over 0.15 m.
    assert finding.values["tilt"] == pytest.approx(tilt, abs=0.02)


@pytest.mark.wording
def test_a_robot_whose_weight_is_beside_its_level_wheels_tips_onto_it(tmp_path):
    """The ball is as low as the wheels, but the ballast is beside the line from it to a wheel."""
    ball = link("ball", 0.1, '<sphere radius="0.02"/>')
    ball += joint("ball", "fixed", f"0.09 0 {0.02 - RADIUS}")
    ballast = link("ballast", 20.0, '<box size="0.02 0.02 0.02"/>')
    ballast += joint("ballast", "fixed", f"0.08 0.08 {0.018 - RADIUS}")
    (finding,) = balanced(tmp_path, drive(ball + ballast))
    assert 'outside the area between "left", "right" and "ball", which' in finding.message
    assert finding.message.endswith('° onto "ballast"')


@pytest.mark.wording
def test_a_robot_whose_caster_is_too_high_names_what_it_rests_on(tmp_path):
    ball = link("ball", 5.0, '<sphere radius="0.01"/>') + joint("ball", "fixed", "0.15 0 0")
    (finding,) = balanced(tmp_path, drive(ball))
    assert "different heights" in finding.message
    assert finding.message.endswith('° on "left", "right" and "ball"')


def test_a_robot_on_two_wheels_is_reported(tmp_path):
    (finding,) = balanced(tmp_path, drive())
    assert finding.values["outside"] == 0.0


def pendulum(height):
    """A tall body whose centre of mass is above or below the axle, and ahead of it by 0.01 m."""
    mast = f'<box size="0.02 0.02 {abs(height) / 2}"/>'
    return drive(link("mast", 5.0, mast) + joint("mast", "fixed", f"0.01 0 {height}"))


@pytest.mark.parametrize(("height", "falls"), [(0.5, True), (-0.02, False)])
def test_a_pendulum_on_two_wheels_does_not_rest_where_it_balances(tmp_path, height, falls):
    """Both wheels have the same height: it does not tilt because of different heights."""
    (finding,) = balanced(tmp_path, pendulum(height))
    assert finding.values["outside"] == 0.0
    assert "tilt" not in finding.values
    assert finding.values["falls"] == falls


@pytest.mark.wording
@pytest.mark.parametrize(("length", "how"), [(0.4, "tips by"), (0.08, "falls over by")])
def test_a_robot_on_two_wheels_tips_until_its_body_touches_the_ground(tmp_path, length, how):
    """An edge at x, z from the axle touches at the angle from straight down to it, less that at
    which an edge at its distance touches. The front edge of a short body never does, but the top
    of the mast, which is ahead.
    """
    text = pendulum(0.5).replace("0.2 0.1 0.02", f"{length} 0.1 0.02")
    x, z = (length / 2, -0.01) if length > 0.1 else (0.02, 0.5 + 0.25 / 2)
    angle = np.arctan2(x, -z) - np.arccos(RADIUS / np.hypot(x, z))
    (finding,) = balanced(tmp_path, text)
    assert finding.values["angle"] == pytest.approx(angle, abs=1e-3)
    assert finding.values["touches"] == ("base_link" if length > 0.1 else "mast")
    assert f"{how} {np.degrees(angle):.3g}°" in finding.message


@pytest.mark.wording
def test_angles_of_100_degrees_and_more_are_written_without_an_exponent(tmp_path):
    """A short mast touches the ground with its top only when the robot lies upside down."""
    text = pendulum(0.06).replace("0.2 0.1 0.02", "0.02 0.1 0.02").replace("0.25", "0.04")
    (finding,) = balanced(tmp_path, text)
    assert finding.values["angle"] > np.radians(100)
    assert f"by {np.degrees(finding.values['angle']):.0f}" in finding.message


@pytest.mark.parametrize(
    ("name", "shape"), [("caster", f'<box size="{BALL} {BALL} {BALL}"/>'),
                        ("knob", f'<sphere radius="{BALL / 2}"/>')]
)  # fmt: skip
def test_casters_that_do_not_reach_the_ground_are_named(tmp_path, name, shape):
    more = "".join(
        link(f"{name}_{end}", 0.1, shape) + joint(f"{name}_{end}", "fixed", f"{x} 0 -0.02")
        for end, x in (("front", 0.09), ("rear", -0.09))
    )
    dome = link("dome", 0.01, f'<sphere radius="{BALL}"/>') + joint("dome", "fixed", "0 0 0.1")
    (finding,) = balanced(tmp_path, drive(more, dome))
    assert finding.values["casters"] == (f"{name}_front", f"{name}_rear")
    # The bottom of each is half its size below its centre.
    assert finding.values["height"] == pytest.approx(RADIUS - 0.02 - BALL / 2, abs=1e-6)


def test_a_body_that_touches_the_ground_before_a_knob_has_no_casters(tmp_path):
    """A slippery part near the axle never carries the robot."""
    knob = link("knob", 0.01, '<sphere radius="0.003"/>') + joint("knob", "fixed", "0.02 0 0.02")
    (finding,) = balanced(tmp_path, drive(knob))
    assert "casters" not in finding.values


def test_a_robot_on_two_wheels_that_no_drive_names_is_reported(tmp_path):
    """A program balances it by efforts, perhaps."""
    text = drive()
    bare = text[: text.index("<gazebo>")] + "</robot>"
    (finding,) = balanced(tmp_path, bare)
    assert finding.values["outside"] == 0.0
    ball = link("ball", 1.0, f'<sphere radius="{BALL}"/>') + joint("ball", "fixed", "0.15 0 -0.03")
    assert balanced(tmp_path, bare.replace("</robot>", f"{ball}</robot>")) == []


@pytest.mark.parametrize("kind", ["visual", "collision"])
def test_balance_depends_on_collisions_only(tmp_path, kind):
    """A missing collision mesh may touch the ground, and a missing visual mesh does not."""
    lost = f'<{kind}><geometry><mesh filename="lost.stl"/></geometry></{kind}>'
    text = drive().replace("</link>", f"{lost}</link>", 1)
    assert len(balanced(tmp_path, text)) == (kind == "visual")


@pytest.mark.parametrize("kind", ["visual", "collision"])
def test_wheels_off_the_ground_depend_on_collisions_only(bench, kind):
    """A missing collision mesh may be below the wheels, and a missing visual mesh is not."""
    lost = f'<{kind}><geometry><mesh filename="lost.stl"/></geometry></{kind}>'
    scraping = drive().replace('0.2 0.1 0.02"', f'0.2 0.1 {2 * RADIUS}"')
    for text, rule in ((cart(0.0023), RULE), (scraping, "body-on-ground")):
        found = bench.find(text.replace("</link>", f"{lost}</link>", 1), rule)
        assert len(found) == (kind == "visual" or rule == RULE), rule


@pytest.mark.parametrize(("height", "falls"), [(0.5, True), (0.01, False)])
def test_a_tall_robot_on_a_small_oblique_foot_falls_over(tmp_path, height, falls):
    """A lower one comes to rest on the bottom of its foot."""
    path = tmp_path / "pole.urdf"
    path.write_text(
        f'<robot name="pole"><link name="pole"><inertial><origin xyz="0 0 {height}"/>'
        '<mass value="1"/>'
        '<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial><collision>'
        '<origin rpy="0.15 0.15 0"/><geometry><box size="0.04 0.04 0.02"/></geometry></collision>'
        f'<collision><origin xyz="0 0 {height}"/><geometry><sphere radius="0.005"/></geometry>'
        "</collision></link></robot>"
    )
    (finding,) = [f for f in cartwheel.check(path).findings if f.code is UNBALANCED]
    assert finding.values.get("falls", False) == falls
    with cartwheel.World("empty") as world:
        pole = world.spawn(path, z=0.02)
        world.run(3.0)
        tilt = np.arccos(rotate(pole.pose.orientation, (0, 0, 1))[2])
        if falls:
            assert tilt > np.pi / 4
        else:
            assert tilt == pytest.approx(finding.values["tilt"], abs=0.02)


def test_a_robot_that_tilts_onto_a_much_lower_ball_stands_and_drives_on_its_wheels(bench, make):
    text = cart(0.015, places=ONE, more=weight("0.1 0 0.05"))
    assert bench.find(text, RULE) == []
    world = make.world()
    robot = world.spawn(load_text(text), z=RADIUS + 0.02)
    world.run(1)
    start = robot.pose
    world.publish("/cmd_vel", linear_x=0.3)
    world.run(2)
    assert (start.inverse() @ robot.pose).position[0] == pytest.approx(0.6, rel=0.05)
