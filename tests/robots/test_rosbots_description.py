"""What rosbots.xacro promises: names, places, plugins, masses."""

from __future__ import annotations

import math
import re
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
import pytest

GRAVITY = 9.8
LINKS = {
    "base_footprint",
    "base_link",
    "frame_link",
    "wheel_left_link",
    "wheel_right_link",
    "caster_link",
    "camera_link",
    "camera",
}


def one(element: Element, path: str) -> Element:
    found = element.findall(path)
    assert len(found) == 1, f"{path}: {len(found)} found"
    return found[0]


def vector(element: Element | None, attribute: str) -> np.ndarray:
    text = "0 0 0" if element is None else element.get(attribute, "0 0 0")
    return np.array([float(number) for number in text.split()])


def link(robot: Element, name: str) -> Element:
    return one(robot, f"link[@name='{name}']")


def joint(robot: Element, name: str) -> Element:
    return one(robot, f"joint[@name='{name}']")


def tags(element: Element) -> dict[str, str]:
    return {child.tag: (child.text or "").strip() for child in element}


def plugin(robot: Element, filename: str) -> dict[str, str]:
    return tags(one(robot, f".//plugin[@filename='{filename}']"))


def surface(robot: Element, name: str) -> dict[str, str]:
    """Every plain tag of the <gazebo> blocks that refer to a link."""
    found: dict[str, str] = {}
    for block in robot.findall(f"gazebo[@reference='{name}']"):
        found |= tags(block)
    return found


def place(robot: Element, name: str) -> np.ndarray:
    """Where a link's origin is in base_footprint. Only the camera's joints turn, and nothing
    that is asked for here lies behind them."""
    position = np.zeros(3)
    while True:
        parents = [j for j in robot.findall("joint") if one(j, "child").get("link") == name]
        if not parents:
            return position
        position = position + vector(parents[0].find("origin"), "xyz")
        name = str(one(parents[0], "parent").get("link"))


def test_links_and_joints_form_one_tree(robot: Element) -> None:
    names = [element.get("name") for element in robot.findall("link")]
    assert sorted(map(str, names)) == sorted(LINKS)
    joints = [element.get("name") for element in robot.findall("joint")]
    assert len(joints) == len(set(joints))
    children = [one(element, "child").get("link") for element in robot.findall("joint")]
    assert sorted(map(str, children)) == sorted(LINKS - {"base_footprint"})


def test_base_link_coincides_with_base_footprint(robot: Element) -> None:
    base = one(robot, "joint[child]/child[@link='base_link']/..")
    assert base.get("type") == "fixed"
    assert not vector(base.find("origin"), "xyz").any()
    assert not vector(base.find("origin"), "rpy").any()


@pytest.mark.parametrize(("side", "sign"), [("left", 1), ("right", -1)])
def test_wheels_stand_where_the_diff_drive_believes(robot: Element, side: str, sign: int) -> None:
    drive = plugin(robot, "libgazebo_ros_diff_drive.so")
    wheel_joint = joint(robot, f"wheel_{side}_joint")
    assert wheel_joint.get("type") == "continuous"
    assert vector(wheel_joint.find("axis"), "xyz").tolist() == [0, 1, 0]
    position = place(robot, f"wheel_{side}_link")
    assert position[0] == 0
    assert position[1] == pytest.approx(sign * float(drive["wheelSeparation"]) / 2, abs=1e-12)
    cylinder = one(link(robot, f"wheel_{side}_link"), "collision/geometry/cylinder")
    assert 2 * float(cylinder.get("radius", "")) == float(drive["wheelDiameter"])


def test_wheels_and_caster_touch_the_ground(robot: Element) -> None:
    for name, shape in [
        ("wheel_left_link", "cylinder"),
        ("wheel_right_link", "cylinder"),
        ("caster_link", "sphere"),
    ]:
        body = link(robot, name)
        radius = float(one(body, f"collision/geometry/{shape}").get("radius", ""))
        assert not vector(one(body, "collision").find("origin"), "xyz").any()
        assert place(robot, name)[2] - radius == pytest.approx(0, abs=1e-12)


def test_camera_stands_and_looks_as_in_the_tutorial(robot: Element) -> None:
    camera_joint = joint(robot, "camera_joint")
    assert camera_joint.get("type") == "fixed"
    assert one(camera_joint, "parent").get("link") == "base_link"
    assert one(camera_joint, "child").get("link") == "camera_link"
    assert vector(one(camera_joint, "origin"), "xyz").tolist() == [0.49, -0.03, 0.75]
    assert vector(one(camera_joint, "origin"), "rpy").tolist() == [0, 0.21, 0]
    mesh = one(link(robot, "camera_link"), "visual/geometry/mesh")
    assert mesh.get("filename") == "package://rosbots_description/meshes/camera.dae"
    assert mesh.get("scale") == "4 4 4"


