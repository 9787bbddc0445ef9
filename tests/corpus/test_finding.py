"""Which files of a folder are robots."""

import time

import pytest

from cartwheel.corpus import robots_in, survey
from cartwheel.description.launches import LaunchUse

LINK = (
    '<link name="{}"><inertial><mass value="1"/>'
    '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
)
XACRO = '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"{}>{}</robot>'
WHEEL = '<xacro:macro name="wheel" params="name">' + LINK.format("${name}") + "</xacro:macro>"


@pytest.fixture
def folder(tmp_path):
    def write(**files):
        for name, text in files.items():
            path = tmp_path / name.replace("__", "/").replace("_dot_", ".")
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        return [str(each.relative_to(tmp_path)) for each in robots_in(tmp_path)]

    return write


def test_files_that_only_define_macros_are_no_robots(folder):
    assert folder(wheel_dot_xacro=XACRO.format("", WHEEL)) == []


def test_a_part_that_is_included_is_no_robot_without_it(folder):
    arm = LINK.format("arm") + (
        '<joint name="shoulder" type="fixed"><parent link="base"/><child link="arm"/></joint>'
    )
    whole = '<xacro:include filename="arm.xacro"/>' + LINK.format("base")
    found = folder(
        arm_dot_xacro=XACRO.format("", arm), cart_dot_xacro=XACRO.format(' name="cart"', whole)
    )
    assert found == ["cart.xacro"]


EYE = (
    '<xacro:macro name="eye" params="parent">'
    + LINK.format("eye")
    + (
        '<joint name="neck" type="fixed"><parent link="${parent}"/><child link="eye"/></joint>'
        "</xacro:macro>"
    )
)


def test_a_part_is_found_in_a_package_whose_folder_has_another_name(folder):
    """As in a clone whose folder is named after the repository."""
    package = "<package><name>cart</name></package>"
    part = LINK.format("front") + LINK.format("rear")
    whole = '<xacro:include filename="$(find cart)/urdf/links.xacro"/>' + LINK.format("base")
    joints = "".join(
        f'<joint name="{each}" type="fixed"><parent link="base"/><child link="{each}"/></joint>'
        for each in ("front", "rear")
    )
    files = {
        "clone__package_dot_xml": package,
        "clone__urdf__links_dot_xacro": XACRO.format(' name="links"', part),
        "clone__urdf__cart_dot_xacro": XACRO.format(' name="cart"', whole + joints),
    }
    assert folder(**files) == ["clone/urdf/cart.xacro"]


def test_macros_that_attach_sensors_to_a_robot_elsewhere_are_a_part(folder):
    calls = '<xacro:include filename="eye.xacro"/><xacro:eye parent="base"/>'
    found = folder(
        eye_dot_xacro=XACRO.format("", EYE),
        extras_dot_xacro=XACRO.format(' name="extras"', calls),
        broken_dot_xacro=XACRO.format(' name="broken"', calls + LINK.format("bse")),
    )
    assert found == ["broken.xacro"]


def test_an_included_gazebo_file_that_hangs_on_the_whole_is_a_part(folder):
    sensor = LINK.format("eye") + (
        '<joint name="neck" type="fixed"><parent link="base"/><child link="eye"/></joint>'
    )
    whole = '<xacro:include filename="cart.gazebo"/>' + LINK.format("base")
    found = folder(
        cart_dot_gazebo=XACRO.format(' name="cart"', sensor),
        cart_dot_xacro=XACRO.format(' name="cart"', whole),
    )
    assert found == ["cart.xacro"]


def test_a_whole_robot_that_another_includes_is_one_as_well(folder):
    found = folder(
        base__urdf__base_dot_urdf_dot_xacro=XACRO.format(' name="base"', LINK.format("base")),
        base__package_dot_xml="<package><name>base</name></package>",
        gazebo__gazebo_dot_xacro=XACRO.format(
            ' name="gazebo"', '<xacro:include filename="$(find base)/urdf/base.urdf.xacro"/>'
        ),
    )
    assert found == ["base/urdf/base.urdf.xacro", "gazebo/gazebo.xacro"]


