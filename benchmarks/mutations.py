"""Single mutations of a URDF: faults that a check must report, and edits that are no faults."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from lxml import etree

_SPACES = {"xacro": "http://www.ros.org/wiki/xacro"}
Element = Any
"""An element of lxml, which has no types."""
Edit = Callable[[Element], bool | None]
"""Changes the document at one element. False: the element gives no such fault."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Mutation:
    """One kind of change."""

    name: str
    at: str
    """An XPath of the elements at which it is made, one at a time."""
    edit: Edit
    code: str = ""
    """The name of the code that a check must report; empty if the change is no fault."""
    follows: tuple[str, ...] = ()
    """Codes of further faults that this change truly makes."""


def documents(text: str, mutation: Mutation, most: int) -> Iterator[str]:
    """The documents that a mutation makes of one, each with one change, at most so many."""
    root = etree.fromstring(text.encode())
    count = 0
    for index in range(len(root.xpath(mutation.at, namespaces=_SPACES))):
        changed = copy.deepcopy(root)
        if mutation.edit(changed.xpath(mutation.at, namespaces=_SPACES)[index]) is False:
            continue
        yield written(changed)
        count += 1
        if count == most:
            return


def written(root: Element) -> str:
    """A document as text."""
    return str(etree.tostring(root, encoding="unicode")) + "\n"


def swap_letters(word: str) -> str:
    """A word with two letters of its middle swapped, as in a typing error."""
    middle = len(word) // 2
    for at in (*range(middle, len(word)), *range(middle, 0, -1)):
        if word[at - 1] != word[at] and word[at - 1 : at + 1].isalpha():
            return word[: at - 1] + word[at] + word[at - 1] + word[at + 1 :]
    return word + "x"


def _numbers(text: str, factor: float) -> str:
    return " ".join(f"{float(each) * factor:.6g}" for each in text.split())


def misspell_attribute_value(name: str) -> Edit:
    """Misspells an attribute's value."""

    def edit(node: Element) -> None:
        node.set(name, swap_letters(node.get(name)))

    return edit


def misspell_attribute(name: str) -> Edit:
    """Misspells an attribute's name."""

    def edit(node: Element) -> None:
        node.set(swap_letters(name), node.attrib.pop(name))

    return edit


def misspell_text(node: Element) -> None:
    """Misspells an element's text."""
    node.text = swap_letters(node.text.strip())


def misspell_tag(node: Element) -> None:
    """Misspells an element's name."""
    space, brace, name = node.tag.rpartition("}")
    node.tag = space + brace + swap_letters(name)


def set_attributes(**values: str) -> Edit:
    """Sets attributes."""

    def edit(node: Element) -> bool:
        before = dict(node.attrib)
        for name, value in values.items():
            node.set(name, value)
        return dict(node.attrib) != before

    return edit


def set_text(text: str) -> Edit:
    """Sets an element's text."""

    def edit(node: Element) -> None:
        node.text = text

    return edit


def scale(factor: float, *names: str) -> Edit:
    """Multiplies the numbers of attributes, or of the text if no attribute is named."""

    def edit(node: Element) -> bool:
        if not names:
            before, node.text = node.text, _numbers(node.text, factor)
            return bool(node.text != before)
        changed = False
        for name in names:
            if name in node.attrib:
                value = _numbers(node.get(name), factor)
                changed |= any(float(each) for each in value.split())
                node.set(name, value)
        return changed

    return edit


def remove(node: Element) -> None:
    """Removes an element."""
    node.getparent().remove(node)


def drop_attribute(name: str) -> Edit:
    """Removes an attribute."""

    def edit(node: Element) -> None:
        del node.attrib[name]

    return edit


def repeat(**values: str) -> Edit:
    """Writes an element twice, the second time with other attributes."""

    def edit(node: Element) -> None:
        again = copy.deepcopy(node)
        for name, value in values.items():
            again.set(name, value)
        node.addnext(again)

    return edit


def repeat_text(node: Element) -> None:
    """Writes an element twice, the second time with another number."""
    again = copy.deepcopy(node)
    again.text = _numbers(node.text, 2.0)
    node.addnext(again)


def insert(text: str, *, after: bool = False) -> Edit:
    """Writes an element into, or after, another."""

    def edit(node: Element) -> None:
        new = etree.fromstring(text)
        new.tail = "\n"
        if after:
            node.addnext(new)
        else:
            node.insert(0, new)

    return edit


