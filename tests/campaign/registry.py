"""All targets. Each module offers ``TARGETS``; a new one is named here."""

from __future__ import annotations

import importlib

from tests.campaign.target import Target

MODULES: dict[str, tuple[str, ...]] = {
    "fuzz_descriptions": ("urdf", "sdf", "world", "xacro"),
    "fuzz_cdr": ("cdr",),
    "fuzz_rtps": ("rtps",),
    "fuzz_zenoh": ("zenoh",),
    "fuzz_meshes": ("stl", "obj", "dae", "glb", "ply"),
    "fuzz_pictures": ("pictures",),
    "fuzz_recordings": ("bag", "mcap", "db3", "db3-tables", "bag2-folder", "definitions"),
    "fuzz_messages": ("msg-files", "srv-files", "action-files"),
    "fuzz_yaml": ("controllers", "gz-bridge"),
    "fuzz_launches": ("python-launch", "xml-launch"),
    "fuzz_live": ("live",),
    "fuzz_processes": ("kills", "worlds-in-use"),
    "fuzz_autopilots": ("ardupilot", "px4"),
    "fuzz_ros1": ("xmlrpc", "http", "tcpros_header", "tcpros", "ros1_message"),
}
"""Modules, and the targets of each: known without an import, which takes seconds."""


def names() -> list[str]:
    """Of all targets."""
    return [name for targets in MODULES.values() for name in targets]


def load(name: str) -> Target:
    """The target of a name.

    Raises:
        KeyError: There is none.
    """
    for module, targets in MODULES.items():
        if name in targets:
            return _find(module, name)
    if name.startswith("planted-"):
        return _find("planted", name)
    raise KeyError(name)


def _find(module: str, name: str) -> Target:
    offered = importlib.import_module(f"tests.campaign.{module}").TARGETS
    return next(target for target in offered if target.name == name)