def test_an_include_with_a_variable_name_counts_for_all_that_it_may_mean(folder):
    part = '<joint name="a" type="fixed"><parent link="base"/><child link="a"/></joint>'
    whole = (
        '<xacro:arg name="kind" default="one"/><xacro:include filename="parts/$(arg kind).xacro"/>'
    )
    found = folder(
        parts__one_dot_xacro=XACRO.format("", part + LINK.format("a")),
        parts__two_dot_xacro=XACRO.format("", part + LINK.format("a")),
        cart_dot_xacro=XACRO.format(' name="cart"', whole + LINK.format("base")),
    )
    assert found == ["cart.xacro"]


def test_models_are_robots_and_worlds_are_not(folder):
    model = (
        '<sdf version="1.6"><model name="box"><link name="a"/>'
        '<plugin name="p" filename="p"/></model></sdf>'
    )
    world = '<sdf version="1.6"><world name="w"/></sdf>'
    assert folder(box__model_dot_sdf=model, w_dot_sdf=world) == ["box/model.sdf"]


def test_what_cannot_be_read_is_kept_for_its_trial_to_report(folder):
    assert folder(bad_dot_urdf='<robot name="bad"><link name="a">') == ["bad.urdf"]


def kinds(folder, launched=(), passed=()):
    uses = [
        LaunchUse(
            file=folder / "a.launch", description=folder / each, arguments=dict.fromkeys(passed, "")
        )
        for each in launched
    ]
    found = survey(folder, launches=uses)
    return {str(path.relative_to(folder)): kind for path, kind in found.skipped}


@pytest.mark.parametrize(
    "content",
    [
        '<link name="a"><visual><geometry><box size="${long} 1 1"/></geometry></visual></link>',
        '<xacro:wheel name="left"/><link name="a"/>',
        '<link name="$(arg side)_arm"/>',
        LINK.format("arm") + '<joint name="j" type="fixed"><parent link="base"/>'
        '<child link="arm"/></joint>',
    ],
)
def test_a_file_that_needs_names_of_another_file_is_a_part(folder, tmp_path, content):
    whole = (
        '<xacro:property name="long" value="1"/><xacro:arg name="side" default="left"/>'
        + WHEEL
        + LINK.format("base")
    )
    part = XACRO.format(' name="part"', content)
    robot = XACRO.format(' name="cart"', whole)
    assert folder(cart_dot_xacro=robot, part_dot_xacro=part) == ["cart.xacro"]
    assert kinds(tmp_path) == {"part.xacro": "part"}
    # Without the other file, or if a launch file starts it, it is a robot with a fault.
    assert kinds(tmp_path, launched=["part.xacro"]) == {}
    (tmp_path / "cart.xacro").unlink()
    assert folder() == ["part.xacro"]


def test_macros_are_none_although_their_includes_need_an_argument(folder, tmp_path):
    include = '<xacro:include filename="$(arg place)/wheel.xacro"/>'
    cart = XACRO.format(' name="cart"', include + '<xacro:wheel name="left"/>')
    found = folder(
        cart_dot_xacro=cart,
        axle_dot_xacro=XACRO.format("", include + WHEEL.replace('"wheel"', '"axle"')),
        wheel_dot_xacro=XACRO.format("", WHEEL),
    )
    assert found == ["cart.xacro"]
    assert kinds(tmp_path) == {"axle.xacro": "macros", "wheel.xacro": "macros"}


def test_a_file_that_needs_arguments_of_launch_files_is_a_part(folder, tmp_path):
    drone = XACRO.format(' name="drone"', '<link name="$(arg team)/base"/>')
    mav = XACRO.format(' name="mav"', '<link name="$(arg team)/mav"/>')
    found = folder(other_dot_xacro=drone, mav_dot_gazebo=mav)
    assert found == ["mav.gazebo", "other.xacro"]
    expected = {"other.xacro": "part"}
    assert kinds(tmp_path, launched=["mav.gazebo"], passed=["team"]) == expected


