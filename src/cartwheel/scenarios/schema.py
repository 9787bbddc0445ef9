"""Validates scenarios against the JSON Schema that editors also use.

``schema.json`` is the only description of the format. This module supports the keywords that it
uses. A library such as jsonschema reports a wrong step as "not valid under any of the given
schemas", without a line or a suggestion.
"""

from __future__ import annotations

import json
import math
import re
from functools import cache
from importlib import resources
from typing import Any

from cartwheel.scenarios.document import Document, Key, ScenarioError
from cartwheel.similar_names import meant_one, suggestion

_KINDS: dict[str, tuple[type, ...]] = {
    "object": (dict,),
    "array": (list,),
    "string": (str,),
    "integer": (int,),
    "number": (int, float),
    "boolean": (bool,),
}
_NAMES = {
    "object": "a mapping",
    "array": "a list",
    "string": "a text",
    "integer": "a whole number",
    "number": "a number",
    "boolean": "true or false",
}


def schema_text() -> str:
    """The JSON Schema of scenarios."""
    return (resources.files(__name__.rpartition(".")[0]) / "schema.json").read_text("utf-8")


@cache
def schema() -> dict[str, Any]:
    """The JSON Schema as data."""
    loaded: dict[str, Any] = json.loads(schema_text())
    return loaded


def validate(document: Document) -> None:
    """Checks the format of a scenario.

    Raises:
        ScenarioError: A key is unknown or missing, or a value is invalid.
    """
    _check(document, schema(), document.value, ())


def _resolved(rule: dict[str, Any]) -> dict[str, Any]:
    while "$ref" in rule:
        found: Any = schema()
        for part in rule["$ref"].removeprefix("#/").split("/"):
            found = found[part]
        rule = found
    return rule


def _check(document: Document, rule: dict[str, Any], value: Any, key: Key) -> None:
    rule = _resolved(rule)
    if "anyOf" in rule:
        _check_any(document, rule["anyOf"], value, key)
        return
    if "enum" in rule and value not in rule["enum"]:
        raise document.error(
            key,
            f"{_subject(key)} must be one of {', '.join(rule['enum'])} (got {_short(value)})",
            hint=suggestion(str(value), rule["enum"]),
            values={"value": str(value)},
        )
    kind = rule.get("type")
    if kind is not None:
        if not _is(value, kind):
            raise _wrong(document, key, value, [_NAMES[kind]])
        checks = {"object": _check_object, "array": _check_array, "string": _check_string}
        checks.get(kind, _check_number)(document, rule, value, key)


def _is(value: Any, kind: str) -> bool:
    if isinstance(value, bool):
        return kind == "boolean"
    if isinstance(value, float) and not math.isfinite(value):
        return False
    return isinstance(value, _KINDS[kind])


def _wrong(document: Document, key: Key, value: Any, kinds: list[str]) -> ScenarioError:
    hint = ""
    if isinstance(value, str) and "a number" in kinds and re.fullmatch(r"[-\d.]+[eE]\d+", value):
        hint = "Write a decimal point before the exponent, as YAML requires: 1.0e3."
    return document.error(
        key,
        f"{_subject(key)} must be {' or '.join(dict.fromkeys(kinds))} (got {_short(value)})",
        hint=hint,
        values={"value": _short(value)},
    )


def _check_any(document: Document, rules: list[dict[str, Any]], value: Any, key: Key) -> None:
    """Checks the alternative that is meant: by the type of the value, and by its required key."""
    fitting = [each for each in map(_resolved, rules) if _fits(each, value)]
    if not fitting:
        raise _wrong(document, key, value, [_kind_of(each) for each in map(_resolved, rules)])
    if isinstance(value, dict):
        chosen = [each for each in fitting if all(name in value for name in each["required"])]
        if not chosen:
            begun = next((each for each in fitting if {*each["required"]} & {*value}), None)
            if begun is not None:
                missing = [name for name in begun["required"] if name not in value]
                raise document.error(
                    key,
                    f'{_subject(key)} also requires the key "{missing[0]}"',
                    values={"missing": missing[0]},
                )
            names = list(dict.fromkeys(name for each in fitting for name in each["required"]))
            ways = list(dict.fromkeys(" and ".join(each["required"]) for each in fitting))
            close = next(
                (other for name in value if (other := meant_one(name, names, cutoff=0.6))), ""
            )
            raise document.error(
                key,
                f"{_subject(key)} requires one of these keys: {', or '.join(ways)}",
                hint=f'Did you mean "{close}"?' if close else "",
                values={"meant": close},
            )
        fitting = chosen
        if len(fitting) > 1:
            names = [each["required"][0] for each in fitting]
            raise document.error(
                key,
                f"{_subject(key)} has the keys {' and '.join(names)}, which exclude each other",
                hint="Write a list item for each of them.",
            )
    errors = []
    for each in fitting:
        try:
            _check(document, each, value, key)
        except ScenarioError as error:
            errors.append(error)
        else:
            return
    raise errors[0]


