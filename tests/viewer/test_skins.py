"""Surfaces with images: what the browser is sent, and what it shows in place of them."""

import io
from types import SimpleNamespace

import numpy as np
import pytest
import trimesh
from PIL import Image

from cartwheel.description.model import Box, Link, Material, RobotDescription, Visual
from cartwheel.errors import Origin
from cartwheel.geometry import Pose
from cartwheel.viewer.model_view import ModelView
from cartwheel.viewer.shapes import DEFAULT, merge, surfaces_of_visual
from cartwheel.viewer.skins import glb_of

ORIGIN = Origin(file="<test>")
LEFT, RIGHT = (200, 40, 20), (20, 60, 180)


@pytest.fixture
def image(tmp_path):
    """Its left half is red, its right half blue."""
    path = tmp_path / "halves.png"
    pixels = np.empty((64, 64, 3), dtype=np.uint8)
    pixels[:, :32], pixels[:, 32:] = LEFT, RIGHT
    Image.fromarray(pixels).save(path)
    return path


def box(image, *, at=(0.0, 0.0, 0.0), diffuse=None, scale=(1.0, 1.0)):
    return Visual(
        name="v",
        shape=Box(size=(1.0, 1.0, 1.0)),
        pose=Pose(at),
        material=Material(texture=image, diffuse=diffuse, texture_scale=scale),
        origin=ORIGIN,
    )


def test_a_surface_has_its_image_and_the_mean_of_it(image):
    (surface,) = surfaces_of_visual(box(image))
    assert surface.picture.image == image
    mean = (np.array(LEFT) + RIGHT) / 2 / 255
    assert surface.rgba == pytest.approx((*mean, 1.0), abs=0.01)
    assert len(surface.picture.uv) == len(surface.vertices)


def test_a_colour_tints_it(image):
    (surface,) = surfaces_of_visual(box(image, diffuse=(0.5, 1.0, 0.0, 1.0)))
    assert surface.picture.tint == (0.5, 1.0, 0.0, 1.0)
    red, green, _ = (np.array(LEFT) + RIGHT) / 2 / 255
    assert surface.rgba == pytest.approx((red / 2, green, 0.0, 1.0), abs=0.01)


def test_an_image_that_cannot_be_read_leaves_the_colour(tmp_path):
    path = tmp_path / "broken.png"
    path.write_bytes(b"no image")
    (surface,) = surfaces_of_visual(box(path, diffuse=(0.2, 0.4, 0.6, 1.0)))
    assert (surface.picture, surface.rgba) == (None, (0.2, 0.4, 0.6, 1.0))
    (surface,) = surfaces_of_visual(
        Visual(name="v", shape=Box(size=(1, 1, 1)), material=Material(), origin=ORIGIN)
    )
    assert surface.rgba == DEFAULT


def test_surfaces_of_one_image_are_one(image, tmp_path):
    other = tmp_path / "other.png"
    other.write_bytes(image.read_bytes())
    visuals = [box(image), box(image, at=(3, 0, 0)), box(other, at=(6, 0, 0))]
    merged = merge([s for visual in visuals for s in surfaces_of_visual(visual)])
    assert [(s.picture.image, len(s.picture.uv), len(s.vertices)) for s in merged] == [
        (image, 48, 48),
        (other, 24, 24),
    ]


def colour_at(mesh, point):
    """What the image shows at the vertex nearest to a point, of those turned to +x."""
    ahead = mesh.vertices[:, 0] > 0.49
    distance = np.linalg.norm(mesh.vertices - point, axis=1) + 1e6 * ~ahead
    nearest = np.flatnonzero(
        np.isclose(distance, distance.min()) & (mesh.vertex_normals[:, 0] > 0.9)
    )[0]
    u, v = mesh.visual.uv[nearest]
    pixels = np.asarray(mesh.visual.material.baseColorTexture.convert("RGB"))
    row = round((1 - np.clip(v, 0.05, 0.95)) * 63)
    return pixels[row, round(np.clip(u, 0.05, 0.95) * 63)]


def test_the_browser_gets_the_image_where_gazebo_lays_it(image):
    (surface,) = surfaces_of_visual(box(image))
    mesh = trimesh.load(io.BytesIO(glb_of(surface)), file_type="glb", force="mesh", process=False)
    np.testing.assert_allclose(mesh.bounds, [[-0.5] * 3, [0.5] * 3], atol=1e-6)
    assert mesh.volume == pytest.approx(1.0, rel=1e-6)
    # Who looks along -x at the side ahead has y to the right, and the image upright.
    np.testing.assert_allclose(colour_at(mesh, (0.5, -0.5, 0.0)), LEFT, atol=6)
    np.testing.assert_allclose(colour_at(mesh, (0.5, 0.5, 0.0)), RIGHT, atol=6)


def test_large_images_are_sent_smaller(tmp_path):
    path = tmp_path / "large.png"
    Image.new("RGBA", (3000, 1500), (10, 200, 30, 255)).save(path)
    (surface,) = surfaces_of_visual(box(path))
    mesh = trimesh.load(io.BytesIO(glb_of(surface)), file_type="glb", force="mesh")
    assert mesh.visual.material.baseColorTexture.size == (1024, 512)


class Scene:
    """Stands for a browser's own scene."""

    def __init__(self):
        self.added = {}

    def add_frame(self, name, **_):
        return SimpleNamespace(name=name)

    def add_glb(self, name, _, **options):
        return self._add("glb", name, options)

    def add_mesh_simple(self, name, *_, **options):
        return self._add("mesh", name, options)

    def _add(self, kind, name, options):
        self.added[name] = kind, options
        return SimpleNamespace(name=name, on_click=lambda _: None)


def test_see_through_and_as_wires_it_is_plain(image):
    link = Link(name="link", visuals=(box(image),), origin=ORIGIN)
    model = RobotDescription(name="m", links=(link,), canonical_link="link", origin=ORIGIN)
    view = ModelView(Scene(), "m", model)
    for options, kind, opacity in (
        ({}, "glb", None),
        ({"opacity": 0.35}, "mesh", 0.35),
        ({"wireframe": True}, "mesh", None),
    ):
        scene = Scene()
        view.add_visuals(scene, **options)
        ((found, given),) = scene.added.values()
        assert (found, given.get("opacity")) == (kind, opacity)
        assert given.get("wireframe", False) == options.get("wireframe", False)
