"""Models and worlds: they parse, name things once, need nothing from elsewhere, stand on z = 0."""

from __future__ import annotations

import math
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np
import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
URDFS = sorted(REPOSITORY.glob("models/*.urdf"))
SDFS = sorted(REPOSITORY.glob("models/*/model.sdf"))
GENERATED = ("elevator", "mud", "range", "rubble", "shapes", "willowgarage")
"""By tools/make_worlds.py, which works inertias out; how they run is tested in tests/worlds."""
WORLDS = sorted(REPOSITORY.glob("worlds/*.world"))
WITH_MODELS = [path for path in WORLDS if path.stem not in (*GENERATED, "empty")]


def label(path: Path) -> str:
    return path.relative_to(REPOSITORY).as_posix()


def floats(text: str | None) -> list[float]:
    return [float(number) for number in str(text).split()]


def moments_of(geometry: Element, mass: float) -> list[float]:
    """Principal moments of a uniform box or cylinder, URDF or SDF."""
    shape = geometry[0]

    def value(name: str) -> str:
        return str(shape.get(name) or shape.findtext(name))

    if shape.tag == "box":
        x, y, z = (side**2 for side in floats(value("size")))
        return [mass * (y + z) / 12, mass * (x + z) / 12, mass * (x + y) / 12]
    r, h = float(value("radius")), float(value("length"))
    across = mass * (3 * r * r + h * h) / 12
    return [across, across, mass * r * r / 2]


def height_of(geometry: Element) -> float:
    shape = geometry[0]
    if shape.tag == "box":
        return floats(shape.get("size") or shape.findtext("size"))[2]
    return float(str(shape.get("length") or shape.findtext("length")))


def test_something_of_every_kind_is_there() -> None:
    assert {path.stem for path in URDFS} >= {"object", "box_small", "box_large", "barrel"}
    assert {path.parent.name for path in SDFS} >= {"sun", "ground_plane", "wall", "ramp"}
    assert {path.stem for path in WORLDS} == {
        *("empty", "post", "walls"),
        *("elevator", "mud", "range", "rubble", "shapes", "willowgarage"),
    }


@pytest.mark.parametrize("path", URDFS, ids=label)
def test_urdf_model(path: Path) -> None:
    robot = ElementTree.parse(path).getroot()
    assert robot.tag == "robot"
    (link,) = robot.findall("link")
    assert {block.get("reference") for block in robot.findall("gazebo")} == {link.get("name")}
    collision = link.find("collision")
    inertial = link.find("inertial")
    assert collision is not None and inertial is not None
    geometry, mass, inertia = (
        collision.find("geometry"),
        inertial.find("mass"),
        inertial.find("inertia"),
    )
    assert geometry is not None and mass is not None and inertia is not None
    expected = moments_of(geometry, float(str(mass.get("value"))))
    found = [float(str(inertia.get(name))) for name in ("ixx", "iyy", "izz")]
    assert found == pytest.approx(expected, rel=1e-5)
    for part in (inertial, collision, link.find("visual")):
        assert part is not None
        origin = part.find("origin")
        assert origin is not None
        assert floats(origin.get("xyz")) == pytest.approx([0, 0, height_of(geometry) / 2])


def test_urdf_robots_have_names_of_their_own() -> None:
    names = [ElementTree.parse(path).getroot().get("name") for path in URDFS]
    assert len(names) == len(set(names))


def test_object_is_the_tutorials_post() -> None:
    robot = ElementTree.parse(REPOSITORY / "models/object.urdf").getroot()
    assert robot.get("name") == "my_object"
    assert robot.findtext("gazebo/material") == "Gazebo/Red"


@pytest.mark.parametrize("path", SDFS, ids=label)
def test_sdf_model_can_be_found_by_its_folder(path: Path) -> None:
    root = ElementTree.parse(path).getroot()
    assert root.tag == "sdf"
    assert root[0].get("name") == path.parent.name
    config = ElementTree.parse(path.with_name("model.config")).getroot()
    assert config.findtext("sdf") == path.name
    assert config.findtext("name")


