"""QoS profiles of topics, in the format of rosbag2."""

from __future__ import annotations

from typing import Any

_FOREVER = {"sec": 9223372036, "nsec": 854775807}


def qos(*, latched: bool) -> list[dict[str, Any]]:
    """QoS profile of a topic's publisher."""
    return [
        {
            "history": "keep_last",
            "depth": 1 if latched else 10,
            "reliability": "reliable",
            "durability": "transient_local" if latched else "volatile",
            "deadline": _FOREVER,
            "lifespan": _FOREVER,
            "liveliness": "automatic",
            "liveliness_lease_duration": _FOREVER,
            "avoid_ros_namespace_conventions": False,
        }
    ]


def qos_text(*, latched: bool) -> str:
    """The result of `qos` as YAML."""
    (profile,) = qos(latched=latched)
    lines = []
    for name, value in profile.items():
        if isinstance(value, dict):
            lines.append(f"{name}:")
            lines += [f"  {part}: {number}" for part, number in value.items()]
        else:
            lines.append(f"{name}: {str(value).lower()}")
    return "- " + "\n  ".join(lines)