def test_optical_frame_is_named_as_the_images_are(robot: Element) -> None:
    frame = plugin(robot, "libgazebo_ros_camera.so")["frameName"]
    optical = one(robot, f"joint/child[@link='{frame}']/..")
    assert one(optical, "parent").get("link") == "camera_link"
    rpy = vector(one(optical, "origin"), "rpy")
    assert rpy == pytest.approx([-math.pi / 2, 0, -math.pi / 2], abs=1e-12)
    assert link(robot, frame).find("inertial") is None


def test_cart_stays_below_what_its_camera_sees(robot: Element) -> None:
    """The lowest ray of the image clears the chassis' front edge and everything ahead of it."""
    sensor = one(robot, ".//sensor[@name='camera1']/camera")
    width, height = (int(str(sensor.findtext(f"image/{side}"))) for side in ("width", "height"))
    half = math.atan(math.tan(float(str(sensor.findtext("horizontal_fov"))) / 2) * height / width)
    origin = one(joint(robot, "camera_joint"), "origin")
    eye, pitch = vector(origin, "xyz"), vector(origin, "rpy")[1]
    collision = one(link(robot, "base_link"), "collision")
    centre = vector(one(collision, "origin"), "xyz")
    size = vector(one(collision, "geometry/box"), "size")
    front = centre[0] + size[0] / 2
    ray = eye[2] - (front - eye[0]) * math.tan(pitch + half)
    assert ray > centre[2] + size[2] / 2 + 0.2
    # The bumper is ahead of the camera: it, not the lens, meets the wall.
    assert front > eye[0]


def test_diff_drive(robot: Element) -> None:
    drive = plugin(robot, "libgazebo_ros_diff_drive.so")
    expected = {
        "legacyMode": "false",
        "alwaysOn": "true",
        "updateRate": "100",
        "leftJoint": "wheel_left_joint",
        "rightJoint": "wheel_right_joint",
        "wheelSeparation": "1.1",
        "wheelDiameter": "0.52",
        "wheelAcceleration": "1.0",
        "torque": "20",
        "wheelTorque": "20",
        "commandTopic": "part2_cmr/cmd_vel",
        "odometryTopic": "odom",
        "odometryFrame": "odom",
        "robotBaseFrame": "base_link",
        "publishTf": "1",
        "publishWheelTF": "true",
        "publishWheelJointState": "true",
    }
    assert {tag: drive.get(tag) for tag in expected} == expected


def test_camera(robot: Element) -> None:
    sensor = one(robot, "gazebo[@reference='camera_link']/sensor[@name='camera1']")
    assert sensor.get("type") == "camera"
    assert float(str(sensor.findtext("update_rate"))) == 30
    assert sensor.findtext("camera/horizontal_fov") == "1.04"
    assert tags(one(sensor, "camera/image")) == {
        "width": "320",
        "height": "240",
        "format": "R8G8B8",
    }
    assert tags(one(sensor, "camera/clip")) == {"near": "0.1", "far": "50"}
    camera = plugin(robot, "libgazebo_ros_camera.so")
    assert camera["robotNamespace"] == ""
    assert camera["cameraName"] == "camera1"
    assert camera["imageTopicName"] == "image_raw"
    assert camera["cameraInfoTopicName"] == "camera_info"
    assert camera["frameName"] == "camera"
    assert float(camera["hackBaseline"]) == 0.07
    for term in ("K1", "K2", "K3", "T1", "T2"):
        assert float(camera[f"distortion{term}"]) == 0


def test_imu(robot: Element) -> None:
    imu = plugin(robot, "libgazebo_ros_imu.so")
    expected = {
        "topicName": "imu/data",
        "serviceName": "imu/service",
        "bodyName": "base_link",
        "gaussianNoise": "0",
        "xyzOffset": "0 0 0",
        "rpyOffsets": "0 0 0",
        "updateRate": "30",
    }
    assert {tag: imu.get(tag) for tag in expected} == expected


def test_bumper_watches_the_collision_by_the_name_gazebo_gives_it(robot: Element) -> None:
    sensor = one(robot, "gazebo[@reference='base_link']/sensor[@name='bumpers']")
    assert sensor.get("type") == "contact"
    assert float(str(sensor.findtext("update_rate"))) == 50
    # Gazebo appends _1, _2 to further collisions of the merged link; the first has no number.
    assert (
        sensor.findtext("contact/collision")
        == "base_footprint_fixed_joint_lump__base_link_collision"
    )
    assert len(link(robot, "base_link").findall("collision")) == 1
    assert not link(robot, "base_footprint").findall("collision")
    bumper = plugin(robot, "libgazebo_ros_bumper.so")
    assert bumper["bumperTopicName"] == "bumpers"
    assert bumper["frameName"] == "base_link"


def test_surfaces(robot: Element) -> None:
    wheel = {"mu1": 1.0, "mu2": 1.0, "kp": 1e6, "kd": 100.0, "minDepth": 0.001, "maxVel": 1.0}
    for name, expected in {
        "wheel_left_link": wheel,
        "wheel_right_link": wheel,
        "base_link": {"mu1": 0.3, "mu2": 0.3},
        "camera_link": {"mu1": 0.2, "mu2": 0.2},
        "caster_link": {"mu1": 0.0, "mu2": 0.0},
    }.items():
        found = surface(robot, name)
        assert {tag: float(found[tag]) for tag in expected} == expected, name
    assert surface(robot, "base_link")["material"] == "Gazebo/Blue"


