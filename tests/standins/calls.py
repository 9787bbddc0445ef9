"""A call of a macro of a stand-in, with the frames and topics that it makes.

Positions are relative to ``base_link``. They are those of the original packages.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from cartwheel.geometry import Vec3

ORIGIN = '<origin xyz="0.1 0 0.2"/>'


@dataclass(frozen=True)
class Call:
    """A macro call below ``<robot>``."""

    file: str
    """As a user includes it: the package, and the path in it."""
    text: str
    frames: dict[str, Vec3]
    """Positions of links, in m."""
    topics: dict[str, str] = field(default_factory=dict)
    """Frame ID of the messages on each topic."""
    hung: str = ""
    """The link that the robot itself attaches to ``base_link`` at `ORIGIN`."""
    optical: tuple[str, ...] = ()
    """Links whose z axis is the x axis of ``base_link``, and whose x axis is its -y axis."""

    def __str__(self) -> str:
        """The test's name."""
        return self.text.split(">")[0].replace("<xacro:", "").replace('"', "")[:80]


def on_base(macro: str, attributes: str = "") -> str:
    """A macro that attaches itself to a parent with an origin."""
    return f'<xacro:{macro} parent="base_link" {attributes}>{ORIGIN}</xacro:{macro}>'
