"""Values changed while a node runs: what is published, and what a request may change."""

import math

import pytest
from tests.coded import raises

from cartwheel.codes.graph import SERVICE_TAKEN
from cartwheel.errors import GraphError, UnknownNameError
from cartwheel.graph import Graph, ReconfigureParameter, ReconfigureServer, choices
from cartwheel.messages import from_dict, to_dict

PARAMETERS = (
    ReconfigureParameter(name="enable", type="bool", default=True, description="on"),
    ReconfigureParameter(
        name="format", type="str", default="jpeg", edit_method=choices("jpeg", "png")
    ),
    ReconfigureParameter(name="quality", type="int", default=80, minimum=1, maximum=100, level=2),
    ReconfigureParameter(name="rate", type="double", default=2.0, minimum=1.0, maximum=50.0),
    ReconfigureParameter(name="free", type="double", default=0.0),
    ReconfigureParameter(name="progressive", type="bool", default=False),
)
DEFAULT_GROUP = [{"name": "Default", "state": True, "id": 0, "parent": 0}]


def serve(graph=None, on_change=lambda values: None, **more):
    graph = graph or Graph()
    return graph, ReconfigureServer(graph, "/eye", PARAMETERS, on_change, node="test", **more)


def last(graph, topic):
    box = graph.mailbox(topic)
    (message,) = box.drain()
    box.close()
    return to_dict(message)


def values(config):
    return {
        item["name"]: item["value"]
        for field in ("bools", "ints", "strs", "doubles")
        for item in config[field]
    }


def change(graph, **lists):
    config = {
        field: [{"name": name, "value": value} for name, value in pairs.items()]
        for field, pairs in lists.items()
    }
    request = from_dict("dynamic_reconfigure/srv/Reconfigure_Request", {"config": config})
    return values(to_dict(graph.call("/eye/set_parameters", request).result())["config"])


def test_description_is_laid_out_as_dynamic_reconfigure_does():
    graph, _ = serve()
    reported = last(graph, "/eye/parameter_descriptions")
    (group,) = reported["groups"]
    assert (group["name"], group["type"], group["parent"], group["id"]) == ("Default", "", 0, 0)
    assert [(p["name"], p["type"], p["level"]) for p in group["parameters"]] == [
        ("enable", "bool", 0),
        ("format", "str", 0),
        ("quality", "int", 2),
        ("rate", "double", 0),
        ("free", "double", 0),
        ("progressive", "bool", 0),
    ]
    assert group["parameters"][0]["description"] == "on"
    assert reported["max"] == {
        "bools": [{"name": "enable", "value": True}, {"name": "progressive", "value": True}],
        "ints": [{"name": "quality", "value": 100}],
        "strs": [{"name": "format", "value": ""}],
        "doubles": [{"name": "rate", "value": 50.0}, {"name": "free", "value": math.inf}],
        "groups": DEFAULT_GROUP,
    }
    assert reported["min"] == {
        "bools": [{"name": "enable", "value": False}, {"name": "progressive", "value": False}],
        "ints": [{"name": "quality", "value": 1}],
        "strs": [{"name": "format", "value": ""}],
        "doubles": [{"name": "rate", "value": 1.0}, {"name": "free", "value": -math.inf}],
        "groups": DEFAULT_GROUP,
    }
    assert values(reported["dflt"]) == {p.name: p.default for p in PARAMETERS}
    assert last(graph, "/eye/parameter_updates") == reported["dflt"]


def test_clients_find_the_choices():
    reported = eval(choices("jpeg", "png", description="how"))
    assert [(item["name"], item["value"], item["type"]) for item in reported["enum"]] == [
        ("jpeg", "jpeg", "str"),
        ("png", "png", "str"),
    ]
    assert reported["enum_description"] == "how"


def test_a_request_for_some_keeps_the_rest():
    seen = []
    graph, server = serve(on_change=seen.append)
    assert change(graph, ints={"quality": 10}) == server.values
    assert change(graph, doubles={"rate": 4.5}, bools={"progressive": True}) == server.values
    expected = {p.name: p.default for p in PARAMETERS}
    expected |= {"quality": 10, "rate": 4.5, "progressive": True}
    assert server.values == expected == seen[-1] == values(last(graph, "/eye/parameter_updates"))
    assert len(seen) == 2


@pytest.mark.parametrize(
    ("field", "name", "asked", "got"),
    [
        ("doubles", "rate", 1000.0, 50.0),
        ("doubles", "rate", -1.0, 1.0),
        ("doubles", "rate", math.inf, 50.0),
        ("ints", "quality", 101, 100),
        ("ints", "quality", 0, 1),
        ("doubles", "free", -1e9, -1e9),
        # A client that counts 10 as a whole number.
        ("ints", "rate", 10, 10.0),
    ],
)
def test_values_are_kept_within_their_bounds(field, name, asked, got):
    graph, server = serve()
    assert change(graph, **{field: {name: asked}})[name] == got
    assert type(server.values[name]) is type(got)


def test_a_correction_counts():
    graph, server = serve(on_change=lambda values: {"quality": values["quality"] // 2})
    assert change(graph, ints={"quality": 50})["quality"] == 25
    assert server.values["quality"] == 25


def refuse(values):
    raise GraphError("no")


@pytest.mark.parametrize(
    ("lists", "error", "on_change"),
    [
        ({"doubles": {"rte": 1.0}}, UnknownNameError, None),
        ({"strs": {"quality": "high"}}, GraphError, None),
        ({"doubles": {"quality": 1.5}}, GraphError, None),
        ({"doubles": {"free": math.nan}}, GraphError, None),
        ({"ints": {"enable": 2}}, GraphError, None),
        ({"ints": {"quality": 5}}, GraphError, refuse),
    ],
)
def test_what_is_refused_changes_nothing(lists, error, on_change):
    graph, server = serve(on_change=on_change or (lambda values: None))
    before, updates = server.values, graph.mailbox("/eye/parameter_updates")
    updates.drain()
    with pytest.raises(error):
        change(graph, **lists)
    assert server.values == before
    assert updates.drain() == []


def test_initial_values_and_updates_from_elsewhere_are_published():
    graph, server = serve(initial={"rate": 100})
    assert values(last(graph, "/eye/parameter_updates"))["rate"] == 100.0
    server.update({"rate": 7, "format": "png"})
    reported = values(last(graph, "/eye/parameter_updates"))
    assert (reported["rate"], reported["format"]) == (7.0, "png")
    assert graph.parameters.get("/eye") == reported
    with pytest.raises(UnknownNameError):
        server.update({"rte": 1})


@pytest.mark.parametrize("preset", [True, False])
def test_parameters_of_the_graph_count_where_asked(preset):
    graph = Graph()
    graph.parameters.set("/eye/quality", 1000)
    _, server = serve(graph, preset=preset)
    assert server.values["quality"] == (100 if preset else 80)
    assert graph.parameters.get("/eye/quality") == server.values["quality"]


def test_closing_takes_all_off_the_graph_and_one_name_serves_once():
    graph, server = serve()
    with raises(SERVICE_TAKEN):
        serve(graph)
    assert [topic.publishers for topic in graph.topics()] == [("test",), ("test",)]
    server.close()
    assert graph.topics() == []
    assert graph.services() == []
    serve(graph)
    assert len(graph.services()) == 1
