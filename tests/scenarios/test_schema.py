"""The format of scenarios: what is accepted, and where a mistake is."""

from __future__ import annotations

import json

import pytest
from tests.coded import raises

from cartwheel.codes.command import SCENARIO_INVALID
from cartwheel.scenarios import schema_text
from cartwheel.scenarios.document import parse

MISTAKES = [
    ("expects: []", 1, {"name": "expects", "meant": "expect"}),
    ("world: walls", 1, {"missing": "expect"}),
    ("expect: []", 1, {"items": 0}),
    ("expect:\n  - reaches: cart\n    withn: 1\n", 3, {"name": "withn", "meant": "within"}),
    ("expect:\n  - reach: cart\n", 2, {"meant": "reaches"}),
    ("expect:\n  - reaches: cart\n    x: far\n", 3, {"value": "far"}),
    ("expect:\n  - reaches: cart\n    within: -1\n", 3, {"value": -1}),
    ("expect:\n  - {reaches: cart, when: soon}\n", 2, {"value": "soon"}),
    ("steps:\n  - wait: 1\n    push: cart\nexpect: [{moves: a}]\n", 2, {}),
    ("steps:\n  - wiat: 1\nexpect: [{moves: a}]\n", 2, {"meant": "wait"}),
    ("seeds: 0\nexpect: [{moves: a}]\n", 1, {"value": 0}),
    ("robots:\n  - name: cart\nexpect: [{moves: a}]\n", 2, {"missing": "robot"}),
    ("parameters: {a: {range: [1, 2]}}\nexpect: [{moves: a}]\n", 1, {"key": "parameters.a"}),
    ("parameters: {a: 3}\nexpect: [{moves: a}]\n", 1, {"key": "parameters.a"}),
    ("lockstep:\n  ros2: true\nexpect: [{moves: a}]\n", 1, {"missing": "commands"}),
    ("- a\n- b\n", 1, {}),
    ("", 0, {}),
    ("a: [\n", 2, {}),
    ("seed: 1\nseed: 2\nexpect: [{moves: a}]\n", 2, {"key": "seed"}),
    ("1: 2\n", 1, {"key": "1"}),
    ("duration: .nan\nexpect: [{moves: a}]\n", 1, {}),
    ("seed: true\nexpect: [{moves: a}]\n", 1, {}),
    ("expect:\n  - push: a\n", 2, {}),
    ("parameters:\n  v: {from: 0, to: 1}\nexpect: [{moves: a}]\n", 2, {"missing": "count"}),
]


@pytest.mark.parametrize(("text", "line", "values"), MISTAKES, ids=range(len(MISTAKES)))
def test_a_mistake_has_a_line_and_a_suggestion(scenario, text, line, values):
    with raises(SCENARIO_INVALID) as raised:
        scenario(text)
    error = raised.value
    assert error.origin is not None and error.origin.line == line
    assert {key: error.values.get(key) for key in values} == values


def test_a_missing_file_is_an_error(tmp_path):
    from cartwheel.scenarios import load_scenario

    with raises(SCENARIO_INVALID):
        load_scenario(tmp_path / "none.yaml")


def test_the_schema_is_a_valid_json_schema():
    jsonschema = pytest.importorskip("jsonschema")
    jsonschema.Draft202012Validator.check_schema(json.loads(schema_text()))


@pytest.mark.parametrize("text", [text for text, line, _ in MISTAKES if line and text[0] != "a"])
def test_editors_reject_the_same_files(text, tmp_path):
    """Those that are YAML with each key once."""
    jsonschema = pytest.importorskip("jsonschema")
    if ".nan" in text or "seed: 2" in text or "push: cart" in text or "1: 2" in text:
        return  # not expressible, or not JSON
    validator = jsonschema.Draft202012Validator(json.loads(schema_text()))
    assert not validator.is_valid(parse(text, tmp_path).value)


def test_each_key_has_a_description():
    def check(rule, place):
        if isinstance(rule, dict):
            for name, each in rule.get("properties", {}).items():
                named = each.get("description") or "$ref" in each
                assert named, f"{place}.{name}"
            for name, each in rule.items():
                check(each, f"{place}.{name}")
        elif isinstance(rule, list):
            for index, each in enumerate(rule):
                check(each, f"{place}[{index}]")

    check(json.loads(schema_text()), "")


def test_yaml_anchors_and_merges_work(scenario):
    text = "a: &a {reaches: cart, x: 1}\nexpect:\n  - {<<: *a, x: 2}\n"
    loaded = parse(text, scenario("expect: [{moves: a}]").file)
    assert loaded.value["expect"] == [{"reaches": "cart", "x": 2}]
