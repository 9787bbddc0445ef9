"""Single mutations of a world in SDF: faults that a check must report, and harmless edits."""

from __future__ import annotations

from benchmarks.mutations import (
    Element,
    Mutation,
    drop_attribute,
    insert,
    misspell_attribute_value,
    misspell_tag,
    misspell_text,
    name_as_sibling,
    nothing,
    remove,
    repeat,
    repeat_text,
    scale,
    set_attributes,
    set_text,
    swap_texts,
)

_ROVER = "//model[@name='rover']"
_WHEELS = f"{_ROVER}/link[contains(@name, 'wheel')]"
_DRIVEN = f"{_ROVER}/joint[contains(@name, 't_joint')][not(contains(@name, 'mast'))]"
_SENSOR_TAGS = "//sensor//*[not(self::plugin or ancestor::plugin)]"


def yaw_in_degrees(node: Element) -> bool:
    """Writes a pose's yaw as 90."""
    words = node.text.split()
    node.text = " ".join([*words[:5], "90"])
    return bool(words[5] != "90")


def five_numbers(node: Element) -> None:
    """Leaves a pose five numbers."""
    node.text = node.text.rpartition(" ")[0]


def size_as_attribute(node: Element) -> None:
    """Writes a box as URDF does."""
    size = node.find("size")
    node.set("size", size.text)
    node.remove(size)


def limits_in_degrees(node: Element) -> None:
    """Writes limits of 90 degrees as 90."""
    for each in node.xpath("lower | upper"):
        each.text = f"{float(each.text) * 75:g}"


def drive_joints_missing(node: Element) -> None:
    """Removes the names of the joints, which are not those of the plugin's defaults."""
    for each in node.getparent().findall("joint"):
        each.set("name", f"wheel_{each.get('name')}")
    for each in node.xpath("leftJoint | rightJoint"):
        node.remove(each)


def frictionless(node: Element) -> None:
    """Sets all coefficients of friction to 0."""
    for each in node:
        each.text = "0"


