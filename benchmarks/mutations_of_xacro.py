"""Single mutations of a xacro: faults that a check must report, and harmless edits."""

from __future__ import annotations

from collections.abc import Callable

from benchmarks.mutations import (
    Edit,
    Element,
    Mutation,
    drop_attribute,
    insert,
    misspell_attribute,
    misspell_tag,
    misspell_text,
    nothing,
    remove,
    scale,
    set_attributes,
    swap_letters,
)

_CALLS = "//xacro:wheel | //xacro:flap | //xacro:box_inertial"
_XACRO = "xmlns:xacro='http://www.ros.org/wiki/xacro'"


def misspell_word(prefix: str, attribute: str) -> Edit:
    """Misspells the name behind a prefix, such as ``${``, in an attribute."""

    def edit(node: Element) -> bool:
        before, found, rest = node.get(attribute, "").partition(prefix)
        word = rest.strip("}) ")
        if not found or not word.isidentifier():
            return False
        node.set(attribute, before + prefix + rest.replace(word, swap_letters(word)))
        return True

    return edit


def set_property(name: str, change: Callable[[float], float]) -> Edit:
    """Changes the number of a property."""

    def edit(node: Element) -> bool:
        if node.get("name") != name:
            return False
        node.set("value", f"{change(float(node.get('value'))):g}")
        return True

    return edit