def swap_attributes(one: str, two: str) -> Edit:
    """Swaps the values of two attributes."""

    def edit(node: Element) -> bool:
        first, second = node.get(one), node.get(two)
        if first is None or second is None:
            return False
        node.set(one, second)
        node.set(two, first)
        return bool(first != second)

    return edit


def swap_texts(one: str, two: str) -> Edit:
    """Swaps the texts of two children."""

    def edit(node: Element) -> None:
        first, second = node.find(one), node.find(two)
        first.text, second.text = second.text, first.text

    return edit


def name_as_sibling(name: str = "name", child: str = "") -> Edit:
    """Gives an element, or its child, the value of the next element of its kind."""

    def edit(node: Element) -> bool:
        others = node.xpath(f"following-sibling::{node.tag}")
        if not others:
            return False
        target, source = (
            (node, others[0])
            if not child
            else (
                node.find(child),
                others[0].find(child),
            )
        )
        target.set(name, source.get(name))
        return True

    return edit


def move(distance: str) -> Edit:
    """Sets the origin of an element."""

    def edit(node: Element) -> None:
        origin = node.find("origin")
        if origin is None:
            origin = etree.SubElement(node, "origin")
            node.remove(origin)
            node.insert(0, origin)
        origin.set("xyz", distance)

    return edit


def rename_everywhere(node: Element) -> None:
    """Gives an element a new name, and all that refer to it."""
    old = node.get("name")
    new = f"{old}_renamed"
    for each in node.getroottree().iter():
        for name, value in each.attrib.items():
            if (
                value == old
                and name in ("name", "link", "joint", "reference")
                and (name != "name" or each is node)
            ):
                each.set(name, new)
        if each.text and each.text.strip() == old:
            each.text = new


def heavier(node: Element) -> None:
    """Makes a link a tenth heavier, with its inertia."""
    mass, inertia = node.find("mass"), node.find("inertia")
    mass.set("value", _numbers(mass.get("value"), 1.1))
    for name, value in inertia.attrib.items():
        inertia.set(name, _numbers(value, 1.1))


def to_the_end(node: Element) -> None:
    """Moves an element to the end of the document."""
    node.getparent().append(node)


def impossible(node: Element) -> None:
    """Makes one principal moment larger than the sum of the others."""
    node.set("izz", f"{1.5 * (float(node.get('ixx')) + float(node.get('iyy'))):.6g}")


def repeat_color(node: Element) -> None:
    """Defines a material twice, with two colors."""
    again = copy.deepcopy(node)
    again.find("color").set("rgba", "0 1 0 1")
    node.addnext(again)


def tall(node: Element) -> None:
    """Makes a box so tall that it reaches below the ground."""
    x, y, _ = node.get("size").split()
    node.set("size", f"{x} {y} 0.8")


def legacy(node: Element) -> None:
    """Asks for the drive's obsolete mode."""
    mode = node.find("legacyMode")
    if mode is None:
        mode = etree.SubElement(node, "legacyMode")
    mode.text = "true"


def nothing(node: Element) -> None:
    """Leaves the document as it is; only its text is written anew."""


def frictionless(node: Element) -> None:
    """Sets both coefficients of friction to 0."""
    for each in node.xpath("mu1 | mu2"):
        each.text = "0"


def bodiless(node: Element) -> None:
    """Removes all collisions but those of driven wheels."""
    for each in node.xpath(f"link[not(@name={_DRIVEN}/child/@link)]/collision"):
        remove(each)


def frame(node: Element) -> None:
    """Adds a link that is only a frame."""
    root = node.getparent()
    root.append(etree.fromstring('<link name="extra_frame"/>'))
    root.append(
        etree.fromstring(
            '<joint name="extra_joint" type="fixed"><origin xyz="0.01 0 0.02"/>'
            '<parent link="base_link"/><child link="extra_frame"/></joint>'
        )
    )


_INERTIA = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
_TOP = "/robot"
_MOVES = "[@type='revolute' or @type='prismatic']"
_OF_DRIVE = "[@name=//plugin/leftJoint or @name=//plugin/rightJoint]"
_DRIVEN = f"{_TOP}/joint{_OF_DRIVE}"
_WHEEL = f"{_TOP}/link[@name={_DRIVEN}/child/@link]"
_MOVING = f"{_TOP}/link[@name=//joint[@type!='fixed']/child/@link]"
_SENSOR = f"{_TOP}/gazebo/sensor"
_PARAMETER = "//plugin/*"
_SHIFTED = ("wheels-off-ground", "wheel-separation-mismatch", "center-of-mass-outside")