def test_a_robot_without_a_name_is_a_part(folder, tmp_path):
    assert folder(camera_dot_xacro=XACRO.format("", LINK.format("camera"))) == []
    assert kinds(tmp_path) == {"camera.xacro": "part"}


def test_a_robot_without_a_name_that_needs_an_argument_is_a_part(folder, tmp_path):
    """Nothing passes the argument, and no other file includes it."""
    hardware = '<ros2_control name="$(arg side)_arm" type="system"><hardware/></ros2_control>'
    assert folder(motors_dot_xacro=XACRO.format("", hardware)) == []
    assert kinds(tmp_path) == {"motors.xacro": "part"}
    assert kinds(tmp_path, launched=["motors.xacro"]) == {}
    assert folder(motors_dot_xacro=XACRO.format(' name="arm"', hardware)) == ["motors.xacro"]
    moved = hardware + '<gazebo><plugin name="p" filename="libgazebo_ros2_control.so"/></gazebo>'
    assert folder(motors_dot_xacro=XACRO.format("", moved)) == ["motors.xacro"]


@pytest.mark.parametrize(
    ("plugin", "found"), [("libgazebo_ros2_control.so", True), ("libgazebo_ros_camera.so", False)]
)
def test_a_robot_that_plugins_move_is_one_although_it_has_no_name(folder, plugin, found):
    """Its test reports the missing name, which Gazebo does not accept either."""
    tags = LINK.format("base") + f'<gazebo><plugin name="p" filename="{plugin}"/></gazebo>'
    assert folder(robot_dot_xacro=XACRO.format("", tags)) == ["robot.xacro"] * found
    whole = XACRO.format(' name="whole"', '<xacro:include filename="robot.xacro"/>')
    assert folder(whole_dot_xacro=whole) == ["whole.xacro"]


def test_a_guessed_description_of_a_launch_file_may_be_a_part(folder, tmp_path):
    folder(
        a_dot_urdf='<robot name="a">' + LINK.format("arm") + "</robot>",
        b_dot_xacro='<robot name="b" xmlns:xacro="x"><xacro:include filename="a.urdf"/>'
        + LINK.format("base")
        + '<joint name="j" type="fixed"><parent link="base"/><child link="arm"/></joint></robot>',
    )
    whole = LaunchUse(file=tmp_path / "a.launch", description=tmp_path / "b.xacro", arguments={})
    for guessed, kind in ((False, None), (True, "part")):
        use = LaunchUse(
            file=tmp_path / "a.launch",
            description=tmp_path / "a.urdf",
            arguments={},
            guessed=guessed,
        )
        skipped = {path.name: one for path, one in survey(tmp_path, launches=[whole, use]).skipped}
        assert skipped.get("a.urdf") == kind


def test_a_complete_part_of_a_launched_robot_is_a_part(folder, tmp_path):
    whole = '<xacro:include filename="core.xacro"/>' + LINK.format("lidar")
    found = folder(
        core_dot_xacro=XACRO.format(' name="core"', LINK.format("base")),
        cart_dot_xacro=XACRO.format(' name="cart"', whole),
    )
    assert found == ["cart.xacro", "core.xacro"]
    assert kinds(tmp_path, launched=["cart.xacro"]) == {"core.xacro": "part"}


def test_models_without_plugins_sensors_and_movable_joints_are_scenery(folder, tmp_path):
    joint = '<joint name="j"\n type="{}"><parent>a</parent><child>a</child></joint>'
    model = '<sdf version="1.6"><model name="m"><link name="a">{}</link></model></sdf>'
    found = folder(
        house_dot_sdf=model.format(""),
        shed_dot_sdf=model.format(joint.format("fixed")),
        arm_dot_sdf=model.format(joint.format("revolute")),
        eye_dot_sdf=model.format('<sensor name="s" type="camera"/>'),
        w_dot_sdf='<sdf version="1.6"><world name="w"/></sdf>',
    )
    assert found == ["arm.sdf", "eye.sdf"]
    assert kinds(tmp_path) == {"house.sdf": "scenery", "shed.sdf": "scenery", "w.sdf": "world"}