def check_contents(element: Element) -> None:
    """Names are unique among siblings, URIs lead into models/, inertias are possible."""
    for parent in element.iter():
        seen = set()
        for child in parent:
            key = (child.tag, child.get("name"))
            if child.get("name"):
                assert key not in seen, key
            seen.add(key)
    for uri in element.iter("uri"):
        text = str(uri.text)
        if text != "file://media/materials/scripts/gazebo.material":
            target = REPOSITORY / "models" / text.removeprefix("model://")
            assert target.exists(), text
            assert target.is_file() or (target / "model.sdf").is_file(), text
    for inertia in element.iter("inertia"):
        moments = [float(str(inertia.findtext(name))) for name in ("ixx", "iyy", "izz")]
        assert min(moments) > 0
        assert sum(moments) > 2 * max(moments)


@pytest.mark.parametrize("path", SDFS, ids=label)
def test_sdf_model_is_sound(path: Path) -> None:
    check_contents(ElementTree.parse(path).getroot())


@pytest.mark.parametrize("path", WORLDS, ids=label)
def test_world_is_sound(path: Path) -> None:
    root = ElementTree.parse(path).getroot()
    world = root.find("world")
    assert world is not None
    check_contents(root)
    assert floats(world.findtext("gravity")) == [0, 0, -9.8]
    assert world.find(".//max_step_size") is None
    names = [model.get("name") for model in world.findall("model")]
    names += [
        include.findtext("name") or str(include.findtext("uri")).rsplit("/", 1)[-1]
        for include in world.findall("include")
    ]
    assert len(names) == len(set(names))
    assert {"sun", "ground_plane"} <= set(names)


@pytest.mark.parametrize("path", WITH_MODELS, ids=label)
def test_inline_models_stand_on_the_ground_with_the_inertia_of_their_shape(path: Path) -> None:
    models = list(ElementTree.parse(path).getroot().iter("model"))
    assert models
    for model in models:
        assert floats(model.findtext("pose"))[2] == 0
        geometry = model.find("link/collision/geometry")
        assert geometry is not None
        middle = floats(model.findtext("link/collision/pose"))
        assert middle[2] == pytest.approx(height_of(geometry) / 2)
        assert floats(model.findtext("link/inertial/pose")) == middle
        inertia = model.find("link/inertial/inertia")
        assert inertia is not None
        mass = float(str(model.findtext("link/inertial/mass")))
        found = [float(str(inertia.findtext(name))) for name in ("ixx", "iyy", "izz")]
        assert found == pytest.approx(moments_of(geometry, mass), rel=1e-5)


def test_post_stands_in_the_camera_of_a_cart_at_the_origin(robot: Element) -> None:
    """All of its 1 m lies between the upper and the lower edge of the image, and its middle
    within the middle third."""
    world = ElementTree.parse(REPOSITORY / "worlds/post.world").getroot()
    model = world.find(".//model[@name='post']")
    assert model is not None
    x, y, *_ = floats(model.findtext("pose"))
    sx, _, sz = floats(model.findtext("link/collision/geometry/box/size"))
    origin = robot.find("joint[@name='camera_joint']/origin")
    field = robot.findtext(".//sensor[@name='camera1']/camera/horizontal_fov")
    assert origin is not None
    eye, pitch = np.array(floats(origin.get("xyz"))), floats(origin.get("rpy"))[1]
    across = math.tan(float(str(field)) / 2)
    near = x - sx / 2 - eye[0]
    for height in (0.0, sz):
        down = math.atan2(eye[2] - height, near) - pitch
        assert abs(math.tan(down)) < across * 240 / 320
    assert abs((y - eye[1]) / near) < across / 3


def test_ramp_is_climbable_and_its_slopes_meet_ground_and_platform() -> None:
    ramp = ElementTree.parse(REPOSITORY / "models/ramp/model.sdf").getroot()
    ends = {}
    for collision in ramp.iter("collision"):
        x, y, z, roll, pitch, yaw = floats(collision.findtext("pose"))
        length, _, thick = floats(collision.findtext("geometry/box/size"))
        assert y == roll == yaw == 0
        along = np.array([math.cos(pitch), -math.sin(pitch)])
        up = np.array([math.sin(pitch), math.cos(pitch)])
        top = np.array([x, z]) + up * thick / 2
        ends[collision.get("name")] = (top - along * length / 2, top + along * length / 2)
    assert ends["up"][0][1] == pytest.approx(0, abs=1e-5)
    assert ends["up"][1] == pytest.approx(ends["platform"][0], abs=1e-5)
    assert ends["down"][0] == pytest.approx(ends["platform"][1], abs=1e-5)
    assert ends["down"][1][1] == pytest.approx(0, abs=1e-5)
