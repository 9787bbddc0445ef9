"""Reports of parts that no reader supports."""

from tests.coded import named

from cartwheel.description import load_text


def test_leftovers_are_notes_and_the_unknown_is_a_warning():
    robot = load_text(
        """<robot name="r">
        <link name="a" type="laser">
        <collision><geometry name="g"><box size="1 1 1"/></geometry></collision>
        <inertial><mass value="1"/>
        <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
        <link name="b"><inertial><mass value="1"/>
        <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
        </link><joint name="j" type="continuous"><parent link="a"/><child link="b"/>
        <dynamics damping="1" D="2"/><limit effort="1" velocity="1" k_velocity="3" vlocity="2"/>
        <joint_properties damping="1"/></joint></robot>"""
    )
    reported = [
        (each.severity, named(each), each.values.get("attribute", each.values["tag"]))
        for each in robot.diagnostics
    ]
    assert reported == [
        ("info", "tag-ignored", "type"),
        ("info", "tag-ignored", "name"),
        ("info", "tag-ignored", "D"),
        ("info", "tag-ignored", "k_velocity"),
        ("warning", "tag-ignored velocity", "vlocity"),
        ("info", "tag-ignored", "joint_properties"),
    ]


def test_a_box_of_no_size_at_all_is_a_frame():
    def severities(size):
        robot = load_text(
            f"""<robot name="r"><link name="a"><visual><geometry><box size="{size}"/></geometry>
            </visual><inertial><mass value="1"/>
            <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
            </robot>"""
        )
        return [each.severity for each in robot.diagnostics]

    assert severities("0 0 0") == ["info"]
    assert severities("0 1 1") == ["warning"]
