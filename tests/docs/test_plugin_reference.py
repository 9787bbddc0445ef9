"""The plugin reference says what the code does."""

import contextlib
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from tests import launching

from cartwheel.dialects.catalogue import all_plugins
from cartwheel.dialects.plugin import Plugin

ROOT = Path(__file__).parents[2]
PLUGINS = [each for each in all_plugins() if each.__module__.startswith("cartwheel.")]


def test_the_reference_is_up_to_date() -> None:
    script = ROOT / "tools" / "make_plugin_reference.py"
    done = launching.run(
        [sys.executable, str(script), "--check"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("plugin", PLUGINS, ids=lambda each: each.__name__)
def test_each_example_loads_without_a_warning(
    plugin: type[Plugin[Any]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    from make_plugin_reference import load_example
    from plugin_examples import slug

    page = (ROOT / "docs" / "plugins" / f"{slug(plugin)}.md").read_text()
    assert page.count("```xml") == 1
    with contextlib.closing(load_example(plugin)) as session:
        reports = session.simulation.diagnostics
    assert [each for each in reports if each.severity != "info"] == []


def test_a_plugin_whose_example_does_not_load_needs_one_in_a_file(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    import make_plugin_reference

    (plugin,) = (each for each in PLUGINS if "libgazebo_ros_p3d.so" in each.filenames)
    text = make_plugin_reference.example(plugin).replace("base_footprint", "hook")
    monkeypatch.setattr(make_plugin_reference, "all_plugins", lambda: [plugin])
    monkeypatch.setattr(make_plugin_reference, "example", lambda *_, **__: text)
    with pytest.raises(SystemExit, match=r"tools/examples/libgazebo_ros_p3d\.xml"):
        make_plugin_reference.reference()


@pytest.mark.parametrize("picture", sorted((ROOT / "docs/images/plugins").glob("*.svg")))
def test_each_picture_is_valid_xml(picture: Path) -> None:
    assert ElementTree.parse(picture).getroot().tag.endswith("svg")