def test_a_model_config_without_its_file_does_not_stop_the_survey(folder):
    model = (
        '<sdf version="1.6"><model name="box"><link name="a"/>'
        '<plugin name="p" filename="p"/></model></sdf>'
    )
    config = "<model><name>box</name><sdf>gone.sdf</sdf></model>"
    assert folder(box__model_dot_config=config, box__model_dot_sdf=model) == ["box/model.sdf"]


def test_other_xml_and_what_was_built_are_passed_over(folder):
    robot = f'<robot name="a">{LINK.format("a")}</robot>'
    assert folder(note_dot_xacro="<note/>", build__a_dot_urdf=robot) == []


def test_a_file_is_taken_as_it_is(tmp_path):
    path = tmp_path / "anything.txt"
    path.write_text("")
    assert robots_in(path) == [path]


def test_a_model_s_older_files_and_moveit_s_are_none(folder):
    model = (
        '<sdf version="1.6"><model name="box"><link name="a"/>'
        '<plugin name="p" filename="p"/></model></sdf>'
    )
    config = '<model><name>box</name><sdf version="1.6">model.sdf</sdf></model>'
    found = folder(
        box__model_dot_config=config,
        box__model_dot_sdf=model,
        box__old_dot_sdf=model,
        arm_dot_srdf_dot_xacro='<robot name="arm"><link name="a"/></robot>',
    )
    assert found == ["box/model.sdf"]


def test_the_models_of_a_folder_of_worlds_are_robots_and_its_other_files_are_not(folder):
    model = (
        '<sdf version="1.6"><model name="car"><link name="a"/>'
        '<plugin name="p" filename="p"/></model></sdf>'
    )
    config = '<model><name>car</name><sdf version="1.6">car.sdf</sdf></model>'
    found = folder(
        worlds__track__car__model_dot_config=config,
        worlds__track__car__car_dot_sdf=model,
        worlds__track__parked_dot_sdf=model,
        worlds__wall_dot_urdf=f'<robot name="wall">{LINK.format("a")}</robot>',
    )
    assert found == ["worlds/track/car/car.sdf"]


@pytest.mark.parametrize(
    "text",
    [
        "<include " * 100_000,
        "<xacro:include filename='" + "${" * 500_000 + "'/>",
        "<xacro:include filename='" + "${a}X" * 30 + "b.xacro'/>",
        "<link " * 100_000,
    ],
    ids=["elements", "variables", "wildcards", "links"],
)
def test_a_text_that_is_made_to_be_slow_is_not(folder, text):
    begin = time.process_time()
    missing = "".join(
        f'<joint name="j{n}" type="fixed"><parent link="p{n}"/><child link="a"/></joint>'
        for n in range(300)
    )
    found = folder(
        a_dot_urdf=f'<robot name="a">{LINK.format("a")}{missing}</robot>',
        b_dot_xacro=f"<robot>{text}",
        **{"aXX" * 70 + "_dot_xacro": '<robot name="x"><link name="a"/></robot>'},
    )
    assert time.process_time() - begin < 5.0  # with the square of the length, minutes
    assert found == ["a.urdf", "aXX" * 70 + ".xacro", "b.xacro"]


def test_names_of_included_files_may_have_several_unknown_parts(folder):
    robot = f'<robot name="a">{LINK.format("a")}</robot>'
    found = folder(
        whole_dot_xacro=XACRO.format(
            ' name="w"', '<xacro:include filename="${x}_of_${y}_of_${z}.xacro"/>' + LINK.format("a")
        ),
        one_of_of_two_of_three_dot_xacro=XACRO.format("", LINK.format("p")),
        one_of_two_dot_xacro=robot,
    )
    assert "one_of_two.xacro" in found and "one_of_of_two_of_three.xacro" not in found


MODEL = '<sdf version="1.6"><model name="{0}"><link name="{0}"/>{1}</model></sdf>'
SENSOR = '<sensor name="s" type="camera"/>'


