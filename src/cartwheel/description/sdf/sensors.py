"""SDF's ``<sensor>`` and ``<plugin>``, in SDF or in a URDF's tags."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterable, Sequence

from cartwheel.codes.tags import SENSOR_TWICE
from cartwheel.description.elements.numbers import LARGEST, within
from cartwheel.description.elements.xml import Node, copied, to_element
from cartwheel.description.losses import loss
from cartwheel.description.model import CameraIntrinsics, Pinhole, PluginTag, Sensor
from cartwheel.description.sdf.context import Context, read_pose
from cartwheel.description.sdf.noise_types import GAUSSIAN, noise_type, report_noises
from cartwheel.description.sdf.sensor_tags import mark_known
from cartwheel.errors import DescriptionError, Diagnostic
from cartwheel.geometry import Pose

MOST_PIXELS = 7680 * 4320
"""Maximum pixels of a camera image: 8K. Colour and depth take 230 MB while rendering."""
MOST_BENT = 1e6
"""Maximum distortion coefficient; real lenses have less than 100."""
NARROWEST = 1e-6
"""Minimum field of view of a camera, rad."""
_LOUDEST = 1e6
"""Maximum pixel noise, relative to full brightness."""
NEAREST = 1e-9
"""m; minimum distance of the near plane for OpenGL's precision."""


def read_plugin(node: Node) -> PluginTag:
    """A plugin with its parameters as written, which the plugin interprets."""
    filename = node.require("filename").strip()
    name = (node.get("name") or "").strip() or filename
    return PluginTag(name=name, filename=filename, element=to_element(node), origin=node.origin)


def read_plugins(owner: Node) -> list[PluginTag]:
    """The plugins of an element; ``__default__`` in SDF means none."""
    nodes = [node.mark() for node in owner.all("plugin")]
    return [read_plugin(node) for node in nodes if node.get("filename") != "__default__"]


def read_sensor(node: Node, link: str, pose: Pose | None = None) -> Sensor:
    """A sensor.

    Args:
        node: The element.
        link: The link that carries it.
        pose: Its pose in the link if it is already known; otherwise its ``<pose>`` is used.

    Raises:
        DescriptionError: A parameter is invalid.
    """
    kind = node.require("type").strip()
    title = (node.get("name") or "").strip() or kind
    update_rate = node.number_at("update_rate", 0.0)
    if update_rate < 0:
        raise node.fail(f'the update_rate of sensor "{title}" must not be negative')
    cameras = [read_camera(camera) for camera in node.all("camera")]
    mark_known(node)
    contact = node.child("contact")
    collisions = [each.text for each in contact.all("collision")] if contact is not None else []
    topic = node.text_at("topic").strip()
    if contact is not None and not topic:
        topic = contact.text_at("topic").strip().replace("__default_topic__", "")
    return Sensor(
        name=title,
        type=kind,
        link=link,
        pose=read_pose(node.child("pose")) if pose is None else pose,
        update_rate=update_rate,
        always_on=node.boolean_at("always_on", False),
        visualize=node.boolean_at("visualize", False),
        topic=topic or None,
        cameras=tuple(cameras),
        collisions=tuple(name for name in collisions if name and name != "__default__"),
        plugins=tuple(read_plugins(node)),
        element=copied(node),
        origin=node.origin,
    )


def read_sensors(
    nodes: Iterable[Node], read: Callable[[Node], Sensor], ctx: Context
) -> list[Sensor]:
    """The sensors that can be read; the others are reported as errors and ignored.

    Args:
        nodes: The elements.
        read: Reads one of them.
        ctx: Receives the errors.
    """
    sensors: list[Sensor] = []
    for node in nodes:
        try:
            sensors.append(read(node))
        except DescriptionError as error:
            node.mark()
            ctx.report(loss(error, "the sensor is ignored", of="sensor", origin=error.origin))
        else:
            report_noises(node, ctx)
    return sensors


def sensor_twice(link: str, sensor: Sensor) -> Diagnostic:
    """The warning about a second sensor with the same name, which Gazebo Classic accepts."""
    return SENSOR_TWICE.diagnostic(
        f'link "{link}" has two sensors named "{sensor.name}", which may publish on the same topic',
        origin=sensor.origin,
        values={"link": link, "name": sensor.name},
    )


