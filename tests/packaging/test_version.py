"""The version is written in `cartwheel.__version__`; every other place agrees with it."""

import re
import tomllib
from pathlib import Path
from xml.etree import ElementTree

import pytest
import yaml
from hatchling.metadata.core import ProjectMetadata
from hatchling.plugin.manager import PluginManager

import cartwheel

ROOT = Path(__file__).parents[2]
PACKAGES = sorted(
    path for path in (ROOT / "ros1" / "src").glob("*/package.xml") if not path.parent.is_symlink()
)
"""A link leads to the cart, which has a version of its own."""


def test_the_package_takes_its_version_from_the_module():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert "version" not in project
    assert ProjectMetadata(str(ROOT), PluginManager()).version == cartwheel.__version__


def test_the_citation_has_the_version():
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    assert str(citation["version"]) == cartwheel.__version__


@pytest.mark.parametrize("path", PACKAGES, ids=lambda path: path.parent.name)
def test_ros_packages_have_the_version(path):
    assert ElementTree.parse(path).findtext("version") == cartwheel.__version__


def test_the_changelog_begins_with_the_version():
    headings = re.findall(r"^## (.+)$", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)
    assert re.fullmatch(
        rf"(Unreleased: )?{re.escape(cartwheel.__version__)}( - \d{{4}}-\d\d-\d\d)?", headings[0]
    )
