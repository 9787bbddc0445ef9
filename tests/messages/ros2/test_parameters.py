"""Parameters of nodes: their types, and which names a listing has."""

from typing import Any

import pytest

from cartwheel.codes.graph import FIELD_VALUE_INVALID
from cartwheel.dialects.ros_control.parameter_services import ParameterServices
from cartwheel.errors import GraphError
from cartwheel.messages import decode_cdr, encode_cdr, from_dict, zero
from cartwheel.messages.ros2.parameters import FIELDS, listed, parameter_type, parameter_value

NAMES = ["a", "a.b", "a.b.c", "ab.c", "d.e.f.g"]


@pytest.mark.parametrize(
    ("value", "number"),
    [
        (True, 1), (3, 2), (0.5, 3), ("x", 4),
        ([True, False], 6), ([1, 2], 7), ([0.5, 1], 8), (["x", "y"], 9),
        ([], 0), (None, 0), ({}, 0), ([1, "x"], 0), ([[1]], 0), ([True, 1.0], 0),
    ],
)  # fmt: skip
def test_a_value_has_the_type_that_ros_gives_it(value: Any, number: int) -> None:
    assert parameter_type(value) == number
    made = parameter_value(value)
    encode_cdr(made)
    assert made.type == number
    if number:
        reported = getattr(made, FIELDS[number])
        assert list(reported) == value if isinstance(value, list) else reported == value


@pytest.mark.parametrize(
    ("prefixes", "depth", "found"),
    [
        ([], 0, NAMES),
        ([], 1, ["a"]),
        ([], 2, ["a", "a.b", "ab.c"]),
        (["a"], 0, ["a", "a.b", "a.b.c"]),
        (["a"], 1, ["a", "a.b"]),
        (["a.b", "d"], 1, ["a.b", "a.b.c"]),
        (["none"], 0, []),
    ],
)
def test_a_listing_has_what_is_below_its_prefixes(
    prefixes: list[str], depth: int, found: list[str]
) -> None:
    result = listed(reversed(NAMES), prefixes, depth)
    assert result.names == found
    assert result.prefixes == sorted({n.rpartition(".")[0] for n in found if "." in n})


def services() -> dict[str, Any]:
    """The handlers of the services of a node whose parameters can all be set."""
    handlers: dict[str, Any] = {}
    ParameterServices(
        lambda name, _, handler: handlers.update({name.rpartition("/")[2]: handler}),
        "/node",
        {},
        open_=True,
    )
    return handlers


@pytest.mark.parametrize(
    ("service", "kind", "field"),
    [
        ("describe_parameters", "DescribeParameters", "names"),
        ("get_parameter_types", "GetParameterTypes", "names"),
        ("get_parameters", "GetParameters", "names"),
        ("list_parameters", "ListParameters", "prefixes"),
        ("set_parameters", "SetParameters", "parameters"),
        ("set_parameters_atomically", "SetParametersAtomically", "parameters"),
    ],
)
def test_a_request_has_a_limited_number_of_elements(service: str, kind: str, field: str) -> None:
    request = zero(f"rcl_interfaces/srv/{kind}_Request")
    each = zero("rcl_interfaces/msg/Parameter") if field == "parameters" else ""
    setattr(request, field, [each] * 10_000)
    services()[service](request)
    setattr(request, field, [each] * 10_001)
    with pytest.raises(GraphError) as caught:
        services()[service](request)
    assert caught.value.code is FIELD_VALUE_INVALID
    assert caught.value.values == {"field": field, "count": 10_001}


def setting(*given: tuple[str, dict[str, Any]]) -> Any:
    kind = "rcl_interfaces/srv/SetParameters_Request"
    made = from_dict(kind, {"parameters": [{"name": name, "value": v} for name, v in given]})
    return decode_cdr(encode_cdr(made), kind)


def test_the_parameters_that_are_set_have_a_limited_size() -> None:
    handlers = services()
    large = {"type": 4, "string_value": "x" * 1_000_000}
    names = [f"p{number}" for number in range(6)]
    results = handlers["set_parameters"](setting(*((name, large) for name in names))).results
    assert [each.successful for each in results] == [True] * 4 + [False] * 2
    assert (
        not handlers["set_parameters"](setting((f"{'n' * 1_000_000}", {"type": 1})))
        .results[0]
        .successful
    )
    # Another value of the same parameter, and one after another was removed, are possible.
    again = setting(("p0", large), ("p1", {"type": 0}), ("p5", large), ("p5", large))
    results = handlers["set_parameters"](again).results
    assert all(each.successful for each in results)
    assert not handlers["set_parameters"](setting(("p1", large))).results[0].successful


def test_a_parameter_does_not_keep_the_request_that_set_it() -> None:
    handlers = services()
    request = setting(
        ("a", {"type": 7, "integer_array_value": [1, 2]}),
        ("b", {"type": 4, "string_value": "x" * 100_000}),
    )
    handlers["set_parameters"](request)
    names = zero("rcl_interfaces/srv/GetParameters_Request")
    names.names = ["a"]
    array = handlers["get_parameters"](names).values[0].integer_array_value
    assert array.tolist() == [1, 2]
    base = array
    while getattr(base, "base", None) is not None:
        base = base.base
    assert len(memoryview(base).cast("B")) < 1000