def read_camera(node: Node) -> CameraIntrinsics:
    """The intrinsics of a camera, with SDF's defaults."""
    default = CameraIntrinsics()
    width = node.integer_at("image/width", default.width)
    height = node.integer_at("image/height", default.height)
    near = node.number_at("clip/near", default.near)
    far = node.number_at("clip/far", default.far)
    fov = node.number_at("horizontal_fov", default.horizontal_fov)
    if width < 1 or height < 1 or width * height > MOST_PIXELS:
        raise (node.find("image/width" if width < 1 else "image/height") or node).fail(
            f"an image must have at least 1 x 1 and at most {MOST_PIXELS:,} pixels (got "
            f"{width:.12g} x {height:.12g})"
        )
    if near < NEAREST or far > LARGEST:
        raise (node.find("clip/near" if near < NEAREST else "clip/far") or node).fail(
            f"<near> must be at least {NEAREST:g} m, and <far> at most {LARGEST:g} m "
            f"(got {near:g} and {far:g})"
        )
    if not near < far:
        raise (node.find("clip/near") or node).fail(
            f"<near> must be below <far> (got {near:g} m and {far:g} m)"
        )
    if not NARROWEST <= fov < 2 * math.pi:
        raise (node.child("horizontal_fov") or node).fail(
            f"<horizontal_fov> must be between {NARROWEST:g} and {2 * math.pi:.4g} rad (got "
            f"{fov:g})",
            f"If {fov:g} is in degrees, use {math.radians(fov):.4g}." if fov > 0 else None,
        )
    centre = node.find("distortion/center")
    cx, cy = centre.vector(2) if centre is not None else default.distortion_center
    mean, stddev = _noise(node.child("noise"))
    return CameraIntrinsics(
        name=(node.get("name") or "").strip(),
        pose=read_pose(node.child("pose")),
        horizontal_fov=fov,
        width=width,
        height=height,
        format=node.text_at("image/format") or default.format,
        near=near,
        far=far,
        k1=_bounded(node, "distortion/k1", MOST_BENT),
        k2=_bounded(node, "distortion/k2", MOST_BENT),
        k3=_bounded(node, "distortion/k3", MOST_BENT),
        p1=_bounded(node, "distortion/p1", MOST_BENT),
        p2=_bounded(node, "distortion/p2", MOST_BENT),
        distortion_center=(cx, cy),
        noise_mean=mean,
        noise_stddev=stddev,
        pinhole=_pinhole(node.find("lens/intrinsics"), ("fx", "fy", "cx", "cy")),
        projection=_pinhole(
            node.find("lens/projection"), ("p_fx", "p_fy", "p_cx", "p_cy", "tx", "ty")
        ),
    )


def _pinhole(node: Node | None, names: Sequence[str]) -> Pinhole | None:
    """The focal lengths and the principal point of a lens; None if it states none."""
    if node is None:
        return None
    values = {
        name.removeprefix("p_"): _bounded(node, name, MOST_PIXELS, default)
        for name, default in zip(names, dataclasses.astuple(Pinhole()), strict=False)
    }
    return Pinhole(**values)


def _bounded(node: Node, path: str, most: float, default: float = 0.0) -> float:
    origin = (node.find(path) or node).origin
    return within(node.number_at(path, default), most, f"<{path.rsplit('/', 1)[-1]}>", origin)


def _noise(node: Node | None) -> tuple[float, float]:
    """Mean and standard deviation of the pixel noise, relative to full brightness."""
    if node is None:
        return 0.0, 0.0
    if noise_type(node.text_at("type") or node.get("type") or GAUSSIAN[0]) not in GAUSSIAN:
        # Types that do not exist are reported by `report_noises`.
        return 0.0, 0.0
    mean, stddev = (_bounded(node, name, _LOUDEST) for name in ("mean", "stddev"))
    if stddev < 0:
        raise node.fail(f"the <stddev> of noise must not be negative (got {stddev:g})")
    return mean, stddev
