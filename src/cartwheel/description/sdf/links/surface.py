"""SDF's ``<surface>``: contact properties of a collision."""

from __future__ import annotations

from typing import Any

from cartwheel.codes.tags import VALUE_IGNORED
from cartwheel.description.elements.xml import Node
from cartwheel.description.sdf.context import Context

_NUMBERS = {
    "friction/ode/mu": "mu1",
    "friction/ode/mu2": "mu2",
    "friction/ode/slip1": "slip1",
    "friction/ode/slip2": "slip2",
    "friction/torsional/coefficient": "torsional",
    "contact/ode/kp": "kp",
    "contact/ode/kd": "kd",
    "contact/ode/min_depth": "min_depth",
    "bounce/restitution_coefficient": "restitution",
    "bounce/threshold": "bounce_threshold",
}
_BITMASKS = {
    "contact/collide_bitmask": "collide_bitmask",
    "contact/category_bitmask": "category_bitmask",
}
_BITS = 0xFFFFFFFF


def read_surface(node: Node, ctx: Context) -> dict[str, Any]:
    """The fields of `Surface` in a ``<surface>``: friction and contact as in ODE.

    Raises:
        DescriptionError: A value is invalid.
    """
    fields: dict[str, Any] = {}
    for path, name in _NUMBERS.items():
        value = not_negative(node.find(path), ctx)
        if value is not None:
            fields[name] = value
    for path, name in _BITMASKS.items():
        found = node.find(path)
        if found is not None:
            fields[name] = _bitmask(found)
    limit = node.find("contact/ode/max_vel")
    if limit is not None:
        fields["max_vel"] = limit.number(infinite=True)
    without = node.find("contact/collide_without_contact")
    if without is not None:
        fields["collide_without_contact"] = without.boolean()
    direction = node.find("friction/ode/fdir1")
    if direction is not None:
        vector = direction.vec3()
        # Gazebo writes 0 0 0 for no direction.
        fields["fdir1"] = vector if any(vector) else None
        for prefix in ("gz", "ignition"):
            stated = (direction.get(f"{prefix}:expressed_in") or "").strip()
            if stated:
                fields["fdir1_frame"] = stated
    fields.update(_patch(node))
    return fields


def not_negative(node: Node | None, ctx: Context) -> float | None:
    """A coefficient; -1, which some files write for "the default", is ignored."""
    if node is None:
        return None
    value = node.number(infinite=True)
    if value < 0:
        ctx.warn(
            VALUE_IGNORED,
            f"{node.tag} {node.text} is negative, so its default is used",
            origin=node.origin,
            values={"tag": node.tag, "stated": value},
        )
        return None
    return value


def _patch(node: Node) -> dict[str, Any]:
    """The size of the contact area, which determines torsional friction."""
    torsional = node.find("friction/torsional")
    if torsional is None:
        return {}
    patch = torsional.number_at("patch_radius", 0.0)
    surface = torsional.number_at("surface_radius", 0.0)
    if torsional.boolean_at("use_patch_radius", True):
        return {"patch_radius": max(0.0, patch)}
    return {"surface_radius": surface} if surface > 0 else {}


def _bitmask(node: Node) -> int:
    try:
        return int(node.text, 0) & _BITS
    except ValueError:
        raise node.fail(f'{node.tag} "{node.text}" is not an integer') from None