FAULTS: tuple[Mutation, ...] = (
    # Structure
    Mutation(name="parent misspelt", at=f"{_TOP}/joint/parent", code="joint-link-unknown",
        edit=misspell_attribute_value("link")),
    Mutation(name="child misspelt", at=f"{_TOP}/joint/child", code="joint-link-unknown",
        edit=misspell_attribute_value("link"), follows=("multiple-roots",)),
    Mutation(name="joint type misspelt", at=f"{_TOP}/joint", code="joint-type-unknown",
        edit=misspell_attribute_value("type")),
    Mutation(name="link twice", at=f"{_TOP}/link", code="duplicate-name", edit=repeat()),
    Mutation(name="joint with the name of the next", at=f"{_TOP}/joint", code="duplicate-name",
        edit=name_as_sibling(), follows=("drive-joint-unknown", "mimic-unknown",
            "drive-joint-not-continuous", "wheel-separation-mismatch")),
    Mutation(name="link without a name", at=f"{_TOP}/link[1]", code="name-missing",
        edit=insert("<link/>", after=True)),
    Mutation(name="joint removed", at=f"{_TOP}/joint", code="multiple-roots", edit=remove,
        follows=("drive-joint-unknown", "mimic-unknown")),
    Mutation(name="child of two joints", at=f"{_TOP}/joint", code="multiple-parents",
        edit=name_as_sibling("link", "child"),
        follows=("multiple-roots", "wheel-frictionless")),
    Mutation(name="mimic misspelt", at="//mimic", code="mimic-unknown",
        edit=misspell_attribute_value("joint")),
    Mutation(name="mimic of itself", at="//mimic", code="mimic-unknown",
        edit=lambda node: node.set("joint", node.getparent().get("name"))),
    Mutation(name="gazebo reference misspelt", at=f"{_TOP}/gazebo[@reference]",
        code="reference-unknown", edit=misspell_attribute_value("reference")),
    # Joints
    Mutation(name="limit removed", at=f"{_TOP}/joint{_MOVES}/limit", code="limit-missing",
        edit=remove),
    Mutation(name="effort removed", at=f"{_TOP}/joint{_MOVES}/limit", code="limit-incomplete",
        edit=drop_attribute("effort")),
    Mutation(name="velocity removed", at=f"{_TOP}/joint{_MOVES}/limit", code="limit-incomplete",
        edit=drop_attribute("velocity")),
    Mutation(name="limits swapped", at=f"{_TOP}/joint{_MOVES}/limit", code="limit-reversed",
        edit=swap_attributes("lower", "upper")),
    Mutation(name="limits in degrees", at=f"{_TOP}/joint[@type='revolute']/limit",
        code="limit-in-degrees", edit=scale(57.29578, "lower", "upper")),
    Mutation(name="limits of 0", at=f"{_TOP}/joint{_MOVES}/limit", code="limit-zero",
        edit=set_attributes(lower="0", upper="0")),
    Mutation(name="effort below 0", at="//limit[@effort]", code="value-ignored",
        edit=scale(-1.0, "effort")),
    Mutation(name="effort of 0", at=f"{_DRIVEN}/limit", code="effort-zero",
        edit=set_attributes(effort="0")),
    Mutation(name="axis of length 0", at="//axis", code="axis-zero",
        edit=set_attributes(xyz="0 0 0")),
    Mutation(name="axis of length 2", at="//axis", code="axis-not-normalized",
        edit=scale(2.0, "xyz")),
    Mutation(name="axis misspelt", at="//axis", code="tag-ignored", edit=misspell_tag,
        follows=("wheel-axis-misaligned", "wheel-not-round", "wheel-diameter-mismatch",
            "overlapping-collisions")),
    # Mass and inertia
    Mutation(name="inertial removed", at=f"{_MOVING}/inertial", code="inertia-missing",
        edit=remove),
    Mutation(name="inertia misspelt", at="//link/inertial/inertia", code="tag-ignored",
        edit=misspell_tag, follows=("tag-missing", "inertia-missing",
            "inertia-impossible")),
    Mutation(name="inertia against the triangle inequality", at="//link/inertial/inertia",
        code="inertia-impossible", edit=impossible, follows=("inertia-geometry-mismatch",)),
    Mutation(name="inertia below 0", at="//link/inertial/inertia", code="inertia-impossible",
        edit=scale(-1.0, "ixx"), follows=("inertia-geometry-mismatch",)),
    Mutation(name="inertia times 100", at="//link/inertial/inertia",
        code="inertia-geometry-mismatch", edit=scale(100.0, *_INERTIA)),
    Mutation(name="inertia by 10,000", at="//link/inertial/inertia",
        code="inertia-geometry-mismatch", edit=scale(1e-4, *_INERTIA)),
    Mutation(name="mass below 0", at="//link/inertial/mass", code="mass-not-positive",
        edit=scale(-1.0, "value")),
    Mutation(name="mass of 0", at=f"{_MOVING}/inertial/mass", code="mass-not-positive",
        edit=set_attributes(value="0")),
    Mutation(name="mass in grams", at="//link/inertial/mass", code="mass-in-grams",
        edit=scale(1000.0, "value"), follows=("inertia-geometry-mismatch",)),
    Mutation(name="center of mass 5 m away", at="//link/inertial", code="center-of-mass-outside",
        edit=move("5 0 0")),
    Mutation(name="mass malformed", at="//link/inertial/mass", code="value-invalid",
        edit=set_attributes(value="heavy")),
    # Units and numbers
    Mutation(name="joint in millimetres", at="//joint/origin[@xyz]",
        code="position-in-millimetres", edit=scale(1000.0, "xyz"), follows=_SHIFTED),
    Mutation(name="angles in degrees", at="//origin[@rpy]", code="angle-in-degrees",
        edit=scale(57.29578, "rpy"), follows=("wheel-not-round", "wheel-diameter-mismatch")),
    Mutation(name="position with commas", at="//origin[@xyz]", code="value-invalid",
        edit=lambda node: node.set("xyz", node.get("xyz").replace(" ", ", "))),
    Mutation(name="position of two numbers", at="//origin[@xyz]", code="value-invalid",
        edit=lambda node: node.set("xyz", node.get("xyz").rpartition(" ")[0])),
    # Geometry
    Mutation(name="box times 100", at="//collision/geometry/box", code="shape-out-of-scale",
        edit=scale(100.0, "size"), follows=("inertia-geometry-mismatch", "wheels-off-ground",
            "overlapping-collisions", "view-blocked")),
    Mutation(name="mesh in millimetres", at="//geometry/mesh", code="shape-out-of-scale",
        edit=set_attributes(scale="1000 1000 1000"), follows=("inertia-geometry-mismatch",
            "view-blocked")),
    Mutation(name="mesh missing", at="//geometry/mesh", code="file-missing",
        edit=misspell_attribute_value("filename")),
    Mutation(name="size misspelt", at="//geometry/box", code="tag-missing",
        edit=misspell_attribute("size"), follows=("tag-ignored",)),
    Mutation(name="radius misspelt", at="//geometry/cylinder | //geometry/sphere",
        code="tag-missing", edit=misspell_attribute("radius"), follows=("tag-ignored",)),
    Mutation(name="geometry removed", at="//collision/geometry", code="tag-missing", edit=remove),
    Mutation(name="radius below 0", at="//geometry/cylinder | //geometry/sphere",
        code="value-invalid", edit=scale(-1.0, "radius")),
    Mutation(name="shape misspelt", at="//geometry/*", code="type-unknown",
        edit=misspell_tag),
    Mutation(name="collision misspelt", at="//link/collision", code="tag-ignored",
        edit=misspell_tag, follows=("base-without-collision", "wheel-without-collision",
            "contact-collision-unknown", "contact-never-fires")),
    Mutation(name="visual misspelt", at="//link/visual", code="tag-ignored", edit=misspell_tag),
    Mutation(name="position misspelt", at="//link//origin[@xyz]", code="tag-ignored",
        edit=misspell_attribute("xyz"), follows=("wheels-off-ground",)),
    Mutation(name="collisions of the body removed", at=_TOP, code="base-without-collision",
        edit=bodiless, follows=("contact-collision-unknown", "contact-never-fires", "tag-ignored")),
    Mutation(name="mass twice", at="//link/inertial/mass", code="tag-repeated",
        edit=repeat(value="9")),
    Mutation(name="limit twice", at="//joint/limit", code="tag-repeated",
        edit=repeat(velocity="9")),
    # Materials
    Mutation(name="material misspelt", at="//visual/material", code="material-undefined",
        edit=misspell_attribute_value("name")),
    Mutation(name="material of Gazebo misspelt", at="//gazebo/material", code="material-unknown",
        edit=lambda node: setattr(node, "text", "Gazebo/" + swap_letters(node.text[7:]))),
    Mutation(name="material with two colors", at=f"{_TOP}/material", code="material-differs",
        edit=repeat_color),
    # Drives
    Mutation(name="drive joint misspelt", at="//leftJoint | //rightJoint",
        code="drive-joint-unknown", edit=misspell_text),
    Mutation(name="drive joint missing", at="//leftJoint | //rightJoint",
        code="plugin-parameter-missing", edit=remove),
    Mutation(name="wheel fixed", at=_DRIVEN, code="drive-joint-not-continuous",
        edit=set_attributes(type="fixed"), follows=("tag-ignored",)),
    Mutation(name="wheel separation times 1.1", at="//wheelSeparation",
        code="wheel-separation-mismatch", edit=scale(1.1)),
    Mutation(name="wheel separation halved", at="//wheelSeparation",
        code="wheel-separation-mismatch", edit=scale(0.5)),
    Mutation(name="wheel diameter times 1.1", at="//wheelDiameter",
        code="wheel-diameter-mismatch", edit=scale(1.1)),
    Mutation(name="radius for diameter", at="//wheelDiameter", code="wheel-diameter-mismatch",
        edit=scale(0.5)),
    Mutation(name="wheels swapped", at="//plugin[leftJoint]", code="wheels-swapped",
        edit=swap_texts("leftJoint", "rightJoint")),
    Mutation(name="wheel axis reversed", at=f"{_DRIVEN}/axis", code="wheel-axis-misaligned",
        edit=scale(-1.0, "xyz")),
    Mutation(name="wheel axis forward", at=f"{_DRIVEN}/axis", code="wheel-axis-misaligned",
        edit=set_attributes(xyz="1 0 0"), follows=("wheel-not-round", "wheel-diameter-mismatch")),
    Mutation(name="wheel lying", at=f"{_WHEEL}/collision/origin", code="wheel-not-round",
        edit=set_attributes(rpy="0 0 0"), follows=("wheel-diameter-mismatch",
            "inertia-geometry-mismatch", "overlapping-collisions")),
    Mutation(name="wheel without collision", at=f"{_WHEEL}/collision", edit=remove,
        code="wheel-without-collision", follows=("tag-ignored",)),
    Mutation(name="wheel without friction", code="wheel-frictionless",
        at=f"{_TOP}/gazebo[@reference={_DRIVEN}/child/@link][mu1]",
        edit=frictionless),
    Mutation(name="wheel torque of 0", at="//wheelTorque", code="effort-zero",
        edit=set_text("0")),
    Mutation(name="caster with friction", at="//gazebo[@reference='caster_link']",
        code="caster-friction", edit=lambda node: setattr(node.find("mu1"), "text", "1")),
    Mutation(name="body below the wheels", at="//link[@name='base_link']/collision/geometry/box",
        code="wheels-off-ground", edit=tall),
    # Plugins
    Mutation(name="plugin's file misspelt", at="//plugin", code="plugin-unknown",
        edit=lambda node: node.set("filename", "libgazebo_ros_" + swap_letters(
            node.get("filename")[14:-3]) + ".so")),
    Mutation(name="parameter misspelt", at=_PARAMETER, code="plugin-parameter-unknown",
        edit=misspell_tag, follows=("plugin-parameter-missing", "plugin-idle",
            "wheel-diameter-mismatch", "wheel-separation-mismatch", "duplicate-topic")),
    Mutation(name="number malformed", code="plugin-parameter-invalid", edit=set_text("fast"),
        at="//plugin/updateRate | //wheelSeparation | //wheelDiameter"),
    Mutation(name="legacy mode", at="//plugin[leftJoint]", code="plugin-parameter-obsolete",
        edit=legacy),
    Mutation(name="body misspelt", at="//bodyName", code="body-unknown", edit=misspell_text),
    Mutation(name="frame misspelt", at="//robotBaseFrame | //frameName", code="frame-unknown",
        edit=misspell_text),
    Mutation(name="topic with a blank", code="topic-invalid", edit=set_text("my topic"),
        at="//topicName | //odometryTopic | //commandTopic | //bumperTopicName"),
    Mutation(name="topic of another plugin", code="duplicate-topic", edit=set_text("odom"),
        at="//topicName | //bumperTopicName"),
    # Tags of Gazebo, and sensors
    Mutation(name="tag of Gazebo misspelt", at="//gazebo[@reference]/*[not(self::sensor)]",
        code="tag-ignored", edit=misspell_tag, follows=("caster-friction",)),
    Mutation(name="tag of Gazebo empty", code="tag-empty", edit=set_text(""),
        follows=("caster-friction",),
        at="//gazebo[@reference]/mu1 | //gazebo[@reference]/kp"),
    Mutation(name="tag of Gazebo twice", at="//gazebo[@reference]/mu1 | //gazebo[@reference]/kp",
        code="tag-repeated", edit=repeat_text),
    Mutation(name="friction without a reference", at="/robot/gazebo[not(@reference)]",
        code="tag-misplaced", edit=insert("<mu1>1</mu1>")),
    Mutation(name="sensor type misspelt", at=_SENSOR, code="sensor-type-unknown",
        edit=misspell_attribute_value("type")),
    Mutation(name="sensor without a name", at=_SENSOR, code="name-missing",
        edit=drop_attribute("name")),
    Mutation(name="sensor twice", at=_SENSOR, code="sensor-twice", edit=repeat(),
        follows=("duplicate-topic",)),
    Mutation(name="tag of a sensor misspelt", code="tag-ignored", edit=misspell_tag,
        at=f"{_SENSOR}//*[not(self::plugin or ancestor::plugin)]",
        follows=("tag-missing", "sensor-incomplete", "contact-collision-unknown",
            "scan-samples-invalid")),
    Mutation(name="rate of 5 kHz", at=f"{_SENSOR}/update_rate | //plugin/updateRate",
        code="rate-above-physics", edit=set_text("5000")),
    Mutation(name="clip planes swapped", at=f"{_SENSOR}//clip", code="value-invalid",
        edit=swap_texts("near", "far")),
    Mutation(name="range swapped", at=f"{_SENSOR}//range", code="sensor-range-invalid",
        edit=swap_texts("min", "max")),
    Mutation(name="field of view in degrees", at="//horizontal_fov", code="value-invalid",
        edit=scale(57.29578)),
    Mutation(name="scan angle in degrees", at="//max_angle", code="sensor-range-invalid",
        edit=scale(57.29578)),
    Mutation(name="image format misspelt", at="//image/format", code="image-format-unknown",
        edit=set_text("R8B8G8")),
    Mutation(name="contact's collision misspelt", at="//contact/collision",
        code="contact-collision-unknown", edit=misspell_text),
    Mutation(name="image of width 0", at="//image/width", code="value-invalid",
        edit=set_text("0")),
)  # fmt: skip
"""Each with the code that a check must report."""

