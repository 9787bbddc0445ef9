"""Imports MuJoCo without requiring OpenGL.

MuJoCo's package loads the OpenGL library selected by MUJOCO_GL at import, and fails if it is
missing. Only cameras need OpenGL here; `Renderer` opens it for the first image.
"""

from __future__ import annotations

import contextlib
import importlib.util
import os
import sys
from collections.abc import Iterator
from pathlib import Path

_GLFW = "PYGLFW_LIBRARY"


def import_mujoco() -> None:
    """Imports MuJoCo, without its renderer if that cannot be loaded."""
    try:
        with _known_glfw(), _existing_folders():
            import mujoco
    except Exception:
        wanted = os.environ.get("MUJOCO_GL")
        if wanted is None:
            raise
        os.environ["MUJOCO_GL"] = "disable"
        try:
            import mujoco  # noqa: F401
        finally:
            os.environ["MUJOCO_GL"] = wanted


@contextlib.contextmanager
def _known_glfw() -> Iterator[None]:
    """Sets the path of the GLFW library, which would otherwise start a process per candidate."""
    found = importlib.util.find_spec("glfw")
    folder = Path(found.origin).parent if found is not None and found.origin else Path()
    library = folder / "x11" / "libglfw.so"
    chosen = {_GLFW, "PYGLFW_LIBRARY_VARIANT"} & set(os.environ)
    if chosen or os.environ.get("XDG_SESSION_TYPE") == "wayland" or not library.is_file():
        yield
        return
    os.environ[_GLFW] = str(library)
    try:
        yield
    finally:
        os.environ.pop(_GLFW, None)


@contextlib.contextmanager
def _existing_folders() -> Iterator[None]:
    """Hides the current folder from the import if it was deleted, because MuJoCo searches it."""
    try:
        Path.cwd()
    except OSError:
        folders = sys.path.copy()
        sys.path[:] = [folder for folder in folders if folder]
        try:
            yield
        finally:
            sys.path[:] = folders
    else:
        yield


import_mujoco()
