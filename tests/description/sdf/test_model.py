"""What SDF says of links, shapes, surfaces, joints and sensors, and what is wrong with them."""

from __future__ import annotations

import math

import pytest
from PIL import Image
from tests.coded import named, raises

from cartwheel.codes import files, tags
from cartwheel.codes.robot import INERTIA_IMPOSSIBLE, MIMIC_UNKNOWN
from cartwheel.description import load_text
from cartwheel.description import model as m
from cartwheel.description.elements.xml import parse
from cartwheel.description.files.packages import Packages
from cartwheel.description.sdf import read_sdf
from cartwheel.errors import DescriptionError
from cartwheel.geometry import Pose


def robot(inside: str, version: str = "1.7", folder=None):
    text = f'<sdf version="{version}">\n<model name="m">\n{inside}\n</model></sdf>'
    file = folder / "m.sdf" if folder else None
    return read_sdf(parse(text, str(file or "m.sdf")), Packages(file, environment={}))


def link(inside: str, **more):
    return robot(f'<link name="base">\n{inside}</link>', **more)


def shape(geometry: str, folder=None):
    text = f'<visual name="v"><geometry>{geometry}</geometry></visual>'
    found = link(text, folder=folder)
    visuals = found.links[0].visuals
    return visuals[0].shape if visuals else None


@pytest.mark.parametrize(
    ("geometry", "expected"),
    [
        ("<box><size>1 2 3</size></box>", m.Box(size=(1, 2, 3))),
        ("<sphere><radius>.5</radius></sphere>", m.Sphere(radius=0.5)),
        (
            "<cylinder><radius>1</radius><length>2</length></cylinder>",
            m.Cylinder(radius=1, length=2),
        ),
        ("<capsule><radius>1</radius><length>2</length></capsule>", m.Capsule(radius=1, length=2)),
        ("<cone><radius>1</radius><length>2</length></cone>", m.Cone(radius=1, length=2)),
        ("<ellipsoid><radii>1 2 3</radii></ellipsoid>", m.Ellipsoid(radii=(1, 2, 3))),
        ("<plane/>", m.Plane()),
        (
            "<plane><normal>1 0 0</normal><size>4 5</size></plane>",
            m.Plane(normal=(1, 0, 0), size=(4, 5)),
        ),
        (
            "<polyline><point>0 0</point><point>1 0</point><point>0 1</point>"
            "<height>2</height></polyline>",
            m.Polyline(points=((0, 0), (1, 0), (0, 1)), height=2),
        ),
        ("<empty/>", None),
    ],
)
def test_shapes(geometry, expected):
    assert shape(geometry) == expected


