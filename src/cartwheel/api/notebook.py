"""Displays of messages in IPython and Jupyter, after ``%load_ext cartwheel``."""

from __future__ import annotations

from typing import Any

from cartwheel.api.pictures import Picture
from cartwheel.messages import message_class

_IMAGES = ("sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage")


def extend(shell: Any) -> None:
    """Lets a shell display image messages as images.

    Args:
        shell: The ``IPython.core.interactiveshell.InteractiveShell``.
    """
    images = shell.display_formatter.formatters["image/png"]
    texts = shell.display_formatter.formatters["text/plain"]
    for name in _IMAGES:
        kind = message_class(name)
        images.for_type(kind, _png)
        texts.for_type(kind, _text)


def _png(message: Any) -> bytes:
    return Picture.of(message)._repr_png_()


def _text(message: Any, printer: Any, cycle: bool) -> None:  # noqa: ARG001
    """The message without its pixels."""
    names = [name for name in message.__dataclass_fields__ if name not in ("data", "__msgtype__")]
    fields = ", ".join(f"{name}={getattr(message, name)!r}" for name in names)
    printer.text(f"{type(message).__name__}({fields}, data=<{len(message.data)} bytes>)")