FAULTS: tuple[Mutation, ...] = (
    # Structure
    Mutation(name="SDF: parent misspelt", at="//joint/parent", code="joint-link-unknown",
        edit=misspell_text),
    Mutation(name="SDF: child misspelt", at="//joint/child", code="joint-link-unknown",
        edit=misspell_text),
    Mutation(name="SDF: joint type misspelt", at="//joint", code="joint-type-unknown",
        edit=misspell_attribute_value("type")),
    Mutation(name="SDF: joint with the name of the next", at="//joint", code="name-taken",
        edit=name_as_sibling(), follows=("drive-joint-unknown",)),
    Mutation(name="SDF: link twice", at=f"{_ROVER}/link", code="name-taken", edit=repeat()),
    Mutation(name="SDF: link without a name", at=f"{_ROVER}/link", code="tag-missing",
        edit=drop_attribute("name"), follows=("joint-link-unknown",)),
    Mutation(name="SDF: include misspelt", at="//include/uri", code="file-missing",
        edit=lambda node: setattr(node, "text", "model://" + node.text[8:] + "s")),
    Mutation(name="SDF: link misspelt", at="//model/link", code="tag-ignored", edit=misspell_tag,
        follows=("joint-link-unknown", "frame-unknown", "drive-joint-unknown")),
    # Joints
    Mutation(name="SDF: limits in degrees", at="//limit[lower]", code="limit-in-degrees",
        edit=limits_in_degrees),
    Mutation(name="SDF: limits swapped", at="//limit[lower]", code="limit-reversed",
        edit=swap_texts("lower", "upper")),
    Mutation(name="SDF: axis of length 0", at="//axis/xyz", code="axis-zero",
        edit=set_text("0 0 0")),
    # Mass and inertia
    Mutation(name="SDF: inertia against the triangle inequality", at="//inertia/izz",
        code="inertia-impossible", edit=scale(100.0), follows=("inertia-geometry-mismatch",)),
    Mutation(name="SDF: inertia below 0", at="//inertia/ixx", code="inertia-impossible",
        edit=scale(-1.0), follows=("inertia-geometry-mismatch",)),
    Mutation(name="SDF: mass below 0", at="//inertial/mass", code="mass-not-positive",
        edit=scale(-1.0)),
    Mutation(name="SDF: mass in grams", at="//inertial/mass", code="mass-in-grams",
        edit=scale(1000.0), follows=("inertia-geometry-mismatch",)),
    Mutation(name="SDF: mass malformed", at="//inertial/mass", code="value-invalid",
        edit=set_text("heavy")),
    Mutation(name="SDF: mass twice", at="//inertial/mass", code="tag-repeated", edit=repeat_text),
    # Poses and geometry
    Mutation(name="SDF: yaw in degrees", at="//pose", code="angle-in-degrees",
        edit=yaw_in_degrees, follows=("wheel-axis-misaligned", "wheels-off-ground",
            "wheel-not-round", "view-blocked", "wheel-diameter-mismatch",
            "wheel-separation-mismatch", "wheels-swapped")),
    Mutation(name="SDF: pose of five numbers", at="//pose", code="value-ignored",
        edit=five_numbers),
    Mutation(name="SDF: size as an attribute", at="//box", code="tag-ignored",
        edit=size_as_attribute, follows=("default-used",)),
    Mutation(name="SDF: size removed", at="//box/size | //cylinder/radius | //sphere/radius",
        code="default-used", edit=remove),
    Mutation(name="SDF: radius below 0", at="//cylinder/radius | //sphere/radius",
        code="value-invalid", edit=scale(-1.0)),
    Mutation(name="SDF: shape misspelt", at="//geometry/*", code="type-unknown",
        edit=misspell_tag),
    Mutation(name="SDF: geometry removed", at="//geometry", code="value-ignored", edit=remove),
    Mutation(name="SDF: collision misspelt", at="//link/collision", code="tag-ignored",
        edit=misspell_tag, follows=("wheel-without-collision", "base-without-collision")),
    Mutation(name="SDF: surface misspelt", at="//surface//*", code="tag-ignored",
        edit=misspell_tag),
    Mutation(name="SDF: material misspelt", at="//material/script/name", code="material-unknown",
        edit=lambda node: setattr(node, "text", "Gazebo/Rde")),
    # World
    Mutation(name="SDF: gravity of two numbers", at="//gravity", code="value-invalid",
        edit=set_text("0 -9.8")),
    Mutation(name="SDF: static malformed", at="//static", code="value-invalid",
        edit=set_text("maybe")),
    Mutation(name="SDF: physics misspelt", at="//physics/*", code="tag-ignored",
        edit=misspell_tag),
    Mutation(name="SDF: tag of the world misspelt", at="//world/gravity | //model/static",
        code="tag-ignored", edit=misspell_tag, follows=("inertia-missing",)),
    Mutation(name="SDF: light misspelt", at="//light/*", code="tag-ignored", edit=misspell_tag),
    Mutation(name="SDF: type of the light misspelt", at="//light", code="type-unknown",
        edit=misspell_attribute_value("type")),
    # Drive and plugins
    Mutation(name="SDF: drive joint misspelt", at="//leftJoint | //rightJoint",
        code="drive-joint-unknown", edit=misspell_text),
    Mutation(name="SDF: drive joint missing", at="//wheelSeparation/..",
        code="plugin-parameter-missing",
        edit=drive_joints_missing),
    Mutation(name="SDF: wheel fixed", at=_DRIVEN, code="drive-joint-not-continuous",
        edit=set_attributes(type="fixed"), follows=("not-simulated",)),
    Mutation(name="SDF: wheel separation times 1.1", at="//wheelSeparation",
        code="wheel-separation-mismatch", edit=scale(1.1)),
    Mutation(name="SDF: radius for diameter", at="//wheelDiameter",
        code="wheel-diameter-mismatch", edit=scale(0.5)),
    Mutation(name="SDF: wheels swapped", at="//plugin[leftJoint]", code="wheels-swapped",
        edit=swap_texts("leftJoint", "rightJoint")),
    Mutation(name="SDF: wheel axis reversed", at=f"{_DRIVEN}/axis/xyz",
        code="wheel-axis-misaligned", edit=scale(-1.0)),
    Mutation(name="SDF: wheel axis forward", at=f"{_DRIVEN}/axis/xyz",
        code="wheel-axis-misaligned", edit=set_text("1 0 0"),
        follows=("wheel-not-round", "wheel-diameter-mismatch")),
    Mutation(name="SDF: wheel without collision", at=f"{_WHEELS}/collision", edit=remove,
        code="wheel-without-collision"),
    Mutation(name="SDF: wheel without friction", at=f"{_WHEELS}//ode", code="wheel-frictionless",
        edit=frictionless),
    Mutation(name="SDF: body below the wheels", at="//collision[@name='skid']/pose",
        code="wheels-off-ground", edit=set_text("-0.2 0 -0.3 0 0 0")),
    Mutation(name="SDF: parameter misspelt", at="//plugin/*", code="plugin-parameter-unknown",
        edit=misspell_tag, follows=("plugin-idle", "wheel-diameter-mismatch",
            "wheel-separation-mismatch", "duplicate-topic")),
    Mutation(name="SDF: number malformed", at="//wheelSeparation | //wheelDiameter",
        code="plugin-parameter-invalid", edit=set_text("wide")),
    Mutation(name="SDF: plugin's file misspelt", at="//plugin", code="plugin-unknown",
        edit=lambda node: node.set("filename", node.get("filename").replace("ros_", "rso_"))),
    # Sensors
    Mutation(name="SDF: sensor type misspelt", at="//sensor", code="sensor-type-unknown",
        edit=misspell_attribute_value("type")),
    Mutation(name="SDF: tag of a sensor misspelt", at=_SENSOR_TAGS, code="tag-ignored",
        edit=misspell_tag, follows=("tag-missing", "sensor-incomplete", "scan-samples-invalid",
            "view-blocked")),
    Mutation(name="SDF: rate of 5 kHz", at="//update_rate", code="rate-above-physics",
        edit=set_text("5000")),
    Mutation(name="SDF: clip planes swapped", at="//clip", code="value-invalid",
        edit=swap_texts("near", "far")),
    Mutation(name="SDF: range swapped", at="//ray/range", code="sensor-range-invalid",
        edit=swap_texts("min", "max")),
    Mutation(name="SDF: field of view in degrees", at="//horizontal_fov", code="value-invalid",
        edit=scale(57.29578)),
    Mutation(name="SDF: image format misspelt", at="//image/format", code="image-format-unknown",
        edit=set_text("R8B8G8")),
    Mutation(name="SDF: topic with a blank", at="//topicName | //imageTopicName",
        code="topic-invalid", edit=set_text("my topic")),
)  # fmt: skip
"""Each with the code that a check must report."""

