"""Which plugin answers to which file name, and what a model's tags make."""

from __future__ import annotations

import functools
import importlib.metadata
import re

from cartwheel.description.model import PluginTag, Sensor
from cartwheel.errors import CartwheelError, Diagnostic, likely
from cartwheel.graph import Graph
from cartwheel.plugins.base import Plugin
from cartwheel.simulation import Part
from cartwheel.simulation.simulation import Behaviour

_IGNORED = {"gazebo_ros_control": "gazebo_ros_control"}


def short_name(filename: str) -> str:
    """A plugin's name without path, ``lib``, ``.so`` and the vendor's older spelling."""
    stem = filename.rsplit("/", 1)[-1]
    stem = re.sub(r"\.(so|dylib|dll)$", "", stem)
    stem = stem.removeprefix("lib")
    return stem.replace("ignition-gazebo-", "gz-sim-")


@functools.cache
def plugins() -> dict[str, type[Plugin[object]]]:
    """All plugins by short name: ours, and those of installed packages."""
    from cartwheel.plugins.camera import Camera
    from cartwheel.plugins.contact import Bumper
    from cartwheel.plugins.diff_drive import DiffDrive
    from cartwheel.plugins.imu import Imu, ImuSensor

    known: dict[str, type[Plugin[object]]] = {}
    third = (entry.load() for entry in importlib.metadata.entry_points(group="cartwheel.plugins"))
    for plugin in (DiffDrive, Camera, Imu, ImuSensor, Bumper, *third):
        for filename in plugin.filenames:
            known[short_name(filename)] = plugin
    return known


def attach(part: Part, graph: Graph) -> list[Behaviour]:
    """Makes the plugins of a model; what is not supported is reported, never passed over.

    Raises:
        CartwheelError: A plugin's parameters make no sense; those made before are closed.
    """
    made: list[Plugin[object]] = []
    sensors = [sensor for link in part.description.links for sensor in link.sensors]
    pairs: list[tuple[PluginTag, Sensor | None]] = [(tag, None) for tag in part.description.plugins]
    pairs += [(tag, sensor) for sensor in sensors for tag in sensor.plugins]
    try:
        for tag, sensor in pairs:
            plugin = plugins().get(short_name(tag.filename))
            if plugin is None:
                _report_unknown(part, tag)
            elif plugin.for_sensor and sensor is None:
                part.report(
                    Diagnostic(
                        severity="warning",
                        message=f'plugin "{tag.filename}" has no effect here: '
                        "it belongs inside a <sensor>",
                        origin=tag.origin,
                    )
                )
            else:
                made.append(plugin(part, graph, tag, sensor))
    except CartwheelError:
        for plugin_made in made:
            plugin_made.close()
        raise
    for sensor in sensors:
        if not sensor.plugins:
            part.report(
                Diagnostic(
                    severity="info",
                    message=f'sensor "{sensor.name}" has no <plugin>, so it publishes nothing',
                    origin=sensor.origin,
                )
            )
    return list(made)


def _report_unknown(part: Part, tag: PluginTag) -> None:
    # Only a spelling error has a likely meant name: other plugins share most of theirs.
    meant = likely(tag.filename, [f"lib{name}.so" for name in plugins()], cutoff=0.92)
    part.report(
        Diagnostic(
            severity="warning",
            message=f'plugin "{tag.filename}" is not supported: what it does is missing here. '
            f"{meant}".rstrip(),
            origin=tag.origin,
        )
    )
