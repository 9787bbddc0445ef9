"""Names of topics, services, parameters and frames."""

from __future__ import annotations

import re

from cartwheel.codes.graph import GRAPH_NAME_INVALID
from cartwheel.errors import GraphError

_NAME = re.compile(r"/[A-Za-z_~][A-Za-z0-9_]*(/[A-Za-z_][A-Za-z0-9_]*)*\Z")


def resolve_name(name: str, namespace: str = "") -> str:
    """Global name of a topic or service. ``/…`` is unchanged; any other name joins the namespace.

    Raises:
        GraphError: The result is not a valid ROS name.
    """
    full = _full(name, namespace)
    if not _NAME.match(full):
        # The mistake may be in the namespace.
        shown = full if is_name(name) else name
        raise GraphError(
            f'"{shown}" is not a valid name',
            code=GRAPH_NAME_INVALID,
            hint="Names may contain letters, digits, _ and /, and no part may begin with a digit.",
            values={"name": shown},
        )
    return full


def is_name(name: str) -> bool:
    """Whether a name is valid for topics, services, parameters and nodes in ROS."""
    return bool(_NAME.match(_full(name)))


def _full(name: str, namespace: str = "") -> str:
    full = name if name.startswith("/") else f"/{namespace.strip('/')}/{name}"
    return "/" + "/".join(part for part in full.split("/") if part)


def absolute_name(name: str) -> str:
    """A name for a look-up: without a leading ``/``, it is in the root namespace, as in ROS."""
    return name if name.startswith("/") or not name else f"/{name}"


def resolve_frame(frame: str, prefix: str = "") -> str:
    """Frame name with a robot's tf_prefix. A leading ``/`` marks a global name and is removed.

    Source: tf, ``tf::resolve``.
    """
    if frame.startswith("/"):
        return frame.lstrip("/")
    prefix = prefix.strip("/")
    return f"{prefix}/{frame}" if prefix and frame else frame


def check_prefix(prefix: str) -> None:
    """Refuses a prefix of frames that contains spaces or control characters.

    Raises:
        GraphError: See above.
    """
    if not prefix.isprintable() or any(map(str.isspace, prefix)):
        raise GraphError(
            f'"{prefix}" is not a valid prefix of frames',
            code=GRAPH_NAME_INVALID,
            hint="Use letters, digits, _ and /, without spaces.",
            values={"name": prefix},
        )
