"""Camera images from MuJoCo's renderer, without a display or a GPU.

Without a GPU, shadows and multisampling cause most of the cost, so images have neither. The
colours and depths of an RGB-D camera come from one rendering.
"""

from __future__ import annotations

import contextlib
import math
import weakref
from collections.abc import Collection, Iterator
from typing import Any

import mujoco
import numpy as np

from cartwheel.description.model import CameraIntrinsics
from cartwheel.geometry import Pose, Vec3
from cartwheel.simulation.handles import CameraHandle
from cartwheel.simulation.sensing.opengl import OffscreenContext
from cartwheel.simulation.sensing.views import (
    Depth,
    Image,
    Labelled,
    View,
    axes_of,
    axes_towards,
    metres,
    out_of_view,
)
from cartwheel.simulation.sensing.visual_model import VisualModel
from cartwheel.world.visuals import HIDDEN_GROUP, VISUAL_GROUP

_WALL = 0.99
"""Distance of the background wall, as a fraction of the far distance."""
_FULL = 255
_PIXEL = np.dtype((np.void, 3))
"""Three bytes as one value: numpy applies masks to such values many times faster."""


class Renderer:
    """Renders camera images. OpenGL is opened at the first image.

    Any thread may render, one at a time: the context is current only while an image is rendered.

    Args:
        visuals: The model to render.
    """

    def __init__(self, visuals: VisualModel) -> None:
        self._visuals = visuals
        self._model: Any = None
        self._background: Any = np.zeros(3, dtype=np.uint8)
        self._opaque: Any = None
        self._painting = -1
        """`VisualModel.paintings` at which the mask of opaque geoms was made."""
        self._gl: OffscreenContext | None = None
        self._context: Any = None
        self._scene: Any = None
        self._size = (0, 0)
        self._option = mujoco.MjvOption()
        self._option.geomgroup[:] = 0
        self._option.geomgroup[VISUAL_GROUP] = 1
        self._camera = mujoco.MjvCamera()
        self._perturb = mujoco.MjvPerturb()

    def _bound(self) -> Any:
        """The current data of the model, after its scene is dropped if the model is a new one."""
        model, data = self._visuals.current()
        if model is not self._model:
            self._drop_scene()
            self._model = model
            self._background = _background(model)
            self._painting = -1
        if self._painting != self._visuals.paintings:
            self._painting = self._visuals.paintings
            self._opaque = _opaque(model)
        return data

    def close(self) -> None:
        """Frees all resources."""
        self._drop_scene()
        self._model = None
        if self._gl is not None:
            self._gl.free()
            self._gl = None

    def render(self, camera: CameraHandle) -> Image:
        """An image from a camera in the model, shape (height, width, 3), RGB.

        Raises:
            WorldError: A visual cannot be built.
            NoOpenGLError: OpenGL is missing; the hint says what to install.
            ForkedError: This process was forked from a process that had opened OpenGL.
        """
        data = self._bound()
        pixels, _ = self._draw(data, _seen_by(camera, data))
        return np.ascontiguousarray(pixels[::-1])

    def render_from(self, eye: Vec3, target: Vec3, lens: CameraIntrinsics) -> Image:
        """An image from a point that looks at another point; both in the world, m.

        The image's vertical axis is the world's z axis; straight up or down, it is the y axis.

        Args:
            eye: Position of the camera; must differ from `target`.
            target: The centre of the image.
            lens: Size, field of view and clip distances.

        Returns:
            Shape (height, width, 3), RGB.

        Raises:
            WorldError: A visual cannot be built.
            NoOpenGLError: OpenGL is missing; the hint says what to install.
            ForkedError: This process was forked from a process that had opened OpenGL.
        """
        data = self._bound()
        view = View(lens, np.array(eye), axes_towards(np.subtract(target, eye)), -1)
        pixels, _ = self._draw(data, view)
        return np.ascontiguousarray(pixels[::-1])

    def render_with_depth(self, camera: CameraHandle) -> tuple[Image, Depth]:
        """The image, and the depth of each pixel: m, shape (height, width).

        Depths are along the camera's axis, not along the pixel's ray; inf where nothing is visible.

        Raises:
            WorldError: A visual cannot be built.
            NoOpenGLError: OpenGL is missing; the hint says what to install.
            ForkedError: This process was forked from a process that had opened OpenGL.
        """
        data = self._bound()
        pixels, buffer = self._draw(data, _seen_by(camera, data))
        return np.ascontiguousarray(pixels[::-1]), metres(buffer, camera.intrinsics)

    def render_labelled(self, pose: Pose, lens: CameraIntrinsics) -> Labelled:
        """An image, its depths, and the body at each pixel.

        Args:
            pose: The camera in the world. It looks along its x axis, with z up.
            lens: Size, field of view and clip distances.

        Raises:
            WorldError: A visual cannot be built.
            NoOpenGLError: OpenGL is missing; the hint says what to install.
            ForkedError: This process was forked from a process that had opened OpenGL.
        """
        data = self._bound()
        view = View(lens, np.array(pose.position), axes_of(pose), -1)
        with self._opened(lens.width, lens.height):
            pixels, buffer = self._draw_in_context(data, view)
            bodies = self._bodies(data, view)
        names = tuple(self._model.body(index).name for index in range(self._model.nbody))
        image = np.ascontiguousarray(pixels[::-1])
        return Labelled(image, metres(buffer, lens), bodies, names)

    def render_alone(self, pose: Pose, lens: CameraIntrinsics, bodies: Collection[int]) -> Any:
        """The pixels of bodies without all others: a mask, shape (height, width).

        Args:
            pose: As for `render_labelled`.
            lens: As for `render_labelled`.
            bodies: Body IDs, as in `Labelled.bodies`.
        """
        data = self._bound()
        view = View(lens, np.array(pose.position), axes_of(pose), -1)
        with self._opened(lens.width, lens.height):
            self._prepare(lens.width, lens.height)
            self._aim(view)
            others = ~np.isin(self._model.geom_bodyid, list(bodies))
            return self._bodies(data, view, hidden=others) >= 0

    def _bodies(self, data: Any, view: View, hidden: Any = None) -> Any:
        """The body at each pixel; see `Labelled.bodies`."""
        codes = np.empty((view.lens.height, view.lens.width, 3), dtype=np.uint8)
        flags, kinds = self._scene.flags, mujoco.mjtRndFlag
        self._show(data, view, hidden)
        flags[kinds.mjRND_SEGMENT] = flags[kinds.mjRND_IDCOLOR] = 1
        try:
            self._shoot(codes, None)
        finally:
            flags[kinds.mjRND_SEGMENT] = flags[kinds.mjRND_IDCOLOR] = 0
        # The colour of a geom in the scene is the number after its own; black is the background.
        owners = np.full(self._scene.ngeom + 1, -1, dtype=np.int32)
        for geom in self._scene.geoms[: self._scene.ngeom]:
            if geom.objtype == mujoco.mjtObj.mjOBJ_GEOM and geom.segid >= 0:
                owners[geom.segid + 1] = self._model.geom_bodyid[geom.objid]
        return owners[codes[::-1].astype(np.int32) @ np.array([1, 1 << 8, 1 << 16])]

    def _draw(self, data: Any, view: View) -> tuple[Image, Depth]:
        """Pixels and the depth buffer, both with the lowest row first."""
        with self._opened(view.lens.width, view.lens.height):
            return self._draw_in_context(data, view)

    def _draw_in_context(self, data: Any, view: View) -> tuple[Image, Depth]:
        lens = view.lens
        self._prepare(lens.width, lens.height)
        self._aim(view)
        pixels = np.empty((lens.height, lens.width, 3), dtype=np.uint8)
        buffer = np.empty((lens.height, lens.width), dtype=np.float32)
        self._show(data, view)
        self._shoot(pixels, buffer)
        # The background, where nothing was drawn.
        empty = buffer == 0
        if self._opaque is None:
            pixels.reshape(-1).view(_PIXEL)[empty.ravel()] = self._background.view(_PIXEL)[0]
        else:
            share = self._transmitted(data, view)[empty].astype(np.uint16)
            seen = pixels[empty] + share * self._background // _FULL
            pixels[empty] = np.minimum(seen, _FULL)
        return pixels, buffer

    def _aim(self, view: View) -> None:
        kinds = mujoco.mjtCamera
        self._camera.type = kinds.mjCAMERA_FREE if view.fixed < 0 else kinds.mjCAMERA_FIXED
        self._camera.fixedcamid = view.fixed

    def _show(self, data: Any, view: View, hidden: Any = None) -> None:
        """Adds the visible geoms in front of the camera to the scene.

        The engine also draws geoms behind the camera, so they are omitted here.

        Args:
            data: Data of the bound model.
            view: The camera.
            hidden: Mask of geoms to omit, shape (ngeom,).
        """
        lens, groups = view.lens, self._model.geom_group
        saved = groups.copy()
        try:
            groups[out_of_view(self._model, data, view)] = HIDDEN_GROUP
            if hidden is not None:
                groups[hidden] = HIDDEN_GROUP
            mujoco.mjv_updateScene(
                self._model,
                data,
                self._option,
                self._perturb,
                self._camera,
                mujoco.mjtCatBit.mjCAT_ALL.value,
                self._scene,
            )
        finally:
            groups[:] = saved
        # Cameras have individual clip planes, but MuJoCo has one pair for all. The other frustum
        # values apply at the near plane.
        half = lens.near * math.tan(lens.horizontal_fov / 2) * lens.height / lens.width
        for camera in self._scene.camera:
            camera.frustum_near, camera.frustum_far = lens.near, lens.far
            camera.frustum_bottom, camera.frustum_top = -half, half
            camera.frustum_center = 0.0
            if view.fixed < 0:
                camera.pos[:] = view.position
                camera.up[:], camera.forward[:] = view.axes[:, 1], -view.axes[:, 2]
        if view.fixed < 0:
            for light in self._scene.lights[: self._scene.nlight]:
                if light.headlight:
                    light.pos[:], light.dir[:] = view.position, -view.axes[:, 2]

    def _shoot(self, pixels: Image, buffer: Depth | None) -> None:
        """Draws the scene and reads the image, and the depth buffer if one is given."""
        viewport = mujoco.MjrRect(0, 0, pixels.shape[1], pixels.shape[0])
        mujoco.mjr_render(viewport, self._scene, self._context)
        mujoco.mjr_readPixels(pixels, buffer, viewport, self._context)

    def _transmitted(self, data: Any, view: View) -> Image:
        """The fraction of the background visible through transparent geoms, from 0 to 255.

        Transparent geoms leave no depth, and the engine draws them in front of black. Here they are
        drawn alone in black, in front of a white wall.
        """
        self._show(data, view, hidden=self._opaque)
        scene, lens = self._scene, view.lens
        for index in range(scene.ngeom):
            scene.geoms[index].rgba[:3] = 0.0
            scene.geoms[index].emission = 0.0
        away = _WALL * lens.far
        wide = lens.far * math.tan(lens.horizontal_fov / 2)
        wall = scene.geoms[scene.ngeom]
        mujoco.mjv_initGeom(
            wall,
            mujoco.mjtGeom.mjGEOM_BOX,
            np.array([wide, wide * lens.height / lens.width, (1 - _WALL) / 2 * away]),
            view.position - away * view.axes[:, 2],
            view.axes.ravel(),
            np.ones(4, dtype=np.float32),
        )
        wall.emission = 1.0
        scene.ngeom += 1
        shares = np.empty((lens.height, lens.width, 3), dtype=np.uint8)
        self._shoot(shares, None)
        return shares

    @contextlib.contextmanager
    def _opened(self, width: int, height: int) -> Iterator[None]:
        """Opens the context if needed and makes it current on this thread."""
        if self._gl is None:
            self._gl = OffscreenContext(width, height)
            # A script may exit without closing its world. Free the context before Python unloads
            # OpenGL's modules.
            weakref.finalize(self, self._gl.free)
        with self._gl.current():
            yield

    def _prepare(self, width: int, height: int) -> None:
        if self._scene is None:
            self._scene = mujoco.MjvScene(self._model, maxgeom=self._model.ngeom + 100)
            flags = self._scene.flags
            # The engine draws its sky as a dome at 0.7 of the far distance, which hides farther
            # geoms.
            for flag in ("SHADOW", "REFLECTION", "FOG", "HAZE", "SKYBOX"):
                flags[getattr(mujoco.mjtRndFlag, f"mjRND_{flag}")] = 0
            self._context = mujoco.MjrContext(self._model, mujoco.mjtFontScale.mjFONTSCALE_50)
            # Zero is the far end, where floating-point values have the highest resolution.
            self._context.readDepthMap = mujoco.mjtDepthMap.mjDEPTH_ZEROFAR.value
            self._size = (self._context.offWidth, self._context.offHeight)
            mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._context)
        if width > self._size[0] or height > self._size[1]:
            self._size = (max(width, self._size[0]), max(height, self._size[1]))
            mujoco.mjr_resizeOffscreen(*self._size, self._context)

    def _drop_scene(self) -> None:
        if self._context is not None and self._gl is not None:
            self._gl.release(self._context)
        self._context = self._scene = None


def _background(model: Any) -> Any:
    """The colour of the model's sky, shape (3,)."""
    for index in range(model.ntex):
        if model.tex_type[index] == mujoco.mjtTexture.mjTEXTURE_SKYBOX:
            start = model.tex_adr[index]
            return np.ascontiguousarray(model.tex_data[start : start + 3])
    return np.zeros(3, dtype=np.uint8)


def _seen_by(camera: CameraHandle, data: Any) -> View:
    """The view of a camera in the model."""
    axes = data.cam_xmat[camera.id].reshape(3, 3)
    return View(camera.intrinsics, data.cam_xpos[camera.id], axes, camera.id)


def _opaque(model: Any) -> Any:
    """Mask of opaque visuals, shape (ngeom,); None if all are opaque."""
    transparent = (model.geom_group == VISUAL_GROUP) & (model.geom_rgba[:, 3] < 1)
    return ~transparent if transparent.any() else None
