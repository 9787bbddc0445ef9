"""All diagnostic codes and their explanations.

Each hundred has a module with codes as constants. ``texts/`` contains an explanation of each code,
used by `cartwheel explain` and the documentation.
"""

from __future__ import annotations

import importlib
import re
from functools import cache
from types import ModuleType

from cartwheel.errors import Code, UnknownNameError

MODULES = {
    "command": "Command line",
    "files": "Files, XML, xacro and YAML",
    "robot": "Links, joints, masses and wheels",
    "tags": "Tags, attributes and materials",
    "devices": "Sensors, plugins and controllers, as described",
    "running": "Sensors, plugins and controllers, as they run",
    "world": "World and physics",
    "graph": "Topics, services and messages",
    "wires": "ROS 1, ROS 2, Foxglove and network access",
    "recording": "Recording, playback and the web interface",
}
"""The modules with codes and their titles, in numerical order."""
FORMER = {
    "name-twice": "duplicate-name",
    "two-parents": "multiple-parents",
    "links-in-a-ring": "kinematic-loop",
    "several-roots": "multiple-roots",
    "limit-degrees": "limit-in-degrees",
    "axis-not-unit": "axis-not-normalized",
    "inertia-unlike-geometry": "inertia-geometry-mismatch",
    "mass-outside": "center-of-mass-outside",
    "mass-grams": "mass-in-grams",
    "mass-absurd": "mass-implausible",
    "drive-joint-fixed": "drive-joint-not-continuous",
    "wheel-axes": "wheel-axis-misaligned",
    "wheel-separation": "wheel-separation-mismatch",
    "wheel-base": "wheel-base-mismatch",
    "wheel-diameter": "wheel-diameter-mismatch",
    "wheel-no-collision": "wheel-without-collision",
    "base-no-collision": "base-without-collision",
    "collisions-overlap": "overlapping-collisions",
    "shape-size": "shape-out-of-scale",
    "angle-degrees": "angle-in-degrees",
    "place-millimetres": "position-in-millimetres",
    "sensor-range": "sensor-range-invalid",
    "image-format": "image-format-unknown",
    "topic-twice": "duplicate-topic",
    "plugin-obsolete": "plugin-parameter-obsolete",
    "controllers-file": "controllers-file-unreadable",
    "controller-interface": "controller-interface-mismatch",
    "controller-gains": "controller-gains-missing",
    "plugin-parameter": "plugin-parameter-unknown",
    "property-twice": "property-overwritten",
    "unreadable": "value-invalid",
}
"""Former names of codes, which settings and options still accept."""
_PREFIX = re.compile(r"CW\d{0,2}", re.IGNORECASE)
_HEADING = re.compile(r"^## (CW\d{3}) (\S+)\n", re.MULTILINE)


def codes_of(module: str) -> tuple[Code, ...]:
    """The codes of a module in `MODULES`, by number."""
    loaded: ModuleType = importlib.import_module(f"cartwheel.codes.{module}")
    return tuple(
        sorted(
            (each for each in vars(loaded).values() if isinstance(each, Code)),
            key=lambda each: each.number,
        )
    )


@cache
def all_codes() -> tuple[Code, ...]:
    """All codes, by number."""
    return tuple(code for module in MODULES for code in codes_of(module))


def code_named(text: str) -> Code:
    """The code with this number, name or former name, in upper or lower case.

    Raises:
        UnknownNameError: The code does not exist.
    """
    wanted = text.strip().lower()
    wanted = FORMER.get(wanted, wanted)
    for code in all_codes():
        if wanted in (code.number.lower(), code.name, str(code).lower()):
            return code
    from cartwheel.codes import command

    names = [name for code in all_codes() for name in (code.number, code.name)]
    raise UnknownNameError("the code", text, names, code=command.UNKNOWN_CODE)


def explanation(code: Code) -> str:
    """The explanation of a code: meaning, reason and example, as Markdown without the heading."""
    return _explanations()[code.number]


@cache
def _explanations() -> dict[str, str]:
    from importlib import resources  # Imported only for explanations, because the import is slow.

    found: dict[str, str] = {}
    for module in MODULES:
        text = (resources.files(__name__) / "texts" / f"{module}.md").read_text(encoding="utf-8")
        parts = _HEADING.split(text)
        for number, body in zip(parts[1::3], parts[3::3], strict=True):
            found[number] = body.strip()
    return found


def codes_matching(text: str) -> frozenset[Code]:
    """The code with a number or name, or all codes with a prefix such as ``CW2``.

    Raises:
        UnknownNameError: No code matches.
    """
    word = text.strip()
    if _PREFIX.fullmatch(word):
        matching = frozenset(code for code in all_codes() if code.number.startswith(word.upper()))
        if matching:
            return matching
    return frozenset({code_named(word)})