def includes(*uris):
    return "".join(f"<include><uri>{uri}</uri></include>" for uri in uris)


def test_a_model_that_another_model_includes_is_a_part(folder):
    joint = '<plugin name="p" filename="gz-sim-joint-position-controller-system"/>'
    drive = '<plugin name="p" filename="gz-sim-diff-drive-system"/>'
    fixed = "<joint name='j' type='fixed'><parent>world</parent><child>arm</child></joint>"
    uris = ("model://eye", "gimbal", "model://base/model.sdf", "model://arm", "https://x/y/far")
    found = folder(
        eye__model_dot_sdf=MODEL.format("eye", SENSOR),
        gimbal__model_dot_sdf=MODEL.format("gimbal", joint),
        base__model_dot_sdf=MODEL.format("base", drive),
        arm__model_dot_sdf=MODEL.format("arm", joint + fixed),
        far__model_dot_sdf=MODEL.format("far", SENSOR),
        own__model_dot_sdf=MODEL.format("own", SENSOR + includes("model://own")),
        whole__model_dot_sdf=MODEL.format("whole", includes(*uris) + "<uri>model://lone</uri>"),
        lone__model_dot_sdf=MODEL.format("lone", SENSOR),
    )
    names = ["arm", "base", "far", "lone", "own", "whole"]
    assert found == [f"{name}/model.sdf" for name in names]


@pytest.mark.parametrize("by", ["world", "launch"])
def test_a_part_that_a_world_or_a_launch_file_spawns_is_a_robot(tmp_path, folder, by):
    world = f'<sdf version="1.6"><world name="w">{includes("model://eye")}</world></sdf>'
    folder(
        eye__model_dot_sdf=MODEL.format("eye", SENSOR),
        whole__model_dot_sdf=MODEL.format("whole", includes("model://eye")),
        **({"w_dot_world": world} if by == "world" else {}),
    )
    eye = tmp_path / "eye" / "model.sdf"
    launch = LaunchUse(file=tmp_path / "a.launch", description=eye, arguments={})
    found = survey(tmp_path, launches=[launch] if by == "launch" else [])
    assert eye in found.robots


@pytest.mark.parametrize(("name", "kind"), [("", "part"), ('name="arm"', None)])
def test_a_nameless_fragment_that_needs_an_absent_package_is_a_part(tmp_path, name, kind):
    path = tmp_path / "control.xacro"
    path.write_text(
        f'<robot {name} xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="arm"/>'
        '<xacro:property name="file" value="$(find no_such_package)/arm.yaml"/>'
        '<xacro:property name="sizes" value="${load_yaml(\'$(find no_such_package)/arm.yaml\')}"/>'
        "${sizes}</robot>"
    )
    found = survey(tmp_path)
    assert found.skipped == (((path, kind),) if kind else ())
    assert found.robots == (() if kind else (path,))


MOUNT = (
    '<joint name="mount" type="fixed"><parent link="{}"/><child link="palm"/></joint>'
    '<joint name="knuckle" type="fixed"><parent link="palm"/><child link="finger"/></joint>'
)
HAND = LINK.format("palm") + LINK.format("finger")
DRIVE = '<gazebo><plugin name="p" filename="libsomeones_own.so"/></gazebo>'


@pytest.mark.parametrize(
    ("parent", "more", "kind"),
    [
        ("right_wrist", "", "part"),
        ("right_wrist", DRIVE, None),
        ("right_wrist", LINK.format("loose"), None),
        # A misspelt link, or the root link that a robot lacks.
        ("fingr", "", None),
        ("base_footprint", "", None),
    ],
)
def test_a_hand_for_an_arm_elsewhere_is_a_part(tmp_path, parent, more, kind):
    path = tmp_path / "hand.urdf"
    path.write_text(f'<robot name="hand">{HAND}{MOUNT.format(parent)}{more}</robot>')
    assert kinds(tmp_path) == ({"hand.urdf": kind} if kind else {})
    assert kinds(tmp_path, launched=["hand.urdf"]) == {}