HARMLESS: tuple[Mutation, ...] = (
    Mutation(name="SDF: written anew", at="/sdf", edit=nothing),
    Mutation(name="SDF: another place", at="//model/pose", edit=set_text("1 2 0 0 0 0.5")),
    Mutation(name="SDF: mass times 1.2", at="//inertial/mass", edit=scale(1.2)),
    Mutation(name="SDF: half the rate", at="//update_rate", edit=scale(0.5)),
    Mutation(name="SDF: narrower limits", at="//limit/upper", edit=scale(0.7)),
    Mutation(name="SDF: friction times 0.8", at="//ode/mu[text()!='0']", edit=scale(0.8)),
    Mutation(name="SDF: another topic", at="//topicName", edit=set_text("some/other_topic")),
    Mutation(name="SDF: a model more", at="//world", edit=insert(
        "<model name='box'><link name='l'><inertial><mass>1</mass><inertia><ixx>0.17</ixx>"
        "<iyy>0.17</iyy><izz>0.17</izz></inertia></inertial><collision name='c'><geometry><box>"
        "<size>1 1 1</size></box></geometry></collision></link></model>")),
    Mutation(name="SDF: no plugin", at="//plugin", edit=remove),
)  # fmt: skip
"""Edits that are no faults: a check must report nothing new."""
