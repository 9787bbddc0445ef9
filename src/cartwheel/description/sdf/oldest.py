"""Converts SDF 1.0 to 1.2 to 1.3, in which most attributes became elements.

Source: sdformat's ``sdf/1.2/1_0.convert`` and the descriptions of these versions.
"""

from __future__ import annotations

from cartwheel.description.elements.node import Node

_RANGE = ("samples", "resolution", "min_angle", "max_angle")
_RANGES = dict.fromkeys(("horizontal", "vertical"), _RANGE)
_AXES = dict.fromkeys(("axis", "axis2"), ("xyz",))
_TO_ELEMENTS: dict[str, tuple[str, ...]] = {
    **_RANGES,
    **_AXES,
    "physics": ("update_rate",),
    "solver": ("type", "dt", "iters", "precon_iters", "sor"),
    "constraints": ("cfm", "erp", "contact_max_correcting_vel", "contact_surface_layer"),
    "light": ("cast_shadows",),
    "spot": ("inner_angle", "outer_angle", "falloff"),
    "attenuation": ("range", "linear", "constant", "quadratic"),
    "fog": ("type", "start", "end", "density", "color"),
    "model": ("static",),
    "grasp_check": ("detach_steps", "attach_steps", "min_contact_count"),
    "link": ("gravity", "self_collide", "kinematic"),
    "inertial": ("mass", "density"),
    "inertia": ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"),
    "sensor": ("always_on", "update_rate", "visualize"),
    "range": ("min", "max", "resolution"),
    "image": ("width", "height", "format", "uri", "scale", "threshold", "granularity"),
    "clip": ("near", "far"),
    "depth_camera": ("output",),
    "collision": ("laser_retro",),
    "visual": ("cast_shadows", "laser_retro", "transparency"),
    "bounce": ("restitution_coefficient", "threshold"),
    "ode": (
        *("mu", "mu2", "fdir1", "slip1", "slip2"),
        *("soft_cfm", "soft_erp", "kp", "kd", "max_vel", "min_depth"),
    ),
    "box": ("size",),
    "sphere": ("radius",),
    "cylinder": ("radius", "length"),
    "mesh": ("uri", "scale"),
    "heightmap": ("uri", "size", "pos"),
    "plane": ("normal",),
    "material": ("script",),
    "dynamics": ("damping", "friction"),
    "limit": ("lower", "upper", "effort", "velocity", "cfm", "erp"),
    "suspension": ("cfm", "erp"),
    "include": ("uri",),
}
"""Attributes that became elements with the same name, by element."""
_TO_TEXT = {
    **dict.fromkeys(("ambient", "background", "diffuse", "specular", "emissive"), "rgba"),
    **dict.fromkeys(("shadows", "grid"), "enabled"),
    **dict.fromkeys(("gravity", "direction"), "xyz"),
    **dict.fromkeys(("parent", "child"), "link"),
    "horizontal_fov": "angle",
    "pose": "pose",
}
"""Attributes that became their element's text."""
_TAGS = {"origin": "pose", "body": "link", "geom": "geometry"}
"""Elements that were renamed."""
_NAMES = {
    ("mesh", "filename"): "uri",
    ("image", "filename"): "uri",
    ("heightmap", "filename"): "uri",
    ("heightmap", "origin"): "pos",
    ("include", "filename"): "uri",
    ("fog", "rgba"): "color",
    ("link", "damping"): "velocity_decay",
}
"""Attributes and elements that were renamed, by parent element."""
_THEIR_OWN = ("plugin",)
"""Elements whose contents are not SDF."""


def as_modern(root: Node) -> Node:
    """Converts a document from SDF 1.0 to 1.2 to SDF 1.3."""
    made = _converted(root)
    made.get("version")
    return made


def _converted(node: Node, parent: str = "") -> Node:
    tag = _NAMES.get((parent, node.tag), _TAGS.get(node.tag, node.tag))
    if tag in _THEIR_OWN:
        return node
    attributes: dict[str, str] = {}
    children = [_converted(child, tag) for child in node.children]
    text = node.text
    for name, value in node.attributes.items():
        new = _NAMES.get((tag, name), name)
        if new in _TO_ELEMENTS.get(tag, ()):
            children.append(Node(new, {}, node.origin, text=value))
        elif _TO_TEXT.get(tag) == name:
            text = value
        else:
            attributes[name] = value
    children = [_named(child) if child.tag == "script" else child for child in children]
    made = Node("sdf" if tag == "gazebo" else tag, attributes, node.origin, children, text)
    made.notes = node.notes
    return made


def _named(script: Node) -> Node:
    """Converts a ``<script>`` whose text or attribute is the material's name."""
    if not script.text.strip():
        return script
    name = Node("name", {}, script.origin, text=script.text)
    return Node("script", script.attributes, script.origin, [*script.children, name])
