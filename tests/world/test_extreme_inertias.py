"""Inertias at the edge of what the engine takes."""

from cartwheel.description import load_text


def test_a_rod_without_thickness_can_stand(make):
    """Its moment about itself is zero, which the engine would refuse even where nothing moves."""
    rod = make.sdf(
        """<model name="rod"><static>true</static><link name="l"><inertial><mass>80</mass><inertia>
        <ixx>14.6</ixx><iyy>0</iyy><izz>14.6</izz></inertia></inertial></link></model>"""
    )
    model = make.world(rod, ground=None).session.simulation.model
    found = sorted(model.body_inertia[model.body("rod::l").id])
    assert 0 < found[0] < 1e-4
    assert abs(found[2] - 14.6) < 1e-4


def test_a_point_mass_fixed_to_another_body_adds_its_mass(make):
    """Stands off its holder: together they swing as a body with m r² more."""
    robot = load_text(
        """<robot name="r"><link name="world"/><link name="arm"><inertial><mass value="1"/>
        <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
        </link><link name="tip"><inertial>
        <mass value="2"/></inertial></link>
        <joint name="hinge" type="continuous"><parent link="world"/><child link="arm"/>
        <axis xyz="0 0 1"/></joint>
        <joint name="weld" type="fixed"><parent link="arm"/><child link="tip"/>
        <origin xyz="0.5 0 0"/></joint></robot>"""
    )
    model = make.world(robot, ground=None).session.simulation.model
    assert abs(model.dof_M0[0] - (0.1 + 2 * 0.5**2)) < 1e-5


def test_a_part_that_weighs_next_to_nothing_is_built(make):
    """As drawing programs write a frame without a body: masses of 1e-15 kg."""
    robot = load_text(
        """<robot name="r"><link name="base"><inertial><mass value="3"/>
        <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
        </link><link name="frame"><inertial>
        <mass value="4.19E-15"/><inertia ixx="1.68E-27" iyy="1.68E-27" izz="1.68E-27" ixy="0"
        ixz="7.68E-44" iyz="0"/></inertial></link><joint name="weld" type="fixed">
        <parent link="base"/><child link="frame"/></joint></robot>"""
    )
    model = make.world(robot, ground=None).session.simulation.model
    assert abs(model.body_subtreemass[0] - 3.0) < 1e-9


def test_a_robot_fixed_to_the_world_is_hulls_and_a_static_model_its_surface(make, tmp_path):
    """A cup: five walls of a box. Inside it a static model is empty."""
    x = [[a, b, c] for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)]
    walls = [(0, 2, 6, 4), (0, 4, 5, 1), (2, 3, 7, 6), (0, 1, 3, 2), (4, 6, 7, 5)]
    text = "".join("v " + " ".join(map(str, corner)) + "\n" for corner in x)
    text += "".join("f " + " ".join(str(i + 1) for i in wall) + "\n" for wall in walls)
    (tmp_path / "cup.obj").write_text(text)

    def geoms(static):
        robot = load_text(
            f"""<robot name="r"><link name="world"/><link name="cup"><collision><geometry>
            <mesh filename="file://{tmp_path}/cup.obj"/></geometry></collision></link>
            <joint name="j" type="fixed"><parent link="world"/><child link="cup"/></joint>
            <gazebo><static>{static}</static></gazebo></robot>"""
        )
        return make.world(robot, ground=None).session.simulation.model.ngeom

    assert geoms("false") == 1
    assert geoms("true") == 5