def _fits(rule: dict[str, Any], value: Any) -> bool:
    if "anyOf" in rule:
        return any(_fits(_resolved(each), value) for each in rule["anyOf"])
    return _is(value, rule["type"]) and not (
        "pattern" in rule and isinstance(value, str) and not re.search(rule["pattern"], value)
    )


def _kind_of(rule: dict[str, Any]) -> str:
    if "anyOf" in rule:
        return " or ".join(_kind_of(_resolved(each)) for each in rule["anyOf"])
    return "${expression}" if "pattern" in rule else _NAMES[rule["type"]]


def _check_object(document: Document, rule: dict[str, Any], value: Any, key: Key) -> None:
    known = rule.get("properties", {})
    more = rule.get("additionalProperties", True)
    for name, each in value.items():
        if name in known:
            _check(document, known[name], each, (*key, name))
        elif more is False:
            close = meant_one(name, known, cutoff=0.6)
            raise document.error(
                (*key, name),
                f'"{name}" is unknown{f" in {_subject(key)}" if key else ""}',
                hint=suggestion(name, known),
                values={"name": name, "meant": close},
            )
        elif isinstance(more, dict):
            _check(document, more, each, (*key, name))
    for name in rule.get("required", ()):
        if name not in value:
            raise document.error(
                key, f'{_subject(key)} requires the key "{name}"', values={"missing": name}
            )


def _check_array(document: Document, rule: dict[str, Any], value: Any, key: Key) -> None:
    least, most = rule.get("minItems", 0), rule.get("maxItems", math.inf)
    if not least <= len(value) <= most:
        count = (
            f"{least}"
            if least == most
            else f"{least} to {most}"
            if most < math.inf
            else (f"at least {least}")
        )
        raise document.error(
            key,
            f"{_subject(key)} must have {count} items (got {len(value)})",
            values={"items": len(value)},
        )
    for index, each in enumerate(value):
        _check(document, rule.get("items", {}), each, (*key, index))


def _check_string(document: Document, rule: dict[str, Any], value: Any, key: Key) -> None:
    if not rule.get("minLength", 0) <= len(value) <= rule.get("maxLength", math.inf):
        raise document.error(
            key,
            f"{_subject(key)} must have {rule.get('minLength', 0)} to "
            f"{rule.get('maxLength', '…')} characters (got {len(value)})",
        )


def _check_number(document: Document, rule: dict[str, Any], value: Any, key: Key) -> None:
    least, most = rule.get("minimum", -math.inf), rule.get("maximum", math.inf)
    if isinstance(value, bool) or least <= value <= most:
        return
    limits = f"at least {least}" if most == math.inf else f"between {least} and {most}"
    raise document.error(
        key, f"{_subject(key)} must be {limits} (got {value})", values={"value": value}
    )


def _subject(key: Key) -> str:
    if not key:
        return "a scenario"
    last = key[-1]
    if isinstance(last, str):
        return f'"{last}"'
    parent = next((each for each in reversed(key) if isinstance(each, str)), "")
    return f"item {last + 1} of {parent}"


def _short(value: Any) -> str:
    if isinstance(value, dict | list):
        return _NAMES["object"] if isinstance(value, dict) else _NAMES["array"]
    text = "nothing" if value is None else str(value)
    return text if len(text) <= 60 else f"{text[:60]}…"
