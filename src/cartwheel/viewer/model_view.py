"""A model in the browser's scene: a frame for each link, with its shapes."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from cartwheel.description.inertia import tensor
from cartwheel.description.model import Box, Inertial, Link, Plane, Rgba, RobotDescription
from cartwheel.errors import CartwheelError
from cartwheel.geometry import (
    Array,
    Pose,
    matrix_from_quat,
    quat_from_matrix,
    quat_multiply,
    to_wxyz,
)
from cartwheel.viewer.shapes import (
    Surface,
    bounds_of,
    merge,
    place,
    surfaces_of_collision,
    surfaces_of_visual,
    triangles_of,
)
from cartwheel.viewer.skins import glb_of

COLLISION: Rgba = (0.96, 0.55, 0.15, 0.45)
INERTIA: Rgba = (0.55, 0.30, 0.75, 0.30)
_STILL = 1e-5
"""Threshold for changes in m and quaternion components: smaller than a pixel, but larger than the
jitter of resting bodies.
"""


class ModelView:
    """The scene nodes of a model, under ``/models/<name>``.

    The root node is the canonical link's frame, and the other links are relative to it. Links fixed
    to it, which are most links of a driving robot, then move with a single message. All browsers
    get the links and their visuals; `Look` adds parts for one browser.

    Args:
        scene: The viser scene.
        name: Model name.
        description: Description with the links.
        problem: Called with errors about shapes that cannot be drawn.
        clicked: viser callback for a click on the model; None if it cannot be selected.
    """

    def __init__(
        self,
        scene: Any,
        name: str,
        description: RobotDescription,
        *,
        problem: Callable[[CartwheelError], None] = lambda _: None,
        clicked: Any = None,
    ) -> None:
        self.name = name
        self.description = description
        self._problem = problem
        self._clicked = clicked
        self._root = f"/models/{_node(name)}"
        self._canonical = next(
            i for i, link in enumerate(description.links) if link.name == description.canonical_link
        )
        self.size = _size_of(description)
        """Largest extent, m, used to scale drawn elements."""
        self._frames = [
            scene.add_frame(self.path(link.name), show_axes=False) for link in description.links
        ]
        self._shown = np.full((len(self._frames), 7), np.nan)
        self._said: set[tuple[object, ...]] = set()
        self._visuals = self.add_visuals(scene)

    @property
    def visual_nodes(self) -> list[str]:
        """Scene nodes of the visuals."""
        return [handle.name for handle in self._visuals]

    @property
    def solids(self) -> list[Any]:
        """viser handles of the clickable visuals."""
        names = (handle.name.rsplit("/", 1)[1] for handle in self._visuals)
        return [
            handle
            for handle, name in zip(self._visuals, names, strict=True)
            if name.startswith("visual")
        ]

    def path(self, link: str) -> str:
        """Scene node of a link's frame."""
        if link == self.description.canonical_link:
            return self._root
        return f"{self._root}/{_node(link)}"

    def move(self, positions: Array, quaternions: Array) -> bool:
        """Moves the links, sends only changes, and returns whether anything changed.

        Args:
            positions: Shape (links, 3), m, in the world.
            quaternions: Shape (links, 4), (w, x, y, z), in the world.
        """
        poses = np.concatenate(_within(positions, quaternions, self._canonical), axis=1)
        with np.errstate(invalid="ignore"):
            still = np.abs(poses - self._shown).max(axis=1) < _STILL
        moved = np.flatnonzero(~still)
        for i in moved.tolist():
            handle = self._frames[i]
            handle.position = poses[i, :3]
            handle.wxyz = poses[i, 3:]
            self._shown[i] = poses[i]
        return bool(len(moved))

    def remove(self) -> None:
        """Removes all nodes from the scene."""
        self._frames[self._canonical].remove()

    # -- layers, in the shared scene or for one browser

    def add_visuals(
        self,
        scene: Any,
        *,
        opacity: float = 1.0,
        wireframe: bool = False,
        clickable: bool = True,
    ) -> list[Any]:
        """Adds the visuals; in a browser's own scene, they replace the shared ones.

        Args:
            scene: The viser scene.
            opacity: Opacity of opaque shapes except the ground.
            wireframe: Draw only edges.
            clickable: Whether a click selects the model.
        """
        nodes = []
        for link in self.description.links:
            for kind in ("ground", "visual"):
                for i, surface in enumerate(merge(self._surfaces(link, kind))):
                    ground = kind == "ground"
                    nodes.append(
                        self._mesh(
                            scene,
                            f"{self.path(link.name)}/{kind}_{i}",
                            surface,
                            ground=ground,
                            opacity=1.0 if ground else opacity,
                            wireframe=wireframe,
                            clickable=clickable and not ground,
                        )
                    )
        return nodes

    def add_collisions(self, scene: Any, *, wireframe: bool, clickable: bool) -> list[Any]:
        """Adds the collision shapes."""
        nodes = []
        for link in self.description.links:
            surfaces: list[Surface] = []
            for collision in link.collisions:
                if isinstance(collision.shape, Plane):
                    continue  # infinite planes would only colour the ground
                try:
                    surfaces += surfaces_of_collision(collision, COLLISION)
                except CartwheelError as error:
                    self._say(error)
            for i, surface in enumerate(merge(surfaces)):
                name = f"{self.path(link.name)}/collision_{i}"
                nodes.append(
                    self._mesh(scene, name, surface, wireframe=wireframe, clickable=clickable)
                )
        return nodes

    def add_inertias(self, scene: Any) -> list[Any]:
        """Adds the centres of mass, and boxes with the same inertia."""
        nodes = []
        for link in self.description.links:
            if link.inertial is None or self.description.static:
                continue
            pose, size = inertia_box(link.inertial)
            vertices, faces = triangles_of(Box(size=size))
            nodes.append(
                scene.add_mesh_simple(
                    f"{self.path(link.name)}/inertia",
                    vertices,
                    faces,
                    color=_rgb(INERTIA),
                    opacity=INERTIA[3],
                    cast_shadow=False,
                    receive_shadow=False,
                    position=pose.position,
                    wxyz=to_wxyz(pose.orientation),
                )
            )
            nodes.append(
                scene.add_icosphere(
                    f"{self.path(link.name)}/centre_of_mass",
                    radius=max(0.004, 0.02 * self.size),
                    color=(120, 40, 170),
                    position=link.inertial.pose.position,
                    cast_shadow=False,
                )
            )
        return nodes

    def add_names(self, scene: Any) -> list[Any]:
        """Adds the link names."""
        return [
            scene.add_label(f"{self.path(link.name)}/name", link.name, font_screen_scale=0.75)
            for link in self._shown_links()
        ]

    def add_axes(self, scene: Any) -> list[Any]:
        """Adds the link frames."""
        length = min(0.4, max(0.04, 0.18 * self.size))
        return [
            scene.add_frame(
                f"{self.path(link.name)}/axes",
                axes_length=length,
                axes_radius=length / 24,
                origin_radius=length / 12,
            )
            for link in self._shown_links()
        ]

    def _shown_links(self) -> tuple[Link, ...]:
        return () if self.description.static else self.description.links

    def _surfaces(self, link: Link, kind: str) -> list[Surface]:
        # A ground plane receives shadows but no clicks, because it is everywhere.
        surfaces: list[Surface] = []
        for visual in link.visuals:
            if isinstance(visual.shape, Plane) != (kind == "ground"):
                continue
            try:
                surfaces += surfaces_of_visual(visual)
            except CartwheelError as error:
                self._say(error)
        return surfaces

    def _say(self, error: CartwheelError) -> None:
        """Reports a shape that cannot be drawn once, for all browsers."""
        identity = error.diagnostic().identity
        if identity not in self._said:
            self._said.add(identity)
            self._problem(error)

    def _mesh(
        self,
        scene: Any,
        node: str,
        surface: Surface,
        *,
        ground: bool = False,
        opacity: float = 1.0,
        wireframe: bool = False,
        clickable: bool = False,
    ) -> Any:
        alpha = surface.rgba[3] * opacity
        common: dict[str, Any] = {
            "cast_shadow": not ground and surface.rgba[3] >= 1.0,
            # On a large plane, the browser's shadow cascades differ in darkness; a fixed value
            # avoids seams.
            "receive_shadow": 0.28 if ground else True,
            # Just below its collision height, and below the grid.
            "position": (0.0, 0.0, -0.004 if ground else 0.0),
        }
        # The browser cannot draw images transparent or as wireframes: use their mean colour
        # instead.
        if surface.picture is not None and opacity >= 1.0 and not wireframe:
            handle = scene.add_glb(node, glb_of(surface), **common)
        else:
            handle = scene.add_mesh_simple(
                node,
                surface.vertices,
                surface.faces,
                color=_rgb(_lighten(surface.rgba) if ground else surface.rgba),
                opacity=None if alpha >= 1.0 else alpha,
                wireframe=wireframe,
                side="double" if surface.rgba[3] < 1.0 else "front",
                **common,
            )
        if clickable and self._clicked is not None:
            handle.on_click(self._clicked)
        return handle


