"""The catalogue knows every plugin by what the plugin itself answers to, and imports no more."""

import importlib
import pkgutil
import subprocess
import sys
from pathlib import Path

import pytest

import cartwheel.dialects
from cartwheel.dialects.catalogue import (
    all_plugins,
    plugin_named,
    plugin_names,
    plugin_serving,
    short_name,
)
from cartwheel.dialects.plugin import Plugin


def written():
    """Every class in the package that answers to something."""
    package = cartwheel.dialects
    for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
        for each in vars(importlib.import_module(module.name)).values():
            if not (isinstance(each, type) and issubclass(each, Plugin)):
                continue
            if each.__module__ == module.name and hasattr(each, "filenames"):
                yield each


def test_the_generated_tables_are_up_to_date():
    script = Path(__file__).parents[2] / "tools" / "make_catalogue.py"
    done = subprocess.run(
        [sys.executable, str(script), "--check"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


def test_every_plugin_is_found_by_each_of_its_names():
    classes = list(written())
    assert len(classes) > 40
    for plugin in classes:
        for filename in plugin.filenames:
            assert plugin_named(filename) is plugin, filename
        for kind in plugin.serves:
            assert plugin_serving(kind) is plugin, kind
    assert set(all_plugins()) == {each for each in classes if each.filenames or each.serves}


def test_every_name_leads_to_a_plugin():
    for name in plugin_names():
        plugin = plugin_named(name)
        assert plugin is not None, name
        assert name in {short_name(filename) for filename in plugin.filenames}


@pytest.mark.parametrize(
    "filename",
    [
        "libignition-gazebo-diff-drive-system.so",
        "ignition-gazebo6-diff-drive-system",
        "/opt/lib/libgz-sim8-diff-drive-system.so",
    ],
)
def test_a_library_of_one_version_of_new_gazebo_is_known(filename):
    assert plugin_named(filename) is plugin_named("gz-sim-diff-drive-system")


@pytest.mark.parametrize("maker", ["hsrb", "baxter", "hwi_switch"])
def test_what_a_maker_derived_from_ros_control_is_taken_for_that(maker):
    assert plugin_named(f"lib{maker}_gazebo_ros_control.so") is plugin_named("gazebo_ros_control")


def test_a_name_of_none_is_none():
    assert plugin_named("libmarvellous.so") is None
    assert plugin_serving("nose") is None


def test_only_what_is_named_is_imported():
    done = subprocess.run(
        [
            sys.executable,
            "-c",
            "import sys; from cartwheel.dialects.catalogue import plugin_named;"
            "assert plugin_named('libgazebo_ros_imu.so');"
            "print('cartwheel.dialects.classic.sensors.imu' in sys.modules);"
            "print('cartwheel.dialects.makers.hector_gps' in sys.modules)",
        ],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.split() == ["True", "False"]
