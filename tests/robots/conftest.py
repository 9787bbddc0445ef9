"""The cart's description, expanded once, without the rest of the product."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType
from xml.etree import ElementTree

import pytest
import xacro
from xacro import substitution_args

REPOSITORY = Path(__file__).resolve().parents[2]
PACKAGES = REPOSITORY / "robots"


@pytest.fixture(scope="session")
def repository() -> Path:
    return REPOSITORY


@pytest.fixture(scope="session")
def robot() -> ElementTree.Element:
    """The <robot> element that rosbots.xacro expands to."""
    with pytest.MonkeyPatch.context() as patch:
        # xacro asks ROS's index of installed packages for $(find); there is none here.
        patch.setattr(substitution_args, "_eval_find", lambda package: str(PACKAGES / package))
        document = xacro.process_file(str(PACKAGES / "rosbots_description/urdf/rosbots.xacro"))
    return ElementTree.fromstring(document.toxml())


@pytest.fixture(scope="session")
def make_meshes() -> ModuleType:
    """tools/make_meshes.py as a module."""
    spec = importlib.util.spec_from_file_location(
        "make_meshes", REPOSITORY / "tools/make_meshes.py"
    )
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.path.insert(0, str(REPOSITORY / "tools"))
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module
