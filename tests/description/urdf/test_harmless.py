"""What is told of parts that nobody ever read."""

from cartwheel.description import load_text


def test_leftovers_are_notes_and_the_unknown_is_a_warning():
    robot = load_text(
        """<robot name="r">
        <link name="a" type="laser">
        <collision><geometry name="g"><box size="1 1 1"/></geometry></collision>
        <inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial></link>
        <link name="b"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial>
        </link><joint name="j" type="continuous"><parent link="a"/><child link="b"/>
        <dynamics damping="1" D="2"/><limit effort="1" velocity="1" k_velocity="3" vlocity="2"/>
        <joint_properties damping="1"/></joint></robot>"""
    )
    told = [(each.severity, each.message) for each in robot.diagnostics]
    assert told == [
        ("info", 'the attribute "type" of <link> has no effect: no reader of URDF knows it'),
        ("info", 'the attribute "name" of <geometry> has no effect: no reader of URDF knows it'),
        (
            "info",
            'the attribute "D" of <dynamics> has no effect: it is a value measured on the real '
            "arm; URDF has damping and friction",
        ),
        (
            "info",
            'the attribute "k_velocity" of <limit> has no effect: it belongs to the PR2\'s safety '
            "controller",
        ),
        (
            "warning",
            'the attribute "vlocity" of <limit> is not understood and is ignored. Did you mean '
            '"velocity"?',
        ),
        ("info", "<joint_properties> in <joint> has no effect: it is from before URDF was settled"),
    ]


def test_a_box_of_no_size_at_all_is_a_frame():
    def severities(size):
        robot = load_text(
            f"""<robot name="r"><link name="a"><visual><geometry><box size="{size}"/></geometry>
            </visual><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial></link>
            </robot>"""
        )
        return [each.severity for each in robot.diagnostics]

    assert severities("0 0 0") == ["info"]
    assert severities("0 1 1") == ["warning"]
