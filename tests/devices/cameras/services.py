"""Calls of a camera's services."""

from cartwheel.messages import from_dict, to_dict

ROS1 = "<cameraName>eye</cameraName>"


def call(world, name, type_name, request):
    """A service's response, its request given as a mapping."""
    future = world.session.graph.call(name, from_dict(f"{type_name}_Request", request))
    world.run(0.005)
    return future.result(timeout=10)


def configure(world, name, **values):
    fields = {bool: "bools", int: "ints", str: "strs", float: "doubles"}
    config = {}
    for key, value in values.items():
        config.setdefault(fields[type(value)], []).append({"name": key, "value": value})
    response = call(
        world, f"{name}/set_parameters", "dynamic_reconfigure/srv/Reconfigure", {"config": config}
    )
    return values_of(response.config)


def values_of(config):
    reported = to_dict(config)
    return {
        item["name"]: item["value"]
        for field in ("bools", "ints", "strs", "doubles")
        for item in reported[field]
    }


def stamps(messages):
    return [m.header.stamp.sec * 10**9 + m.header.stamp.nanosec for m in messages]