HARMLESS: tuple[Mutation, ...] = (
    Mutation(name="written anew", at="/robot", edit=nothing),
    Mutation(name="link renamed everywhere", at="/robot/link[not(@name=//contact/../../@reference)]"
        "[not(@name='base_footprint')]", edit=rename_everywhere),
    Mutation(name="joint renamed everywhere", at="/robot/joint", edit=rename_everywhere),
    Mutation(name="link moved to the end of the file", at="/robot/link", edit=to_the_end),
    Mutation(name="a tenth heavier", at="//link/inertial", edit=heavier),
    Mutation(name="inertia times 1.5", at="//link/inertial/inertia", edit=scale(1.5, *_INERTIA)),
    Mutation(name="mass times 1.2", at="//link/inertial/mass", edit=scale(1.2, "value")),
    Mutation(name="narrower limits", at="//joint/limit[@lower]", edit=scale(0.7, "lower", "upper")),
    Mutation(name="half the effort", at="//limit[@effort]", edit=scale(0.5, "effort")),
    Mutation(name="wheel separation times 1.001", at="//wheelSeparation", edit=scale(1.001)),
    Mutation(name="half the rate", at="//updateRate | //update_rate", edit=scale(0.5)),
    Mutation(name="friction times 0.8", at="//gazebo[@reference]/mu1", edit=scale(0.8)),
    Mutation(name="another color", at="//material/color", edit=set_attributes(rgba="1 0.5 0 1")),
    Mutation(name="far plane farther", at="//clip/far", edit=scale(2.0)),
    Mutation(name="another topic", at="//commandTopic | //odometryTopic",
        edit=set_text("some/other_topic")),
    Mutation(name="an unused link of a frame", at="/robot/link[@name='base_link']",
        edit=frame),
)  # fmt: skip
"""Edits that are no faults: a check must report nothing new."""
