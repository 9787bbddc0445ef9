"""One model in the browser's scene: a frame for each link, and what hangs on it."""

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
from cartwheel.viewer.display import Display
from cartwheel.viewer.shapes import (
    Surface,
    bounds_of,
    merge,
    place,
    surfaces_of_collision,
    surfaces_of_visual,
    triangles_of,
)
from cartwheel.viewer.skins import PicturedSkin, Skin, glb_of

COLLISION: Rgba = (0.96, 0.55, 0.15, 0.45)
INERTIA: Rgba = (0.55, 0.30, 0.75, 0.30)
_SEE_THROUGH = 0.35
_STILL = 1e-5
"""m, and parts of a unit quaternion: no screen shows less, and resting bodies shiver less."""


class ModelView:
    """A model's nodes, under ``/models/<name>``.

    The root node is the canonical link's frame; the other links are given in it. What is fixed
    to that link, on a driving robot nearly everything, then moves with a single message.

    Args:
        scene: viser's.
        name: Of the model.
        description: Its links.
        problem: Told of what cannot be drawn.
        clicked: viser callback for a click on the model; None where it cannot be selected.
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
        self._scene = scene
        self.name = name
        self.description = description
        self._problem = problem
        self._clicked = clicked
        self._root = f"/models/{_node(name)}"
        self._canonical = next(
            i for i, link in enumerate(description.links) if link.name == description.canonical_link
        )
        self.size = _size_of(description)
        """m, of its largest extent: for things drawn in proportion."""
        self._frames = [self._frame(link) for link in description.links]
        self._shown = np.full((len(self._frames), 7), np.nan)
        self._layers: dict[str, list[tuple[Skin, float]]] = {}
        self._grounds: list[Skin] = []
        self._solids: list[Skin] = []
        self._clickable = True

    def path(self, link: str) -> str:
        """The scene node of a link's frame."""
        if link == self.description.canonical_link:
            return self._root
        return f"{self._root}/{_node(link)}"

    def move(self, positions: Array, quaternions: Array) -> bool:
        """Puts the links where they are; sends only what moved, and says whether anything did.

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

    def show(self, display: Display) -> None:
        """Makes visible what is wanted; a layer is sent when it is first wanted."""
        opacity = _SEE_THROUGH if display.transparent else 1.0
        self._show_layer("visual", display.visual, self._visuals, opacity, display.wireframe)
        self._show_layer("collision", display.collision, self._collisions, 1.0, display.wireframe)
        self._show_layer("inertia", display.inertia, self._inertias, 1.0, False)
        self._show_layer("names", display.names, self._names, 1.0, False)
        if not self.description.static:
            for frame in self._frames:
                if frame.show_axes != display.axes:
                    frame.show_axes = display.axes

    def set_clickable(self, clickable: bool) -> None:
        """Lets clicks through while a gizmo stands inside: the nearest surface would take them."""
        if self._clicked is None or clickable == self._clickable:
            return
        self._clickable = clickable
        for skin in self._solids:
            if clickable:
                skin.on_click(self._clicked)
            else:
                skin.remove_click_callback(self._clicked)

    def remove(self) -> None:
        """Takes everything out of the scene."""
        self._frames[self._canonical].remove()

    # -- layers

    def _show_layer(
        self,
        name: str,
        wanted: bool,
        make: Callable[[Link], list[tuple[Skin, float]]],
        opacity: float,
        wireframe: bool,
    ) -> None:
        if not wanted and name not in self._layers:
            return
        if name not in self._layers:
            self._layers[name] = [node for link in self.description.links for node in make(link)]
        for skin, own in self._layers[name]:
            skin.show(wanted)
            if name in ("names", "inertia"):
                continue
            value = own if skin in self._grounds else own * opacity
            skin.draw(None if value >= 1.0 else value, wireframe)

    def _visuals(self, link: Link) -> list[tuple[Skin, float]]:
        # A plane that is the ground receives shadows and takes no clicks: it is everywhere.
        ground = [v for v in link.visuals if isinstance(v.shape, Plane)]
        solid = [v for v in link.visuals if not isinstance(v.shape, Plane)]
        nodes = []
        for kind, visuals in (("ground", ground), ("visual", solid)):
            surfaces: list[Surface] = []
            for visual in visuals:
                try:
                    surfaces += surfaces_of_visual(visual)
                except CartwheelError as error:
                    self._problem(error)
            for i, surface in enumerate(merge(surfaces)):
                nodes.append(self._mesh(link, f"{kind}_{i}", surface, ground=kind == "ground"))
        return nodes

    def _collisions(self, link: Link) -> list[tuple[Skin, float]]:
        surfaces: list[Surface] = []
        for collision in link.collisions:
            if isinstance(collision.shape, Plane):
                continue  # without end: it would only colour the ground
            try:
                surfaces += surfaces_of_collision(collision, COLLISION)
            except CartwheelError as error:
                self._problem(error)
        return [self._mesh(link, "collision", surface) for surface in merge(surfaces)]

    def _inertias(self, link: Link) -> list[tuple[Skin, float]]:
        if link.inertial is None or self.description.static:
            return []
        pose, size = inertia_box(link.inertial)
        vertices, faces = triangles_of(Box(size=size))
        box = self._scene.add_mesh_simple(
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
        ball = self._scene.add_icosphere(
            f"{self.path(link.name)}/centre_of_mass",
            radius=max(0.004, 0.02 * self.size),
            color=(120, 40, 170),
            position=link.inertial.pose.position,
            cast_shadow=False,
        )
        return [(Skin(box), 1.0), (Skin(ball), 1.0)]

    def _names(self, link: Link) -> list[tuple[Skin, float]]:
        if self.description.static:
            return []
        label = self._scene.add_label(
            f"{self.path(link.name)}/name", link.name, font_screen_scale=0.75
        )
        return [(Skin(label), 1.0)]

    def _mesh(
        self, link: Link, name: str, surface: Surface, *, ground: bool = False
    ) -> tuple[Skin, float]:
        alpha = surface.rgba[3]
        node = f"{self.path(link.name)}/{name}"
        common: dict[str, Any] = {
            "cast_shadow": not ground and alpha >= 1.0,
            # On a large plane the browser's cascades of shadows differ in darkness; a fixed one
            # has no seams.
            "receive_shadow": 0.28 if ground else True,
            # Just below the height that it collides at, and below the grid that lies there.
            "position": (0.0, 0.0, -0.004 if ground else 0.0),
        }

        def plain(node: str) -> Any:
            return self._scene.add_mesh_simple(
                node,
                surface.vertices,
                surface.faces,
                color=_rgb(_lighten(surface.rgba) if ground else surface.rgba),
                opacity=None if alpha >= 1.0 else alpha,
                side="double" if alpha < 1.0 else "front",
                **common,
            )

        if surface.picture is None:
            skin = Skin(plain(node))
        else:
            pictured = self._scene.add_glb(node, glb_of(surface), **common)
            skin = PicturedSkin(pictured, lambda: plain(f"{node}_plain"))
        if ground:
            self._grounds.append(skin)
        elif self._clicked is not None:
            self._solids.append(skin)
            if self._clickable:
                skin.on_click(self._clicked)
        return skin, alpha

    def _frame(self, link: Link) -> Any:
        length = min(0.4, max(0.04, 0.18 * self.size))
        return self._scene.add_frame(
            self.path(link.name),
            show_axes=False,
            axes_length=length,
            axes_radius=length / 24,
            origin_radius=length / 12,
        )


def inertia_box(inertial: Inertial) -> tuple[Pose, tuple[float, float, float]]:
    """The uniform box of the same mass and inertia: its pose in the link, its edges in m."""
    moments, axes = np.linalg.eigh(tensor(inertial.diagonal, inertial.products))
    if np.linalg.det(axes) < 0:
        axes[:, 2] = -axes[:, 2]
    total = float(moments.sum())
    # I_x = m (b² + c²) / 12 and its kin, solved for a².
    edges = [
        math.sqrt(max(1e-8, 6 * (total - 2 * moment) / inertial.mass))
        for moment in moments.tolist()
    ]
    turned = quat_multiply(inertial.pose.orientation, quat_from_matrix(axes))
    return Pose(inertial.pose.position, turned), (edges[0], edges[1], edges[2])


def footprint(description: RobotDescription) -> tuple[float, float]:
    """How far it reaches from its frame's origin in the plane, and how far below it, m."""
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
    """The corners of a box around its collisions, in its frame, m; None where it has none."""
    corners: list[Surface] = []
    for link in description.links:
        for collision in link.collisions:
            if isinstance(collision.shape, Plane):
                continue
            try:
                found = surfaces_of_collision(collision, COLLISION)
            except CartwheelError:
                continue  # said already by the view that draws it
            corners += [Surface(place(link.pose, s.vertices), s.faces, s.rgba) for s in found]
    return bounds_of(corners)


def _within(positions: Array, quaternions: Array, root: int) -> tuple[Array, Array]:
    """All frames in that of row `root`, which itself stays in the world."""
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
    # q and -q are one rotation: one of the two, or a still link would seem to turn.
    turned[turned[:, 0] < 0] *= -1
    inside[root], turned[root] = positions[root], quaternions[root]
    return inside, turned


def _lighten(rgba: Rgba) -> Rgba:
    """Half way to white: the ground is the stage, and shadows and dark robots show on it."""
    red, green, blue, alpha = rgba
    return ((red + 1) / 2, (green + 1) / 2, (blue + 1) / 2, alpha)


def _rgb(rgba: Sequence[float]) -> tuple[int, int, int]:
    red, green, blue = (round(255 * max(0.0, min(1.0, c))) for c in rgba[:3])
    return red, green, blue


def _node(name: str) -> str:
    """A name as one level of viser's scene tree."""
    return name.replace("/", "|") or "_"
