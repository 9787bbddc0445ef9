"""Shared state of the readers of an SDF document: version, files, diagnostics."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Unpack

from cartwheel.codes import tags as codes
from cartwheel.codes.files import SDF_VERSION
from cartwheel.description.elements.numbers import LARGEST, position
from cartwheel.description.elements.simulator import simulator_of
from cartwheel.errors import Code, Details, Diagnostic
from cartwheel.geometry import Pose, Quat, quat_normalize
from cartwheel.similar_names import meant, suggestion

if TYPE_CHECKING:
    from cartwheel.description.elements.xml import Node
    from cartwheel.description.files.packages import Packages
    from cartwheel.description.model import Rgba, Simulator

Version = tuple[int, int]
OLDEST: Version = (1, 0)
NOT_CLASSIC: Version = (1, 8)
"""The oldest version that Gazebo Classic does not read."""
MODERN: Version = (1, 3)
"""Older versions are converted; see `oldest`."""
NEWEST: Version = (1, 12)
_NOTATIONS = ("euler_rpy", "quat_xyzw")
MAX_INCLUDES = 16
"""Maximum depth of includes: deeper ones are a model that includes itself indirectly."""


@dataclass(slots=True)
class Context:
    """Shared state of the readers; included documents share its diagnostics."""

    packages: Packages
    version: Version
    diagnostics: list[Diagnostic] = field(default_factory=list)
    including: tuple[Path, ...] = ()
    """The chain of included files, outermost first."""
    simulator: Simulator = ""
    """The version of Gazebo that the description is for."""

    def report(self, diagnostic: Diagnostic) -> None:
        """Adds a diagnostic."""
        self.diagnostics.append(diagnostic)

    def warn(self, code: Code, message: str, **details: Unpack[Details]) -> None:
        """Adds a new diagnostic; see `Code.diagnostic`."""
        self.report(code.diagnostic(message, **details))


def not_simulated(message: str, node: Node) -> Diagnostic:
    """The warning for a valid element that is not simulated."""
    return codes.NOT_SIMULATED.diagnostic(
        message,
        origin=node.origin,
        severity="warning",
        values={"tag": node.tag, **node.named},
    )


def simulator_for(root: Node, version: Version, around: Simulator = "") -> Simulator:
    """The version of Gazebo that an SDF document is for; empty if it may be for either of them.

    Args:
        root: Its root.
        version: The version of SDF.
        around: The same for the document that includes it.
    """
    named = around or simulator_of(root)
    if version < NOT_CLASSIC:
        return named
    return "" if named == "classic" else "gz"


def read_version(root: Node) -> Version:
    """The version of an ``<sdf>`` root.

    Raises:
        DescriptionError: The version is missing, malformed or too old.
    """
    text = root.get("version") or ""
    match = re.fullmatch(r"\s*(\d+)\.(\d+)\s*", text)
    if match and (int(match[1]), int(match[2])) < OLDEST:
        raise root.fail(
            f'the SDF version "{text}" is too old: 1.0 to 1.12 are supported',
            'Convert the file with "gz sdf -c" from Gazebo Classic.',
            code=SDF_VERSION,
            values={"stated": text},
        )
    if not match:
        raise root.fail(
            f'<sdf> has the invalid version "{text}"' if text else "<sdf> has no version",
            'Write version="1.6", for example.',
            code=SDF_VERSION,
            values={"stated": text},
        )
    return (int(match[1]), int(match[2]))


def read_pose(node: Node | None) -> Pose:
    """A ``<pose>``: ``x y z roll pitch yaw``, in degrees or as a quaternion if specified."""
    if node is None:
        return Pose()
    notation = (node.get("rotation_format") or "euler_rpy").strip()
    quaternion = notation == "quat_xyzw"
    in_degrees = node.boolean_of("degrees")
    if notation not in _NOTATIONS:
        raise node.fail(
            f'the rotation_format "{notation}" is unknown',
            suggestion(notation, _NOTATIONS),
            code=codes.TYPE_UNKNOWN,
            values={"name": notation, "meant": meant(notation, _NOTATIONS)},
        )
    if quaternion and in_degrees:
        raise node.fail(
            'a pose in quaternion format cannot have degrees="true"', 'Remove degrees="true".'
        )
    if not node.text.strip():
        return Pose()
    if quaternion:
        node.cut_words(7)
        x, y, z, *q = node.vector(7)
        try:
            orientation: Quat = quat_normalize(q)
        except ValueError as error:
            raise node.fail(f"pose: {error}") from None
        return Pose(position((x, y, z), "pose", node.origin), orientation)
    words = node.text.split()
    node.cut_words(len(words))
    if len(words) == 6:
        values = node.vector(6)
    else:
        # Gazebo Classic reads the values that are present.
        values = (*node.vector(len(words)), 0.0, 0.0, 0.0, 0.0, 0.0)[:6]
        rest = "the rest is ignored" if len(words) > 6 else "0 is used for the others"
        incomplete = codes.VALUE_IGNORED.diagnostic(
            f"a pose must have 6 numbers (got {len(words)}), so {rest}",
            origin=node.origin,
            values={"stated": node.text},
        )
        node.notes = (incomplete,)
    angles = values[3:]
    if in_degrees:
        angles = tuple(math.radians(angle) for angle in angles)
    return Pose.from_xyz_rpy(position(values[:3], "pose", node.origin), angles)


def reference_of(pose: Node | None) -> str:
    """The frame that a ``<pose>`` is relative to: ``relative_to`` since 1.7, ``frame`` before."""
    if pose is None:
        return ""
    return (pose.get("relative_to") or pose.get("frame") or "").strip()


def read_rgba(node: Node) -> Rgba:
    """A colour of three or four numbers, 0 to 1."""
    words = node.text.split()
    node.cut_words(4 if len(words) > 4 else len(words))
    if len(words) == 3:
        values = (*node.vector(3), 1.0)
    else:
        values = node.vector(4)
    r, g, b, a = (max(0.0, min(1.0, value)) for value in values)
    return (r, g, b, a)


def require_name(node: Node) -> str:
    """The name of an element, which must be neither empty nor reserved in SDF."""
    name = node.require("name").strip()
    if name.startswith("__") and name.endswith("__"):
        raise node.fail(
            f'the name "{name}" is reserved',
            "Remove the underscores from the start and end of the name.",
            code=codes.NAME_TAKEN,
            values={"name": name},
        )
    return name


def positive(node: Node, what: str) -> float:
    """The text as a positive number within the limits for lengths."""
    value = node.number()
    if value <= 0:
        raise node.fail(f"{what} must be above 0 (got {node.text})")
    if value > LARGEST:
        raise node.fail(f"{what} must be at most {LARGEST:g} (got {node.text})")
    return value
