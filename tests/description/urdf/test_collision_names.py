"""The names of collisions: Gazebo's own, those of merged links, and the older spelling."""

from tests.coded import placed

from cartwheel.description import load_robot, load_text

BODY = (
    '<inertial><mass value="1"/>'
    '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
)
PART = '<collision><geometry><box size="1 1 1"/></geometry></collision>'


def chain(*links, tags=""):
    """Links with so many collisions each, every one fixed to the one before."""
    text = ""
    for number, (name, count) in enumerate(links):
        text += f'<link name="{name}">{BODY}{PART * count}</link>'
        if number:
            parent = links[number - 1][0]
            text += (
                f'<joint name="{name}_joint" type="fixed"><parent link="{parent}"/>'
                f'<child link="{name}"/></joint>'
            )
    return load_text(f'<robot name="r">{text}{tags}</robot>', file="r.urdf")


def names(robot, link):
    return [(each.name, each.aliases) for each in robot.link(link).collisions]


def test_all_spellings_of_a_merged_link():
    robot = chain(("base_footprint", 0), ("base_link", 1))
    assert names(robot, "base_link") == [
        (
            "base_link_collision",
            (
                "base_footprint_fixed_joint_lump__base_link_collision",
                "base_footprint_fixed_joint_lump__base_link_collision_collision",
                "base_footprint_collision_base_link",
            ),
        )
    ]


def test_own_collisions_are_numbered():
    robot = chain(("base", 3))
    assert names(robot, "base") == [
        ("base_collision", ()),
        ("base_collision_1", ()),
        ("base_collision_2", ()),
    ]


def test_numbers_count_all_that_is_merged_as_gazebo_s_do():
    robot = chain(("base", 1), ("arm", 2))
    first, second = robot.link("arm").collisions
    assert "base_fixed_joint_lump__arm_collision" in first.aliases
    assert "base_fixed_joint_lump__arm_collision_1" in first.aliases
    assert "base_fixed_joint_lump__arm_collision_2" in second.aliases
    assert "base_collision_arm_1" in second.aliases


def test_its_own_number_serves_where_no_other_has_it():
    second = chain(("base", 2), ("arm", 2)).link("arm").collisions[1]
    assert "base_fixed_joint_lump__arm_collision_1" in second.aliases
    assert "base_fixed_joint_lump__arm_collision_3" in second.aliases


def test_a_chain_is_merged_into_its_root():
    robot = chain(("base", 1), ("arm", 0), ("tip", 1))
    (tip,) = robot.link("tip").collisions
    assert "base_fixed_joint_lump__tip_collision" in tip.aliases
    assert "base_fixed_joint_lump__tip_collision_1" in tip.aliases
    assert "base_collision_tip" in tip.aliases
    assert "arm_collision_tip" in tip.aliases


def test_preserved_joints_are_not_merged():
    tags = '<gazebo reference="arm_joint"><preserveFixedJoint>true</preserveFixedJoint></gazebo>'
    robot = chain(("base", 1), ("arm", 1), ("tip", 1), tags=tags)
    assert names(robot, "arm") == [("arm_collision", ())]
    assert "arm_fixed_joint_lump__tip_collision" in robot.link("tip").collisions[0].aliases


def test_nothing_is_merged_into_the_world():
    assert names(chain(("world", 0), ("base", 1)), "base") == [("base_collision", ())]


def test_no_name_means_two_collisions():
    robot = chain(("a", 2), ("b", 3), ("c", 2))
    seen = [
        name
        for link in robot.links
        for each in link.collisions
        for name in (each.name, *each.aliases)
    ]
    assert len(seen) == len(set(seen))


def contact(name):
    return (
        '<gazebo reference="base_link"><sensor type="contact" name="bumper"><contact>'
        f"<collision>{name}</collision></contact></sensor></gazebo>"
    )


def test_contact_sensor_on_a_collision_that_does_not_exist():
    robot = chain(("foot", 0), ("base_link", 1), tags=contact("base_lnk_collision"))
    assert [placed(each) for each in robot.diagnostics] == [
        "r.urdf:1 warning contact-collision-unknown base_link_collision"
    ]


def test_contact_sensor_by_any_spelling():
    for name in (
        "base_link_collision",
        "foot_fixed_joint_lump__base_link_collision",
        "foot_collision_base_link",
        "r::foot::base_link_collision",
    ):
        robot = chain(("foot", 0), ("base_link", 1), tags=contact(name))
        assert not robot.diagnostics
        assert robot.link("base_link").sensors[0].collisions == (name,)


def test_the_cart_s_bumper():
    robot = load_robot("rosbots.xacro")
    (bumper,) = robot.link("base_link").sensors
    known = {
        name
        for link in robot.links
        for each in link.collisions
        for name in (each.name, *each.aliases)
    }
    assert set(bumper.collisions) <= known
