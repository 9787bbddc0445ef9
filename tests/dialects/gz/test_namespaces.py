"""Two copies of each robot of gz-sim, in two namespaces, share no topic and no frame."""

import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from tests.coded import coded

import cartwheel as cw
from cartwheel.codes.graph import TOPICS_SHARED
from cartwheel.dialects.catalogue import plugin_named, plugin_serving

ROBOTS = Path(__file__).parents[2] / "golden" / "robots"
NAMES = sorted(
    each.name
    for each in ROBOTS.glob("*.urdf")
    if (each.name.startswith("gz-sim-") and "lift-drag" not in each.name)  # without topics
    or each.stem.removesuffix("-switched").endswith("-sensor")
)


def with_relative_topics(text: str) -> tuple[str, list[str]]:
    """A robot whose plugins and sensors state all their topics, relative, and these topics."""
    root = ET.fromstring(text)
    stated = []
    for element in (*root.iter("plugin"), *root.iter("sensor")):
        name = element.get("filename")
        kind = plugin_named(name) if name else plugin_serving(element.get("type", ""))
        if kind is None or element.find("plugin") is not None:
            continue
        for field in kind.parameters.__dataclass_fields__.values():
            tag = field.metadata.get("tags", ("",))[0]
            if field.type != "str" or not tag.endswith(("topic", "Topic")):
                continue
            *parents, last = tag.split("/")
            place = element
            for parent in parents:
                found = place.find(parent)
                place = ET.SubElement(place, parent) if found is None else found
            for old in place.findall(last):
                place.remove(old)
            stated.append(f"own-{len(stated)}/{last}")
            ET.SubElement(place, last).text = stated[-1]
    return ET.tostring(root, encoding="unicode"), stated


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("relative", [False, True])
def test_two_copies_share_nothing(name: str, relative: bool) -> None:
    text, stated = (ROBOTS / name).read_text(), []
    if relative:
        text, stated = with_relative_topics(text)
        if not stated:
            pytest.skip("nothing of this robot has a topic")
    with cw.World("empty") as world:
        models = [
            world.spawn(text, name=each, namespace=each, frame_prefix=each, y=y, z=0.2)
            for each, y in (("one", 0.0), ("two", 20.0))
        ]
        assert coded(world, TOPICS_SHARED) == []
        for model in models:
            own = f"/{model.name}/"
            assert model.topics
            assert all(own in f"{topic}/" for topic in model.topics if topic != "/tf"), model.topics
        assert sum(topic.startswith("/one/own_") for topic in models[0].topics) >= bool(stated)
        topics = [
            topic
            for topic in map(world.topic, models[0].topics)
            if topic.type.startswith(("nav_msgs/", "sensor_msgs/", "tf2_msgs/", "geometry_msgs/"))
        ]
        world.run(0.5)
        frames = set()
        for message in (each.latest for each in topics):
            stamped = [*getattr(message, "transforms", ()), message]
            frames |= {each.header.frame_id for each in stamped if hasattr(each, "header")}
            frames |= {each.child_frame_id for each in stamped if hasattr(each, "child_frame_id")}
        frames -= {"", "world", "default"}
        for frame in frames:
            assert frame.split("/").count("one") == 1, frames
            assert frame == "one" or frame.startswith("one/"), frames