def test_gazebo_blocks_refer_to_links_that_exist(robot: Element) -> None:
    blocks = robot.findall("gazebo")
    assert blocks
    for block in blocks:
        assert block.get("reference", "base_link") in LINKS


def inertia(body: Element) -> tuple[float, np.ndarray]:
    element = one(body, "inertial/inertia")
    assert all(float(element.get(name, "")) == 0 for name in ("ixy", "ixz", "iyz"))
    moments = np.array([float(element.get(name, "")) for name in ("ixx", "iyy", "izz")])
    return float(one(body, "inertial/mass").get("value", "")), moments


@pytest.mark.parametrize("name", sorted(LINKS - {"base_footprint", "camera"}))
def test_inertia_is_one_a_body_can_have(robot: Element, name: str) -> None:
    mass, moments = inertia(link(robot, name))
    assert mass > 0
    assert (moments > 0).all()
    assert moments.sum() > 2 * moments.max()


def test_inertia_follows_from_mass_and_size(robot: Element) -> None:
    for name in ("base_link", "camera_link"):
        mass, moments = inertia(link(robot, name))
        x, y, z = vector(one(link(robot, name), "collision/geometry/box"), "size") ** 2
        assert moments == pytest.approx(mass / 12 * np.array([y + z, x + z, x + y]), rel=1e-9)
    for name in ("wheel_left_link", "wheel_right_link"):
        mass, moments = inertia(link(robot, name))
        cylinder = one(link(robot, name), "collision/geometry/cylinder")
        r, h = (float(cylinder.get(key, "")) for key in ("radius", "length"))
        across = mass * (3 * r * r + h * h) / 12
        assert moments == pytest.approx([across, mass * r * r / 2, across], rel=1e-9)
    mass, moments = inertia(link(robot, "caster_link"))
    r = float(one(link(robot, "caster_link"), "collision/geometry/sphere").get("radius", ""))
    assert moments == pytest.approx([2 / 5 * mass * r * r] * 3, rel=1e-9)


def mass_and_centre(robot: Element) -> tuple[float, np.ndarray]:
    total, moment = 0.0, np.zeros(3)
    for body in robot.findall("link"):
        if body.find("inertial") is None:
            continue
        mass, _ = inertia(body)
        # The camera's pitch moves its centre of mass by millimetres: 0.4 kg of 50.
        centre = place(robot, str(body.get("name"))) + vector(body.find("inertial/origin"), "xyz")
        total += mass
        moment += mass * centre
    return total, moment / total


def test_cart_neither_tips_forward_nor_lifts_its_nose(robot: Element) -> None:
    """An acceleration a moves the foot of gravity's line by a z / g: it must stay between the
    axle and the caster, at the ramp of 1 m/s^2 and at all the torque the motors have."""
    total, centre = mass_and_centre(robot)
    drive = plugin(robot, "libgazebo_ros_diff_drive.so")
    strongest = 2 * float(drive["torque"]) / (float(drive["wheelDiameter"]) / 2) / total
    caster = place(robot, "caster_link")[0]
    for acceleration in (float(drive["wheelAcceleration"]), strongest):
        shift = acceleration * centre[2] / GRAVITY
        assert centre[0] - shift > 0
        assert centre[0] + shift < caster
    assert centre[1] == pytest.approx(0, abs=1e-3)


def test_motors_follow_their_ramp_and_wheels_grip(robot: Element) -> None:
    total, centre = mass_and_centre(robot)
    assert total == pytest.approx(50.4, abs=0.01)
    drive = plugin(robot, "libgazebo_ros_diff_drive.so")
    radius = float(drive["wheelDiameter"]) / 2
    _, moments = inertia(link(robot, "wheel_left_link"))
    ramp = float(drive["wheelAcceleration"])
    torque = radius * total * ramp / 2 + moments[1] * ramp / radius
    assert torque < float(drive["torque"]) / 2
    on_wheels = total * GRAVITY * (1 - centre[0] / place(robot, "caster_link")[0])
    friction = float(surface(robot, "wheel_left_link")["mu1"])
    assert 2 * float(drive["torque"]) / radius < friction * on_wheels


def test_meshes_exist(robot: Element, repository: Path) -> None:
    names = {str(mesh.get("filename")) for mesh in robot.iter("mesh")}
    assert names
    for name in names:
        assert (repository / "robots" / name.removeprefix("package://")).is_file(), name


def test_launch_files_refer_to_files_that_exist(repository: Path) -> None:
    package = repository / "robots/rosbots_description"
    launches = sorted(package.glob("launch/*.launch"))
    assert [launch.name for launch in launches] == ["rviz.launch", "spawn.launch"]
    for launch in launches:
        paths = re.findall(r"\$\(find rosbots_description\)/([\w./]+)", launch.read_text())
        assert paths, launch.name
        for path in paths:
            assert (package / path).is_file(), f"{launch.name}: {path}"
