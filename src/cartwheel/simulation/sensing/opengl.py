"""OpenGL without a window: one context, shared by threads and safe after a fork.

OpenGL rejects a context that is current on a different thread. The context is therefore made
current for each image, which takes 8 µs. The threads of an OpenGL driver do not survive a fork,
and a call to the driver in the forked process would block forever. A forked process therefore
never uses the context.
"""

from __future__ import annotations

import atexit
import contextlib
import ctypes
import importlib
import os
import sys
import threading
import weakref
from collections.abc import Iterator
from typing import Any, ClassVar

from cartwheel.codes import world as world_codes
from cartwheel.errors import SimulationError

_PACKAGES = ("libegl1", "libgl1", "libgl1-mesa-dri")
_PATIENCE = 1.0
"""Wall time to wait for an image of another thread at the end of the program, s."""
_BACKENDS = {"egl": "mujoco.egl", "osmesa": "mujoco.osmesa"}


class NoOpenGLError(SimulationError):
    """OpenGL is not available on this machine."""

    code = world_codes.OPENGL_MISSING


class ForkedError(SimulationError):
    """OpenGL was used before this process was forked."""

    code = world_codes.OPENGL_FORKED

    def __init__(self) -> None:
        super().__init__(
            "cameras do not work in this process because it was forked after its parent had "
            "opened OpenGL",
            hint='Start processes with multiprocessing.get_context("spawn"), or fork before the '
            "first image.",
        )


class _Process:
    """The OpenGL state of this process."""

    opened: ClassVar[bool] = False
    forked: ClassVar[bool] = False
    """Whether the parent process had opened OpenGL. The driver's threads do not survive a fork, and
    the next call would wait for them forever.
    """
    contexts: ClassVar[weakref.WeakSet[OffscreenContext]] = weakref.WeakSet()


class OffscreenContext:
    """An OpenGL context: EGL, otherwise OSMesa. MUJOCO_GL selects one of them.

    Args:
        width: Width of the first image, pixels.
        height: Height of the first image, pixels.

    Raises:
        NoOpenGLError: Neither library can be opened.
        ForkedError: This process was forked from a process that had opened OpenGL.
    """

    def __init__(self, width: int, height: int) -> None:
        if _Process.forked:
            raise ForkedError
        self._lock = threading.RLock()
        self._gl: Any = _open(width, height)
        if not _Process.opened:
            # Exit handlers run in reverse order, so this one precedes MuJoCo's, which closes EGL.
            atexit.register(_end)
        _Process.opened = True
        _Process.contexts.add(self)

    @contextlib.contextmanager
    def current(self) -> Iterator[None]:
        """Makes the context current on this thread within a ``with`` block.

        A context that stays current on one thread cannot be used on another thread.

        Raises:
            ForkedError: This process was forked after the context was created.
        """
        if _Process.forked:
            raise ForkedError
        with self._lock:
            gl = self._gl
            gl.make_current()
            try:
                yield
            finally:
                _make_none_current(gl)

    def release(self, drawing: Any) -> None:
        """Frees an `MjrContext` that belongs to this context."""
        if self._gl is None:
            _keep_for_ever(drawing)
            return
        with self.current():
            drawing.free()

    def free(self) -> None:
        """Frees the context. Thread-safe."""
        if self._gl is not None:
            self._gl.free()
            self._gl = None

    def end(self) -> None:
        """Frees the context at the end of the program. Other threads that need it wait forever."""
        if self._gl is None:
            return
        if self._lock.acquire(timeout=_PATIENCE):
            self.free()
        else:
            self.abandon()

    def abandon(self) -> None:
        """Ensures that this process never uses the context again, also to free it."""
        if self._gl is not None:
            _keep_for_ever(self._gl)
            self._gl = None


def _open(width: int, height: int) -> Any:
    wanted = os.environ.get("MUJOCO_GL", "").lower()
    names = [wanted] if wanted in _BACKENDS else list(_BACKENDS)
    reasons = []
    for name in names:
        try:
            module = importlib.import_module(_BACKENDS[name])
            context = module.GLContext(width, height)
            context.make_current()
            _make_none_current(context)
        except Exception as error:  # noqa: BLE001 - a missing library shows in many ways
            reasons.append(f"{name}: {str(error).splitlines()[0] if str(error) else error!r}")
        else:
            return context
    raise NoOpenGLError(
        f"cameras require OpenGL, which is not available on this computer ({'; '.join(reasons)})",
        hint=f"On Debian or Ubuntu: sudo apt-get install {' '.join(_PACKAGES)}. Only camera images "
        "require OpenGL.",
        values={"packages": _PACKAGES, "reasons": tuple(reasons)},
    )


def _make_none_current(context: Any) -> None:
    egl = sys.modules.get("mujoco.egl")
    # OSMesa contexts can be used from any thread.
    if egl is not None and isinstance(context, egl.GLContext):
        none = egl.EGL.EGL_NO_SURFACE
        egl.EGL.eglMakeCurrent(egl.EGL_DISPLAY, none, none, egl.EGL.EGL_NO_CONTEXT)


def _keep_for_ever(item: Any) -> None:
    """Keeps an object alive whose destructor would call OpenGL."""
    ctypes.pythonapi.Py_IncRef(ctypes.py_object(item))


def _end() -> None:
    for context in list(_Process.contexts):
        context.end()


def _after_fork() -> None:
    egl = sys.modules.get("mujoco.egl")
    display = getattr(egl, "EGL_DISPLAY", None)
    if not _Process.opened and display is None:
        return
    _Process.forked = True
    for context in _Process.contexts:
        context.abandon()
    if egl is not None:
        # MuJoCo's exit handler would also wait for the threads.
        atexit.unregister(egl.EGL.eglTerminate)


os.register_at_fork(after_in_child=_after_fork)