def test_mesh_and_heightmap(tmp_path):
    (tmp_path / "part.obj").write_text("o lid\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    Image.new("L", (3, 3), 255).save(tmp_path / "hills.png")
    found = shape(
        "<mesh><uri>part.obj</uri><scale>1 1 -2</scale>"
        "<submesh><name>lid</name><center>true</center></submesh></mesh>",
        tmp_path,
    )
    assert found == m.Mesh(
        uri="part.obj",
        path=tmp_path / "part.obj",
        scale=(1, 1, -2),
        submesh="lid",
        center_submesh=True,
    )
    hills = "<heightmap><uri>hills.png</uri><size>10 10 3</size><pos>0 0 1</pos></heightmap>"
    assert shape(hills, tmp_path) == m.Heightmap(
        path=tmp_path / "hills.png", size=(10, 10, 3), position=(0, 0, 1)
    )


def test_a_heightmap_without_height_is_level_ground(tmp_path):
    Image.new("L", (3, 3), 255).save(tmp_path / "field.png")
    field = "<heightmap><uri>field.png</uri><size>10 10 0.0</size></heightmap>"
    ground = f'<model name="m"><link name="l"><collision name="c"><geometry>{field}</geometry>'
    text = f'<sdf version="1.9">{ground}</collision></link></model></sdf>'
    found = read_sdf(parse(text, str(tmp_path / "m.sdf")), Packages(environment={}))
    assert found.links[0].collisions[0].shape.size == (10, 10, 0.001)
    (warning,) = (each for each in found.diagnostics if each.severity == "warning")
    assert (warning.code, warning.values["stated"]) == (tags.VALUE_IGNORED, "10 10 0.0")


@pytest.mark.parametrize(
    ("geometry", "expected", "missing"),
    [
        ("<box/>", m.Box(size=(1, 1, 1)), ["size"]),
        ("<sphere/>", m.Sphere(radius=1), ["radius"]),
        ("<ellipsoid/>", m.Ellipsoid(radii=(1, 1, 1)), ["radii"]),
        ("<cylinder/>", m.Cylinder(radius=1, length=1), ["radius", "length"]),
        ("<cone><radius>2</radius></cone>", m.Cone(radius=2, length=1), ["length"]),
    ],
)
def test_a_measure_that_is_not_stated_is_1_m(geometry, expected, missing):
    found = link(f'<visual name="v"><geometry>{geometry}</geometry></visual>')
    assert found.links[0].visuals[0].shape == expected
    assert [reported.values["missing"] == tag for tag, reported in
            zip(missing, found.diagnostics, strict=True)] == [True] * len(missing)  # fmt: skip


@pytest.mark.parametrize("geometry", ["", "<geometry/>"])
def test_a_part_without_a_shape_is_left_out(geometry):
    found = link(f'<collision name="c">{geometry}</collision>')
    assert found.links[0].collisions == ()
    (reported,) = found.diagnostics
    assert reported.severity == "warning"
    assert (reported.values["left_out"], reported.values["element"]) == ("collision", "c")


def test_a_mesh_without_the_submesh_costs_the_one_shape(tmp_path):
    (tmp_path / "part.obj").write_text("o lid\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    found = link(
        """<visual name="v"><geometry><mesh><uri>part.obj</uri><submesh><name>lip</name></submesh>
        </mesh></geometry></visual>""",
        folder=tmp_path,
    )
    assert found.links[0].visuals == ()
    (reported,) = found.diagnostics
    assert reported.severity == "error"
    assert named(reported) == "mesh-unreadable lid"


def test_one_scale_counts_for_all_axes_and_none_costs_the_shape(tmp_path):
    (tmp_path / "part.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    mesh = "<mesh><uri>part.obj</uri><scale>{}</scale></mesh>"
    assert shape(mesh.format("2"), tmp_path).scale == (2, 2, 2)
    assert shape(mesh.format("1 0 1"), tmp_path) is None


def test_nested_models_of_one_name_are_distinguished():
    inner = '<model name="n"><link name="a"/></model>'
    found = robot(inner + inner)
    assert sorted(each.name for each in found.links) == ["n::a", "n_1::a"]


def test_a_missing_mesh_costs_the_one_shape(tmp_path):
    found = link(
        """<visual name="v"><geometry><mesh><uri>model://nowhere/a.dae</uri></mesh></geometry>
        </visual><visual name="w"><geometry><empty/></geometry></visual>
        <collision name="c"><geometry><box><size>1 1 1</size></box></geometry></collision>""",
        folder=tmp_path,
    )
    assert found.links[0].visuals == ()
    assert len(found.links[0].collisions) == 1
    (reported,) = found.diagnostics
    assert reported.severity == "error"
    assert reported.values["left_out"] == "visual"
    assert reported.origin.line == 4


def test_default_and_stated_inertia():
    plain = link("").links[0].inertial
    assert (plain.mass, plain.ixx, plain.iyy, plain.izz, plain.ixy) == (1, 1, 1, 1, 0)
    stated = (
        link(
            """<inertial><mass>2</mass><inertia><ixx>0.1</ixx><iyy>0.2</iyy><izz>0.25</izz>
        <ixy>0.01</ixy></inertia></inertial>"""
        )
        .links[0]
        .inertial
    )
    assert (stated.mass, stated.ixx, stated.iyy, stated.izz) == (2, 0.1, 0.2, 0.25)
    assert (stated.ixy, stated.ixz, stated.iyz) == (0.01, 0, 0)


def solid(geometry: str, folder=None):
    return (
        link(
            f"""<inertial auto="true"/><collision name="c"><pose>1 0 0 0 0 0</pose>
        <density>2</density><geometry>{geometry}</geometry></collision>""",
            folder=folder,
        )
        .links[0]
        .inertial
    )


def test_inertia_from_collisions():
    # Volume 1*2*3 = 6, mass 12; ixx = 12/12 (4 + 9), iyy = 1 + 9, izz = 1 + 4.
    box = solid("<box><size>1 2 3</size></box>")
    assert (box.mass, box.ixx, box.iyy, box.izz) == pytest.approx((12, 13, 10, 5))
    assert box.pose.position == (1, 0, 0)
    cone = solid("<cone><radius>1</radius><length>4</length></cone>")
    assert cone.pose.position == pytest.approx((1, 0, -1))
    assert cone.mass == pytest.approx(2 * math.pi * 4 / 3)
    # A capsule without length is a ball, one without ends' radius a cylinder.
    ball = solid("<sphere><radius>1</radius></sphere>")
    capsule = solid("<capsule><radius>1</radius><length>1e-9</length></capsule>")
    assert (capsule.mass, capsule.ixx, capsule.izz) == pytest.approx(
        (ball.mass, ball.ixx, ball.izz)
    )


def test_a_capsule_s_inertia_by_integration():
    """Discs along the axis: dm r²/4 + dm z², summed."""
    capsule = solid("<capsule><radius>0.5</radius><length>2</length></capsule>")
    steps = 200_000
    z = [(-1.5 + 3 * (i + 0.5) / steps) for i in range(steps)]
    square = [0.25 if abs(h) < 1 else 0.25 - (abs(h) - 1) ** 2 for h in z]
    masses = [2 * math.pi * s * 3 / steps for s in square]
    assert capsule.mass == pytest.approx(sum(masses), rel=1e-6)
    side = sum(w * (s / 4 + h * h) for w, s, h in zip(masses, square, z, strict=True))
    assert capsule.ixx == pytest.approx(side, rel=1e-6)
    axial = sum(w * s / 2 for w, s in zip(masses, square, strict=True))
    assert capsule.izz == pytest.approx(axial, rel=1e-6)


def test_inertia_of_a_mesh_is_that_of_its_solid(tmp_path):
    corners = [(x, y, z) for x in (0, 1) for y in (0, 2) for z in (0, 3)]
    sides = ["1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4"]
    text = "".join(f"v {x} {y} {z}\n" for x, y, z in corners)
    (tmp_path / "box.obj").write_text(text + "".join(f"f {side}\n" for side in sides))
    found = solid("<mesh><uri>box.obj</uri></mesh>", tmp_path)
    assert found.pose.position == pytest.approx((1.5, 1, 1.5))
    assert (found.mass, found.ixx, found.iyy, found.izz) == pytest.approx((12, 13, 10, 5))
    assert (found.ixy, found.ixz, found.iyz) == pytest.approx((0, 0, 0), abs=1e-9)


def test_inertia_of_two_collisions_and_a_stated_mass():
    found = (
        link(
            """<inertial auto="true"><mass>4</mass></inertial>
        <collision name="a"><pose>-1 0 0 0 0 0</pose><geometry><sphere><radius>0.1</radius>
          </sphere></geometry></collision>
        <collision name="b"><pose>1 0 0 0 0 0</pose><geometry><sphere><radius>0.1</radius>
          </sphere></geometry></collision>"""
        )
        .links[0]
        .inertial
    )
    # Two balls of 2 kg: 0.4 m r² each, and m 1² about the middle for the cross axes.
    assert found.mass == 4
    assert found.ixx == pytest.approx(2 * 0.4 * 2 * 0.01)
    assert found.izz == pytest.approx(2 * 0.4 * 2 * 0.01 + 4)


def test_surface():
    found = link(
        """<collision name="c"><max_contacts>4</max_contacts><laser_retro>7</laser_retro>
        <geometry><plane/></geometry><surface>
        <friction><ode><mu>0.5</mu><mu2>0.25</mu2><fdir1>0 1 0</fdir1><slip1>0.1</slip1>
          <slip2>0.2</slip2></ode><torsional><coefficient>0.75</coefficient></torsional></friction>
        <contact><collide_bitmask>0x0f</collide_bitmask><ode><kp>1e6</kp><kd>100</kd>
          <max_vel>0.1</max_vel><min_depth>0.001</min_depth></ode></contact>
        <bounce><restitution_coefficient>0.5</restitution_coefficient><threshold>1</threshold>
        </bounce></surface></collision>"""
    )
    collision = found.links[0].collisions[0]
    assert collision.laser_retro == 7
    assert collision.surface == m.Surface(
        mu1=0.5, mu2=0.25, fdir1=(0, 1, 0), slip1=0.1, slip2=0.2, torsional=0.75, kp=1e6, kd=100,
        min_depth=0.001, max_vel=0.1, max_contacts=4, restitution=0.5,
        bounce_threshold=1,
        collide_bitmask=15, patch_radius=0,
    )  # fmt: skip
    assert found.diagnostics == ()


def test_friction_below_zero_is_as_if_not_stated():
    found = link(
        """<collision name="c"><geometry><plane/></geometry><surface><friction><ode><mu>-1</mu>
        <fdir1>0 0 0</fdir1></ode></friction></surface></collision>"""
    )
    assert found.links[0].collisions[0].surface == m.Surface()
    assert found.diagnostics[0].values["stated"] == -1


def test_material_and_visual():
    found = link(
        """<visual name="v"><transparency>0.5</transparency><cast_shadows>0</cast_shadows>
        <geometry><plane/></geometry><material><ambient>1 0 0 1</ambient>
        <diffuse>0 1 0 0.5</diffuse><specular>0.3 0.3 0.3 1</specular>
        <emissive>0 0 1</emissive></material></visual>
        <visual name="w"><geometry><plane/></geometry><material><ambient>1 0 0</ambient></material>
        </visual><visual name="x"><geometry><plane/></geometry></visual>"""
    )
    first, second, third = found.links[0].visuals
    assert first.transparency == 0.5
    assert not first.cast_shadows
    assert first.material.diffuse == (0, 1, 0, 0.5)
    assert first.material.specular == pytest.approx(0.3)
    assert first.material.emissive == (0, 0, 1, 1)
    assert second.material.diffuse == (1, 0, 0, 1)
    assert third.material.diffuse is None


def test_material_script_of_a_model(tmp_path):
    scripts, textures = tmp_path / "materials" / "scripts", tmp_path / "materials" / "textures"
    scripts.mkdir(parents=True)
    textures.mkdir()
    (textures / "brick.png").write_bytes(b"")
    (scripts / "my.material").write_text(
        """material Other { technique { pass { diffuse 0 0 0 } } }
        material My/Brick // a comment
        {
          technique { pass {
            ambient 0.1 0.1 0.1 1
            diffuse 0.5 0.25 0 1
            texture_unit { texture brick.png } } }
        }"""
    )
    text = """<visual name="v"><geometry><plane/></geometry><material><script>
      <uri>materials/scripts</uri><uri>materials/textures</uri><name>{}</name>
      </script></material></visual>"""
    found = link(text.format("My/Brick"), folder=tmp_path)
    material = found.links[0].visuals[0].material
    assert material.name == "My/Brick"
    assert material.diffuse == (0.5, 0.25, 0, 1)
    assert material.texture == textures / "brick.png"
    assert material.texture_scale == (1.0, 1.0)
    assert found.diagnostics == ()
    unknown = link(text.format("My/Brck"), folder=tmp_path)
    assert unknown.links[0].visuals[0].material.name == "My/Brck"
    assert unknown.diagnostics[0].values["name"] == "My/Brck"


@pytest.mark.parametrize(
    ("said", "scale"),
    [
        ("scale 0.25 0.5", (0.25, 0.5)),
        ("scale 0 1", (1.0, 1.0)),
        ("scale 2", (1.0, 1.0)),
        ("scale wide 1", (1.0, 1.0)),
        ("scale inf 1", (1.0, 1.0)),
    ],
)
def test_a_script_scales_its_texture(tmp_path, said, scale):
    """Without a diffuse colour of its own, and never with the ambient one, as OGRE has it."""
    (tmp_path / "floor.png").write_bytes(b"")
    (tmp_path / "my.material").write_text(
        f"""material My/Floor {{ technique {{ pass {{ ambient 0.1 0.2 0.3 1
        texture_unit {{
          texture floor.png
          {said}
        }} }} }} }}"""
    )
    text = """<visual name="v"><geometry><plane/></geometry><material><script>
      <uri>my.material</uri><name>My/Floor</name></script><ambient>0.3 0.3 0.3 1</ambient>
      </material></visual>"""
    material = link(text, folder=tmp_path).links[0].visuals[0].material
    assert material.texture == tmp_path / "floor.png"
    assert material.texture_scale == scale
    assert material.diffuse is None


def test_gazebo_material_by_name():
    found = link(
        """<visual name="v"><geometry><plane/></geometry><material><script>
        <uri>file://media/materials/scripts/gazebo.material</uri><name>Gazebo/Red</name></script>
        </material></visual>"""
    )
    red, green, blue, _ = found.links[0].visuals[0].material.diffuse
    assert red > 0.5 > green == blue
    assert found.diagnostics == ()


def test_link_flags():
    found = link(
        """<gravity>0</gravity><self_collide>true</self_collide><kinematic>1</kinematic>
        <velocity_decay><linear>0.1</linear><angular>0.2</angular></velocity_decay>
        <enable_wind>false</enable_wind>"""
    )
    part = found.links[0]
    assert (part.gravity, part.self_collide, part.kinematic) == (False, True, True)
    assert (part.linear_damping, part.angular_damping) == (0.1, 0.2)
    assert link("").links[0].self_collide is None
    nested = """<self_collide>{}</self_collide><link name="a"/>
      <model name="in"><self_collide>{}</self_collide><link name="b"/></model>"""
    for outer, inner, expected in ((0, 1, True), (1, 0, False), (1, 1, None)):
        found = robot(nested.format(outer, inner))
        assert [each.self_collide for each in found.links] == [None, expected]
    assert robot("<static>1</static><self_collide>1</self_collide><link name='a'/>").static


def joint(kind: str, inside: str, version: str = "1.7"):
    found = robot(
        f"""<link name="a"/><link name="b"/><joint name="j" type="{kind}">
        <parent>a</parent><child>b</child>{inside}</joint>""",
        version,
    )
    return found.joint("j")


def test_joint_axis_limits_and_dynamics():
    found = joint(
        "revolute",
        """<axis><xyz>0 2 0</xyz><limit><lower>-1</lower><upper>2</upper><effort>10</effort>
        <velocity>3</velocity></limit><dynamics><damping>0.1</damping><friction>0.2</friction>
        <spring_reference>0.3</spring_reference><spring_stiffness>4</spring_stiffness></dynamics>
        </axis><physics><ode><limit><cfm>0.5</cfm><erp>0.6</erp></limit>
        <implicit_spring_damper>1</implicit_spring_damper>
        <provide_feedback>true</provide_feedback></ode></physics>""",
    )
    assert found.axis == m.Axis(
        xyz=(0, 1, 0), lower=-1, upper=2, effort=10, velocity=3, damping=0.1, friction=0.2,
        spring_reference=0.3, spring_stiffness=4,
    )  # fmt: skip
    assert (found.stop_cfm, found.stop_erp) == (0.5, 0.6)
    assert found.provide_feedback
    assert found.implicit_spring_damper


def test_unlimited_is_none():
    found = joint(
        "prismatic",
        """<axis><xyz>1 0 0</xyz><limit><lower>-1e16</lower><upper>inf</upper><effort>-1</effort>
        <velocity>-1</velocity></limit></axis>""",
    )
    assert (found.axis.lower, found.axis.upper) == (None, None)
    assert (found.axis.effort, found.axis.velocity) == (None, None)


@pytest.mark.parametrize(
    ("written", "kind"),
    [("fixed", "fixed"), ("ball", "ball"), ("continuous", "continuous"), ("screw", "screw"),
     ("universal", "universal"), ("revolute2", "universal")],
)  # fmt: skip
def test_joint_types(written, kind):
    axes = "" if kind in ("fixed", "ball") else "<axis><xyz>1 0 0</xyz></axis>"
    axes += "<axis2><xyz>0 1 0</xyz></axis2>" if kind == "universal" else ""
    found = joint(written, axes)
    assert found.type == kind
    if kind == "universal":
        assert found.axis2.xyz == (0, 1, 0)


def test_images_beside_the_colour_are_notes(tmp_path):
    Image.new("RGB", (2, 2)).save(tmp_path / "a.png")
    inside = """<material><pbr><metal><albedo_map>a.png</albedo_map><roughness_map>r.png
      </roughness_map><shine>1</shine></metal></pbr></material>"""
    visual = f'<visual name="v"><geometry><sphere><radius>1</radius></sphere></geometry>{inside}'
    found = robot(f'<link name="a">{visual}</visual></link>', folder=tmp_path)
    assert [(each.severity, each.values["tag"]) for each in found.diagnostics] == [
        ("info", "roughness_map"),
        ("warning", "shine"),
    ]


def test_a_ball_turns_freely_whatever_its_axis_says():
    axis = "<axis><xyz>0 0 1</xyz><dynamics><damping>10</damping></dynamics></axis>"
    found = robot(BAD_JOINT.format("ball", ENDS + axis))
    assert found.joint("j").axis == m.Axis()
    (reported,) = found.diagnostics
    assert (named(reported), reported.values["tag"]) == ("not-simulated", "axis")


@pytest.mark.parametrize(("first", "second"), [("0 0 1", (0, 1, 0)), ("0 1 0", (1, 0, 0))])
def test_a_universal_joint_without_a_second_axis_takes_y_where_it_can(first, second):
    found = robot(BAD_JOINT.format("universal", f"{ENDS}<axis><xyz>{first}</xyz></axis>"))
    assert found.joint("j").axis2.xyz == second
    (reported,) = found.diagnostics
    assert (named(reported), reported.values["missing"]) == ("default-used", "axis2")


def test_a_joint_without_an_axis_turns_about_z():
    found = robot(BAD_JOINT.format("revolute", ENDS))
    assert found.joint("j").axis.xyz == (0, 0, 1)
    (reported,) = found.diagnostics
    assert (named(reported), reported.values["missing"]) == ("default-used", "axis")


def test_a_fixed_joint_may_name_the_world_as_its_child():
    found = robot(BAD_JOINT.format("fixed", "<parent>a</parent><child>world</child>"))
    assert (found.joint("j").parent, found.joint("j").child) == ("world", "a")


def test_a_joint_may_stand_on_the_frame_of_another_joint_or_model():
    found = robot(
        f"""<link name="a"/><link name="b"/><link name="c"/>
        <model name="n"><pose>0 0 1 0 0 0</pose><link name="d"/></model>
        <joint name="j" type="fixed"><parent>c</parent><child>k</child></joint>
        <joint name="k" type="fixed">{ENDS}</joint>
        <joint name="l" type="fixed"><parent>__model__</parent><child>n::__model__</child>
        </joint>"""
    )
    ends = [(joint.parent, joint.child) for joint in found.joints]
    assert ends == [("c", "b"), ("a", "b"), ("a", "n::d")]


def test_an_empty_pose_may_say_how_it_would_be_written():
    found = robot(
        '<link name="a"><pose degrees="true"/></link>'
        '<link name="b"><pose rotation_format="quat_xyzw" degrees="false"/></link>'
    )
    assert found.diagnostics == ()


def test_screw_pitch_is_metres_per_turn():
    axis = "<axis><xyz>1 0 0</xyz></axis>"
    assert (
        joint("screw", f"{axis}<screw_thread_pitch>0.01</screw_thread_pitch>").thread_pitch == 0.01
    )
    older = joint("screw", f"{axis}<thread_pitch>-100</thread_pitch>").thread_pitch
    assert older == pytest.approx(2 * math.pi / 100)


def test_mimic_with_a_reference():
    found = robot(
        """<link name="a"/><link name="b"/><link name="c"/>
        <joint name="lead" type="revolute"><parent>a</parent><child>b</child><axis/></joint>
        <joint name="j" type="revolute"><parent>a</parent><child>c</child><axis>
          <mimic joint="lead"><multiplier>2</multiplier><offset>1</offset>
          <reference>0.25</reference></mimic></axis></joint>""",
        "1.11",
    )
    # q = 2 (lead - 0.25) + 1
    assert found.joint("j").mimic == m.Mimic(joint="lead", multiplier=2, offset=0.5)


@pytest.mark.parametrize("kind", ["fixed", "ball"])
def test_a_joint_cannot_mimic_one_without_a_position(kind):
    with raises(MIMIC_UNKNOWN, joint="j", name="lead"):
        robot(
            f"""<link name="a"/><link name="b"/><link name="c"/>
            <joint name="lead" type="{kind}"><parent>a</parent><child>b</child></joint>
            <joint name="j" type="revolute"><parent>a</parent><child>c</child><axis>
              <mimic joint="lead"><multiplier>2</multiplier></mimic></axis></joint>""",
            "1.11",
        )


def test_a_joint_without_a_position_cannot_mimic_another():
    found = robot(
        """<link name="a"/><link name="b"/><link name="c"/>
        <joint name="lead" type="revolute"><parent>a</parent><child>b</child><axis/></joint>
        <joint name="j" type="ball"><parent>a</parent><child>c</child><axis>
          <mimic joint="lead"><multiplier>2</multiplier></mimic></axis></joint>""",
        "1.11",
    )
    assert found.joint("j").mimic is None
    (said,) = (each for each in found.diagnostics if each.code is MIMIC_UNKNOWN)
    assert (said.severity, said.values["joint"]) == ("warning", "j")


def test_sensors_and_plugins():
    found = link(
        """<sensor name="eye" type="camera"><pose>0 0 1 0 0 0</pose><update_rate>30</update_rate>
          <always_on>1</always_on><visualize>true</visualize><topic>front</topic>
          <camera name="left"><horizontal_fov>1.2</horizontal_fov>
            <image><width>640</width><height>480</height><format>L8</format></image>
            <clip><near>0.02</near><far>50</far></clip>
            <noise><type>gaussian</type><mean>0.1</mean><stddev>0.007</stddev></noise>
            <distortion><k1>-0.25</k1><k2>0.12</k2><k3>0.01</k3><p1>-0.0003</p1><p2>-0.00005</p2>
              <center>0.4 0.6</center></distortion></camera>
          <plugin name="p" filename="libgazebo_ros_camera.so"><frameName>eye</frameName></plugin>
        </sensor>
        <sensor name="bump" type="contact"><contact><collision>c1</collision>
          <collision>c2</collision></contact></sensor>"""
    )
    eye, bump = found.links[0].sensors
    assert (eye.link, eye.type, eye.update_rate, eye.topic) == ("base", "camera", 30, "front")
    assert eye.always_on
    assert eye.visualize
    assert eye.pose.position == (0, 0, 1)
    assert eye.cameras == (
        m.CameraIntrinsics(
            name="left", horizontal_fov=1.2, width=640, height=480, format="L8", near=0.02, far=50,
            k1=-0.25, k2=0.12, k3=0.01, p1=-0.0003, p2=-0.00005, distortion_center=(0.4, 0.6),
            noise_mean=0.1, noise_stddev=0.007,
        ),
    )  # fmt: skip
    (plugin,) = eye.plugins
    assert (plugin.name, plugin.filename) == ("p", "libgazebo_ros_camera.so")
    assert plugin.element.find("frameName").text == "eye"
    assert bump.collisions == ("c1", "c2")
    assert found.diagnostics == ()


def test_a_gripper_is_reported_as_idle_with_what_acts():
    text = """<sdf version="1.7"><model name="m"><link name="a"/><gripper name="g"><grasp_check>
      <attach_steps>20</attach_steps></grasp_check><gripper_link>a</gripper_link>
      <palm_link>a</palm_link></gripper></model></sdf>"""
    (reported,) = load_text(text, file="gripper.sdf").diagnostics
    assert reported.severity == "warning"
    assert (named(reported), reported.values["tag"]) == ("not-simulated", "gripper")
    assert reported.origin.line == 1


def test_a_joint_s_sensor_is_carried_by_its_child():
    found = robot(
        """<link name="a"/><link name="b"/><joint name="j" type="fixed"><pose>0 0 1 0 0 0</pose>
        <parent>a</parent><child>b</child><sensor name="ft" type="force_torque">
        <pose>1 0 0 0 0 0</pose></sensor></joint>"""
    )
    (sensor,) = found.link("b").sensors
    assert (sensor.name, sensor.link, sensor.joint) == ("ft", "b", "j")
    assert sensor.pose.position == (1, 0, 1)


FLAT = "<inertial><inertia><ixx>1</ixx><iyy>1</iyy><izz>3</izz></inertia></inertial>"
POINT = "<inertial><inertia><ixx>0</ixx><iyy>0</iyy><izz>0</izz></inertia></inertial>"


def test_a_point_mass_that_moves_has_the_inertia_of_its_shape():
    """Of a cylinder m r²/2 about its axis and m (3 r² + h²) / 12 across; it lies along x."""
    can = """<inertial><pose>0 0 0.1 0.3 0 0</pose><mass>0.3</mass><inertia><ixx>0</ixx><iyy>0</iyy>
      <izz>0</izz></inertia></inertial><collision name="c"><pose>0 0 0.1 0 1.570796326795 0</pose>
      <geometry><cylinder><radius>0.04</radius><length>0.2</length></cylinder></geometry>
      </collision>"""
    found = link(can)
    made = found.links[0].inertial
    across = 0.3 * (3 * 0.04**2 + 0.2**2) / 12
    assert (made.ixx, made.iyy, made.izz) == pytest.approx((0.3 * 0.04**2 / 2, across, across))
    assert made.pose == Pose((0, 0, 0.1))
    (reported,) = found.diagnostics
    assert (named(reported), reported.values["link"]) == ("inertia-impossible", "base")


def test_a_rod_turns_about_itself_almost_freely():
    found = link(POINT.replace("<iyy>0", "<iyy>1").replace("<izz>0", "<izz>1"))
    made = found.links[0].inertial
    assert 0 < made.ixx < 1e-3
    assert (made.iyy, made.izz) == pytest.approx((1, 1))
    assert len(found.diagnostics) == 1


def test_a_box_without_height_is_a_plate():
    """As Gazebo's building editor writes the wall above a door that reaches the ceiling."""
    found = link(
        """<visual name="v"><geometry><box><size>3.5 0.15 0</size></box></geometry></visual>"""
    )
    (visual,) = found.links[0].visuals
    assert visual.shape == m.Box(size=(3.5, 0.15, 0.001))
    assert named(found.diagnostics[0]) == "value-ignored"
    assert found.diagnostics[0].values["stated"] == "3.5 0.15 0"
    with raises(tags.VALUE_INVALID):
        link('<visual name="v"><geometry><box><size>1 1 -1</size></box></geometry></visual>')


def test_impossible_inertia_matters_where_it_moves():
    found = link(FLAT)
    (reported,) = found.diagnostics
    assert (named(reported), reported.values["link"]) == ("inertia-impossible", "base")
    assert reported.origin.line == 4
    made = found.links[0].inertial
    a, b, c = sorted((made.ixx, made.iyy, made.izz))
    assert a + b == pytest.approx(c)
    robot(f'<static>true</static><link name="a">{FLAT}</link>')
    (reported,) = link(POINT).diagnostics
    assert (reported.code, reported.severity, reported.values["link"]) == (
        INERTIA_IMPOSSIBLE,
        "info",
        "base",
    )
    with raises(INERTIA_IMPOSSIBLE, link="base", moments=(-1, 0, 0)):
        link(POINT.replace("<ixx>0", "<ixx>-1"))
    robot(
        f"""<link name="a"/><link name="b">{POINT}</link>
        <joint name="j" type="fixed"><parent>a</parent><child>b</child></joint>"""
    )


def test_what_is_not_understood_is_reported_with_its_place():
    found = link(
        """<gravty>0</gravty>
        <visual name="v" colour="red"><geometry><plane/></geometry></visual>"""
    )
    tag, attribute = sorted(found.diagnostics, key=lambda each: each.origin.line)
    assert (tag.origin.line, named(tag)) == (4, "tag-ignored gravity")
    assert (attribute.origin.line, attribute.values["attribute"]) == (5, "colour")


BAD_JOINT = '<link name="a"/><link name="b"/><joint name="j" type="{}">{}</joint>'
ENDS = "<parent>a</parent><child>b</child>"


@pytest.mark.parametrize(
    ("inside", "code"),
    [
        (BAD_JOINT.format("ball", "<parent>a</parent><child>world</child>"), "joint-link-unknown"),
        (BAD_JOINT.format("fixed", "<parent>a</parent><child>a</child>"), "kinematic-loop"),
        (BAD_JOINT.format("fixed", "<parent>a</parent>"), "tag-missing"),
        (BAD_JOINT.format("revolut", ENDS), "joint-type-unknown revolute"),
        (BAD_JOINT.format("revolute", ENDS + '<axis><mimic joint="k"/></axis>'), "mimic-unknown"),
        (BAD_JOINT.format("fixed", ENDS) + f'<joint name="j" type="fixed">{ENDS}</joint>',
         "name-taken"),
        ('<link name="a"><inertial><mass>0</mass></inertial></link>', "mass-not-positive"),
        ('<link name="a"><inertial><mass>-1e-15</mass></inertial></link>', "mass-not-positive"),
        ('<link name="a"><inertial><mass>x</mass></inertial></link>', "value-invalid"),
        ('<link name="a"><pose>0 0 x</pose></link>', "value-invalid"),
        ('<link name="a"><visual name="v"><geometry><bx/></geometry></visual></link>',
         "type-unknown box"),
        ('<link name="a"><visual name="v"><geometry><box><size>1 -1 1</size></box></geometry>'
         "</visual></link>", "value-invalid"),
        ('<link name="a"><visual name="v"><geometry><mesh/></geometry></visual></link>',
         "tag-missing"),
        ('<link name="a"/><plugin name="p"/>', "tag-missing"),
    ],
)  # fmt: skip
def test_errors(inside, code):
    with pytest.raises(DescriptionError) as caught:
        robot(inside)
    assert named(caught.value) == code
    assert caught.value.origin is not None
    assert caught.value.origin.line >= 2


@pytest.mark.parametrize(("kind", "loads"), [("fixed", True), ("revolute", False)])
def test_a_link_on_a_fixed_joint_may_have_a_mass_of_zero(kind, loads):
    """As in gz-sim, which attaches it to the other link."""
    moments = "".join(f"<i{axes}>0</i{axes}>" for axes in ("xx", "yy", "zz", "xy", "xz", "yz"))
    inertial = f"<inertial><mass>0</mass><inertia>{moments}</inertia></inertial>"
    text = f'<link name="a"/><link name="b">{inertial}</link><joint name="j" type="{kind}">{ENDS}'
    text += "<axis><xyz>0 0 1</xyz></axis></joint>"
    if not loads:
        with pytest.raises(DescriptionError) as caught:
            robot(text)
        assert named(caught.value) == "mass-not-positive"
        return
    found = robot(text)
    (warning,) = [each for each in found.diagnostics if named(each) == "mass-not-positive"]
    assert warning.severity == "warning"
    assert found.mass == pytest.approx(1.0)
    assert found.links[1].inertial is None


def test_reversed_limits_have_no_effect():
    limits = "<axis><limit><lower>1</lower><upper>0</upper></limit></axis>"
    found = robot(BAD_JOINT.format("revolute", ENDS + limits))
    (error,) = [each for each in found.diagnostics if each.severity == "error"]
    assert named(error) == "limit-reversed"
    assert error.values == {"joint": "j", "lower": 1, "upper": 0}
    (joint,) = found.joints
    assert (joint.axis.lower, joint.axis.upper) == (None, None)


@pytest.mark.parametrize(
    ("lower", "upper", "reachable"),
    [(2000, 3000, False), (-3000, -2000, False), (-3000, 3000, True), (1, 2, True)],
)
def test_limits_far_from_where_a_joint_starts_have_no_effect(lower, upper, reachable):
    limits = f"<axis><limit><lower>{lower}</lower><upper>{upper}</upper></limit></axis>"
    found = robot(BAD_JOINT.format("revolute", ENDS + limits))
    errors = [named(each) for each in found.diagnostics if each.severity == "error"]
    assert errors == ([] if reachable else ["limit-unreachable"])
    (joint,) = found.joints
    assert (joint.axis.lower is None) is not reachable


@pytest.mark.parametrize(
    ("sensor", "code"),
    [
        ('<sensor name="s"/>', "tag-missing"),
        ('<sensor name="s" type="camera"><camera><horizontal_fov>60</horizontal_fov></camera>'
         "</sensor>", "value-invalid"),
        ('<sensor name="s" type="camera"><camera><clip><near>2</near><far>1</far></clip></camera>'
         "</sensor>", "value-invalid"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("holder", ["link", "joint"])
def test_an_invalid_sensor_is_left_out(holder, sensor, code):
    good = '<sensor name="good" type="imu"/>'
    joint = f'<joint name="j" type="fixed">{ENDS}{sensor * (holder == "joint")}</joint>'
    first = f'<link name="a">{good}{sensor * (holder == "link")}</link>'
    found = robot(f'{first}<link name="b"/>{joint}')
    assert [each.name for each in found.links[0].sensors] == ["good"]
    assert not found.links[1].sensors
    (error,) = [each for each in found.diagnostics if each.severity == "error"]
    assert named(error) == code
    assert error.values["left_out"] == "sensor"
    assert error.origin is not None


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ('<sdf version="1.7"/>', "not-a-description"),
        ("<sdf/>", "sdf-version"),
        ('<sdf version="new"/>', "sdf-version"),
        ('<gazebo version="0.9"/>', "sdf-version"),
        ('<sdf version="1.7"><model name="a"/><model name="b"/></sdf>', "description-kind"),
        ('<robot name="a"/>', "not-a-description"),
    ],
)
def test_wrong_documents(text, code):
    with pytest.raises(DescriptionError) as caught:
        read_sdf(parse(text, "a.sdf"), Packages(environment={}))
    assert named(caught.value) == code


def test_an_inertia_that_is_no_number_is_the_default():
    found = link("<inertial><mass>2</mass><inertia><ixx>nan</ixx><iyy>1</iyy></inertia></inertial>")
    inertial = found.links[0].inertial
    assert (inertial.mass, inertial.ixx, inertial.iyy, inertial.izz) == (2, 1, 1, 1)
    (reported,) = found.diagnostics
    assert reported.severity == "warning"
    assert (named(reported), reported.values["missing"]) == ("default-used", "inertia")


def test_a_static_model_may_state_any_mass():
    found = robot("<static>true</static><link name='a'><inertial><mass>0</mass></inertial></link>")
    assert found.links[0].inertial is None


def test_names_with_a_prefix_are_for_other_programs_and_reported_once():
    found = robot(
        """<gz:semantics x="1"/><link name="a" my:colour="red"><gz:semantics/>
        <collision name="c"><geometry><box/></geometry><surface><friction><ode>
        <fdir1 gz:expressed_in="a">1 0 0</fdir1></ode></friction></surface></collision></link>
        <static>0</static><static>0</static>"""
    )
    infos = [reported for reported in found.diagnostics if reported.severity == "info"]
    assert [(named(reported), reported.values["tag"]) for reported in infos] == [
        ("not-simulated", "gz:semantics"),
        ("not-simulated", "my:colour"),
        ("tag-ignored", "static"),
    ]


@pytest.mark.parametrize(
    ("ends", "missing"),
    [
        ("<parent>aa</parent><child>b</child>", 'parent link "aa"'),
        ("<parent>a</parent><child>bb</child>", 'child link "bb"'),
    ],
)
def test_a_joint_to_a_link_that_is_not_there_is_left_out(ends, missing):
    found = robot(
        BAD_JOINT.format("revolute", ends + "<axis><xyz>0 0 1</xyz></axis>")
        + f'<joint name="k" type="fixed">{ENDS}</joint>'
    )
    assert [each.name for each in found.joints] == ["k"]
    (reported,) = found.diagnostics
    assert (reported.severity, reported.origin.file, reported.origin.line) == ("error", "m.sdf", 3)
    assert reported.code.name == "joint-link-unknown"
    assert (reported.values["joint"], reported.values["left_out"]) == ("j", "joint")
    assert missing == f'{reported.values["end"]} link "{reported.values["name"]}"'


def test_what_needs_a_missing_part_reports_the_missing_part():
    with raises(files.FILE_MISSING, kind="model", name="nothing_there", without="n::b"):
        robot(
            """<link name='a'><pose relative_to='n::b'>1 0 0 0 0 0</pose></link>
            <include><uri>model://nothing_there</uri><name>n</name></include>"""
        )


def test_a_second_collision_of_a_name_gets_another():
    def part(tag, name):
        return f'<{tag} name="{name}"><geometry><box/></geometry></{tag}>'

    names = ["c", "c", "c_1"]
    parts = [part("collision", name) for name in names] + [part("visual", "c")]
    found = robot(f'<link name="a">{"".join(parts)}</link>')
    (link,) = found.links
    assert [each.name for each in link.collisions] == ["c", "c_2", "c_1"]
    assert [each.name for each in link.visuals] == ["c"]
    (reported,) = [each for each in found.diagnostics if each.code.name == "name-taken"]
    assert reported.severity == "warning"
    assert reported.values["renamed"] == "c_2"


def test_a_link_may_have_two_sensors_with_the_same_name():
    """As in worlds that Gazebo Classic saved: there, fixed joints merge links with sensors."""
    sensor = '<sensor name="{}" type="{}"/>'.format
    sensors = [sensor("s", "imu"), sensor("t", "imu"), sensor("s", "camera"), sensor("s", "imu")]
    found = robot(f'<link name="a">{"".join(sensors)}</link><link name="b">{sensors[0]}</link>')
    assert [each.type for each in found.links[0].sensors] == ["imu", "imu", "camera", "imu"]
    told = [each for each in found.diagnostics if named(each) == "sensor-twice"]
    assert {(each.severity, each.values["name"]) for each in told} == {("warning", "s")}


def test_a_joint_to_a_missing_part_goes_with_it():
    found = robot(
        """<link name='a'/><include><uri>model://nothing_there</uri><name>n</name></include>
        <joint name='j' type='fixed'><parent>a</parent><child>n::b</child></joint>"""
    )
    assert not [each for each in found.joints if each.name == "j"]
    part, joint = found.diagnostics
    assert (named(part), part.values["left_out"]) == ("file-missing", "include")
    assert (named(joint), joint.values["name"]) == ("joint-link-unknown", "n::b")


def test_a_missing_part_of_a_model_costs_the_part():
    found = robot("<link name='a'/><include><uri>model://nothing_there</uri></include>")
    assert [each.name for each in found.links] == ["a"]
    (reported,) = found.diagnostics
    assert reported.severity == "error"
    assert reported.values["left_out"] == "include"


def test_ros2_control_of_a_model_is_read():
    """gz_ros2_control also reads it from SDF."""
    system = """<ros2_control name="s" type="system"><joint name="j">
      <command_interface name="velocity"/></joint></ros2_control>"""
    found = robot(
        f'<link name="base"/>{system}<model name="inner"><link name="l"/>{system}</model>'
    )
    assert [dict(each.attributes)["name"] for each in found.ros2_control] == ["s", "s"]
    assert found.diagnostics == ()


def test_a_moving_link_without_inertia_or_shape_is_a_point_mass():
    """gz-sim loads it; its demonstrations of steering contain such links."""
    none = "".join(f"<{name}>0</{name}>" for name in ("ixx", "iyy", "izz"))
    found = robot(
        f"""<link name="base"/>
        <link name="knuckle"><inertial><mass>0.1</mass><inertia>{none}</inertia></inertial></link>
        <joint name="steer" type="revolute"><parent>base</parent>
        <child>knuckle</child><axis><xyz>0 0 1</xyz></axis></joint>"""
    )
    (reported,) = found.diagnostics
    assert reported.code is INERTIA_IMPOSSIBLE
    assert reported.severity == "info"
    assert found.links[1].inertial.mass == 0.1


@pytest.mark.parametrize(
    ("geometry", "expected"),
    [
        (
            "<cylinder><radius>0.1</radius><length>0.00</length></cylinder>",
            m.Cylinder(radius=0.1, length=1e-3),
        ),
        ("<sphere><radius>0</radius></sphere>", m.Sphere(radius=1e-3)),
    ],
)
def test_a_length_of_0_is_made_a_millimetre(geometry, expected):
    found = link(f'<visual name="v"><geometry>{geometry}</geometry></visual>')
    assert found.links[0].visuals[0].shape == expected
    (reported,) = found.diagnostics
    assert (named(reported), reported.values["stated"].strip("0.")) == ("value-ignored", "")
