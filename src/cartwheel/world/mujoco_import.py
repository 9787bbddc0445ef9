"""The first import of MuJoCo, which must not need OpenGL.

MuJoCo's package loads the OpenGL that MUJOCO_GL names while it is imported, and fails where that
is missing. Only cameras need it here, and `Renderer` opens it when one is read.
"""

from __future__ import annotations

import os


def import_mujoco() -> None:
    """Imports MuJoCo; without its own renderer where that cannot be loaded."""
    try:
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


import_mujoco()