def inertia_box(inertial: Inertial) -> tuple[Pose, tuple[float, float, float]]:
    """The uniform box with the same mass and inertia: its pose in the link, and its edges, m."""
    moments, axes = np.linalg.eigh(tensor(inertial.diagonal, inertial.products))
    if np.linalg.det(axes) < 0:
        axes[:, 2] = -axes[:, 2]
    total = float(moments.sum())
    # I_x = m (b² + c²) / 12 and the same for y and z, solved for a².
    edges = [
        math.sqrt(max(1e-8, 6 * (total - 2 * moment) / inertial.mass))
        for moment in moments.tolist()
    ]
    turned = quat_multiply(inertial.pose.orientation, quat_from_matrix(axes))
    return Pose(inertial.pose.position, turned), (edges[0], edges[1], edges[2])


def footprint(description: RobotDescription) -> tuple[float, float]:
    """Maximum extent from the frame's origin in the plane, and depth below the origin, m."""
    found = bounds(description)
    if found is None:
        return 0.1, 0.0
    low, high = found
    reach = float(np.linalg.norm(np.maximum(np.abs(low), np.abs(high))[:2]))
    return reach, float(-low[2])


def _size_of(description: RobotDescription) -> float:
    found = bounds(description)
    return 0.3 if found is None else float(np.max(found[1] - found[0]))