FAULTS: tuple[Mutation, ...] = (
    # Names
    Mutation(name="xacro: argument misspelt where it is used", at="//xacro:property | //xacro:if",
        code="xacro-name-unknown", edit=misspell_word("$(arg ", "value"),
        follows=("argument-unused",)),
    Mutation(name="xacro: argument misspelt where it is declared", at="//xacro:arg",
        code="xacro-name-unknown", edit=lambda node: node.set("name", swap_letters(
            node.get("name"))), follows=("argument-unused",)),
    Mutation(name="xacro: property misspelt where it is used", at="//cylinder",
        code="xacro-name-unknown", edit=misspell_word("${", "radius")),
    Mutation(name="xacro: property removed", at="//xacro:property", code="xacro-name-unknown",
        edit=remove, follows=("argument-unused",)),
    Mutation(name="xacro: macro removed", at="//xacro:macro", code="xacro-name-unknown",
        edit=remove),
    Mutation(name="xacro: call misspelt", at=_CALLS, code="xacro-name-unknown", edit=misspell_tag),
    Mutation(name="xacro: block misspelt", at="//xacro:insert_block", code="xacro-name-unknown",
        edit=lambda node: node.set("name", "plcae")),
    Mutation(name="xacro: include misspelt", at="/robot", code="include-absent",
        edit=insert(f"<xacro:include {_XACRO} filename='wheels.xacro'/>")),
    Mutation(name="xacro: call without a prefix", at="//xacro:wheel", code="xacro-prefix",
        edit=lambda node: setattr(node, "tag", "wheel")),
    # Calls
    Mutation(name="xacro: parameter missing", at="//xacro:wheel | //xacro:flap",
        code="macro-call-invalid",
        edit=lambda node: node.attrib.pop(list(node.attrib)[-1]) and None),
    Mutation(name="xacro: parameter misspelt", at="//xacro:wheel", code="macro-call-invalid",
        edit=misspell_attribute("reflect")),
    Mutation(name="xacro: parameter too many", at=_CALLS, code="macro-call-invalid",
        edit=set_attributes(colour="red")),
    Mutation(name="xacro: block missing", at="//xacro:flap/origin", code="macro-call-invalid",
        edit=remove),
    # Expressions
    Mutation(name="xacro: bracket missing", at="//inertia", code="expression-invalid",
        edit=lambda node: node.set("iyy", node.get("iyy").replace("}", ")}"))
            if "$" in node.get("iyy") else False),
    Mutation(name="xacro: division by zero", at="//cylinder", code="expression-invalid",
        edit=set_attributes(radius="${radius/0}")),
    Mutation(name="xacro: text in a sum", at="//cylinder", code="expression-invalid",
        edit=set_attributes(radius="${radius + 'm'}")),
    Mutation(name="xacro: condition that is no truth value", at="//xacro:if",
        code="xacro-invalid", edit=set_attributes(value="perhaps")),
    # What nothing uses
    Mutation(name="xacro: argument too many", at="/robot", code="argument-unused",
        edit=insert(f"<xacro:arg {_XACRO} name='height' default='1'/>")),
    Mutation(name="xacro: property too many", at="/robot", code="property-unused",
        edit=insert(f"<xacro:property {_XACRO} name='height' value='1'/>")),
    Mutation(name="xacro: property twice", at="//xacro:property", code="property-overwritten",
        edit=lambda node: node.addprevious(type(node).makeelement(node, node.tag, {
            "name": node.get("name"), "value": "7"}))),
    Mutation(name="xacro: parameter that is not used", at="//xacro:macro",
        code="parameter-unused", edit=lambda node: node.set(
            "params", "height:=1 " + node.get("params"))),
    Mutation(name="xacro: macro that is not called", at="/robot", code="macro-unused",
        edit=insert(f"<xacro:macro {_XACRO} name='arm' params=''><link name='a'/></xacro:macro>")),
    # Faults in macros and in values
    Mutation(name="xacro: tag in a macro misspelt", at="//xacro:macro//link/*[not(xacro:*)]"
        "[not(self::xacro:box_inertial)] | //xacro:macro//gazebo/*", code="tag-ignored",
        edit=misspell_tag, follows=("wheel-without-collision", "inertia-missing")),
    Mutation(name="xacro: parent in a macro misspelt", at="//xacro:macro//parent",
        code="joint-link-unknown", edit=set_attributes(link="base_lnik")),
    Mutation(name="xacro: name of a link not of a macro's parameter", at="//xacro:macro/link",
        code="duplicate-name", edit=set_attributes(name="part"),
        follows=("joint-link-unknown", "reference-unknown", "multiple-roots")),
    Mutation(name="xacro: gazebo reference in a macro misspelt",
        at="//xacro:macro//gazebo[@reference]", code="reference-unknown",
        edit=set_attributes(reference="${side}_whele")),
    Mutation(name="xacro: inertia in a macro impossible", at="//xacro:macro//inertia",
        code="inertia-impossible", edit=set_attributes(izz="1"),
        follows=("inertia-geometry-mismatch",)),
    Mutation(name="xacro: mass in grams", at="//xacro:property", code="mass-in-grams",
        edit=set_property("wheel_mass", lambda value: 1000 * value),
        follows=("inertia-geometry-mismatch",)),
    Mutation(name="xacro: limits in degrees", at="//xacro:property", code="limit-in-degrees",
        edit=set_property("swing", lambda _: 70)),
    Mutation(name="xacro: angle in degrees", at="//xacro:flap/origin", code="angle-in-degrees",
        edit=set_attributes(rpy="0 0 ${60/2}")),
    Mutation(name="xacro: separation not that of the wheels", at="//joint/origin",
        code="wheel-separation-mismatch", edit=lambda node: node.set("xyz", node.get(
            "xyz").replace("separation/2", "separation")) if "separation" in node.get(
            "xyz", "") else False),
    Mutation(name="xacro: radius for diameter", at="//wheelDiameter",
        code="wheel-diameter-mismatch", edit=lambda node: setattr(node, "text", "${radius}")),
    Mutation(name="xacro: wheels without friction", at="//xacro:macro[@name='wheel']",
        code="wheel-frictionless", edit=lambda node: node.set("params", node.get(
            "params").replace("1.0", "0"))),
    Mutation(name="xacro: wheel axis forward", at="//xacro:macro[@name='wheel']//axis",
        code="wheel-axis-misaligned", edit=set_attributes(xyz="1 0 0"),
        follows=("wheel-not-round", "wheel-diameter-mismatch")),
    Mutation(name="xacro: axis in a macro of length 0", at="//xacro:macro//axis",
        code="axis-zero", edit=set_attributes(xyz="0 0 0"), follows=("wheel-axis-misaligned",
            "wheel-not-round", "wheel-diameter-mismatch")),
    Mutation(name="xacro: limit in a macro without effort", at="//xacro:macro//limit",
        code="limit-incomplete", edit=drop_attribute("effort")),
    Mutation(name="xacro: number malformed", at="//cylinder", code="value-invalid",
        edit=set_attributes(length="${width} m")),
    Mutation(name="xacro: drive joint misspelt", at="//leftJoint | //rightJoint",
        code="drive-joint-unknown", edit=misspell_text),
)  # fmt: skip
"""Each with the code that a check must report."""

HARMLESS: tuple[Mutation, ...] = (
    Mutation(name="xacro: written anew", at="/robot", edit=nothing),
    Mutation(name="xacro: smaller wheels", at="//xacro:arg[@name='wheel_radius']",
        edit=set_attributes(default="0.11")),
    Mutation(name="xacro: without the lidar", at="//xacro:arg[@name='lidar']",
        edit=set_attributes(default="false")),
    Mutation(name="xacro: wider", at="//xacro:property", edit=set_property(
        "separation", lambda value: 1.1 * value)),
    Mutation(name="xacro: less friction", at="//xacro:wheel", edit=set_attributes(friction="0.8")),
    Mutation(name="xacro: a flap less", at="//xacro:flap", edit=remove),
    Mutation(name="xacro: body a tenth longer", at="//xacro:property", edit=set_property(
        "body_x", lambda value: 1.1 * value)),
    Mutation(name="xacro: limit by a number", at="//xacro:macro//limit",
        edit=set_attributes(upper="0.5")),
    Mutation(name="xacro: stiffer", at="//kp", edit=scale(2.0)),
)  # fmt: skip
"""Edits that are no faults: a check must report nothing new."""