def bounds(description: RobotDescription) -> tuple[Any, Any] | None:
    """Corners of the bounding box of all collisions in the model frame, m; None without any."""
    corners: list[Surface] = []
    for link in description.links:
        for collision in link.collisions:
            if isinstance(collision.shape, Plane):
                continue
            try:
                found = surfaces_of_collision(collision, COLLISION)
            except CartwheelError:
                continue  # already reported by the view that draws it
            corners += [Surface(place(link.pose, s.vertices), s.faces, s.rgba) for s in found]
    return bounds_of(corners)


def _within(positions: Array, quaternions: Array, root: int) -> tuple[Array, Array]:
    """All frames relative to the frame in row `root`, which stays relative to the world."""
    w, x, y, z = quaternions[root]
    turn = matrix_from_quat((x, y, z, w))
    inside = (positions - positions[root]) @ turn
    qw, qx, qy, qz = quaternions.T
    turned = np.stack(
        [
            w * qw + x * qx + y * qy + z * qz,
            w * qx - x * qw - y * qz + z * qy,
            w * qy + x * qz - y * qw - z * qx,
            w * qz - x * qy + y * qx - z * qw,
        ],
        axis=1,
    )
    # q and -q are the same rotation: normalize the sign, or a resting link seems to rotate.
    turned[turned[:, 0] < 0] *= -1
    inside[root], turned[root] = positions[root], quaternions[root]
    return inside, turned


def _lighten(rgba: Rgba) -> Rgba:
    """A colour halfway to white, so that shadows and dark robots are visible on the ground."""
    red, green, blue, alpha = rgba
    return ((red + 1) / 2, (green + 1) / 2, (blue + 1) / 2, alpha)


def _rgb(rgba: Sequence[float]) -> tuple[int, int, int]:
    red, green, blue = (round(255 * max(0.0, min(1.0, c))) for c in rgba[:3])
    return red, green, blue


def _node(name: str) -> str:
    """A name as one level in viser's scene tree."""
    return name.replace("/", "|") or "_"
