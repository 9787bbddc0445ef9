"""Check reports as JSON, SARIF, GitHub annotations and JUnit XML."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any
from urllib.parse import quote
from xml.etree import ElementTree

import cartwheel
from cartwheel.checks import Result
from cartwheel.cli.showing import column_of
from cartwheel.codes import explanation
from cartwheel.errors import Diagnostic

SCHEMA = 2
SARIF_SCHEMA = "https://json.schemastore.org/sarif-2.1.0.json"
_NOT_XML = re.compile("[^\t\n\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_LEVELS = {"error": "error", "warning": "warning", "info": "note"}
_COMMANDS = {"error": "error", "warning": "warning", "info": "notice"}


def as_json(result: Result) -> str:
    """The report in the format documented in docs/check.md."""
    return json.dumps(as_mapping(result), indent=2)


def as_mapping(result: Result) -> dict[str, Any]:
    """The same as data."""
    reports = result.reports
    return {
        "schema": SCHEMA,
        "file": reports[0].file if len(reports) == 1 else result.path,
        "name": reports[0].name if len(reports) == 1 else "",
        "complete": result.complete,
        "descriptions": [
            {"file": each.file, "name": each.name, "complete": each.complete} for each in reports
        ],
        "summary": {
            "error": result.count("error"),
            "warning": result.count("warning"),
            "info": result.count("info"),
            "ignored": result.ignored,
            "suppressed": result.suppressed,
            "accepted": result.accepted,
        },
        "findings": [_finding(finding) for finding in result.findings],
    }


def _finding(finding: Diagnostic) -> dict[str, Any]:
    origin = finding.origin
    return {
        "code": finding.code.number,
        "name": finding.code.name,
        "rule": finding.code.name,
        "severity": finding.severity,
        "message": finding.message,
        "file": origin.file if origin is not None else "",
        "line": origin.line if origin is not None else 0,
        "column": column_of(finding),
        "stack": list(origin.stack) if origin is not None else [],
        "instead": finding.instead,
        "place": finding.place,
        "hint": finding.hint,
        "values": dict(finding.values),
        "also": [each.message for each in finding.also],
    }


def as_sarif(result: Result) -> str:
    """SARIF 2.1.0, for code scanning; files are relative to the working directory."""
    codes = sorted({each.code for each in result.findings}, key=lambda each: each.number)
    rules = [
        {
            "id": code.number,
            "name": code.name,
            "shortDescription": {"text": code.summary},
            "fullDescription": {"text": _first_paragraph(code)},
            "defaultConfiguration": {"level": _LEVELS[code.severity]},
        }
        for code in codes
    ]
    results = [
        {
            "ruleId": finding.code.number,
            "ruleIndex": codes.index(finding.code),
            "level": _LEVELS[finding.severity],
            "message": {"text": _text(finding)},
            "locations": [_location(finding)] if finding.origin is not None else [],
        }
        for finding in result.findings
    ]
    driver = {"name": "cartwheel", "version": cartwheel.__version__, "rules": rules}
    run = {
        "tool": {"driver": driver},
        "results": results,
        "columnKind": "unicodeCodePoints",
        "invocations": [{"executionSuccessful": result.complete}],
    }
    log = {"$schema": SARIF_SCHEMA, "version": "2.1.0", "runs": [run]}
    return json.dumps(log, indent=2)


def as_github(result: Result) -> str:
    """Workflow commands, which GitHub Actions shows next to the affected lines."""
    return "\n".join(map(_annotation, result.findings))


def as_junit(result: Result) -> str:
    """JUnit XML: a test case per description, which fails for errors and warnings."""
    suite = ElementTree.Element("testsuite", {"name": "cartwheel check"})
    failures = 0
    for report in result.reports:
        case = ElementTree.SubElement(
            suite,
            "testcase",
            {"classname": "cartwheel.check", "name": _in_xml(_relative(report.file))},
        )
        files = set(report.files)
        own = [each for each in result.findings if each.origin is None or each.origin.file in files]
        grave = [each for each in own if each.severity != "info"]
        if grave or not report.complete:
            failures += 1
            summary = (
                f"{len(grave)} findings" if grave else ("the file could not be read completely")
            )
            failure = ElementTree.SubElement(case, "failure", {"message": summary})
            failure.text = _in_xml(
                "\n".join(f"{each}{f' {each.hint}' if each.hint else ''}" for each in grave)
            )
    suite.set("tests", str(len(result.reports)))
    suite.set("failures", str(failures))
    suites = ElementTree.Element("testsuites")
    suites.append(suite)
    ElementTree.indent(suites)
    return ElementTree.tostring(suites, encoding="unicode", xml_declaration=True)


FORMATS: Mapping[str, Callable[[Result], str]] = {
    "json": as_json,
    "sarif": as_sarif,
    "github": as_github,
    "junit": as_junit,
}
"""All formats except ``text``, by name."""


def _first_paragraph(code: Any) -> str:
    return " ".join(explanation(code).split("\n\n", 1)[0].split())


def _text(finding: Diagnostic) -> str:
    parts = [finding.message, finding.hint]
    if finding.instead:
        parts.append(f"Use {finding.instead}")
    return ". ".join(part.rstrip(".") for part in parts if part) + "."


def _location(finding: Diagnostic) -> dict[str, Any]:
    assert finding.origin is not None
    uri = quote(_relative(finding.origin.file), errors="surrogateescape")
    place: dict[str, Any] = {"artifactLocation": {"uri": uri}}
    if finding.origin.line:
        place["region"] = {"startLine": finding.origin.line}
        column = column_of(finding)
        if column:
            place["region"]["startColumn"] = column
    return {"physicalLocation": place}


def _relative(file: str) -> str:
    """A path relative to the working directory with slashes; unchanged if it is elsewhere."""
    path = Path(os.path.relpath(file))
    return Path(file).as_posix() if path.parts[:1] == ("..",) else path.as_posix()


def _in_xml(text: str) -> str:
    """A text without characters that are invalid in XML."""
    return _NOT_XML.sub("\N{REPLACEMENT CHARACTER}", text)


def _annotation(finding: Diagnostic) -> str:
    properties = {"title": str(finding.code)}
    if finding.origin is not None:
        properties = {"file": _relative(finding.origin.file), **properties}
        if finding.origin.line:
            properties["line"] = str(finding.origin.line)
    shown = ",".join(f"{key}={_escaped(value, ':,')}" for key, value in properties.items())
    return f"::{_COMMANDS[finding.severity]} {shown}::{_escaped(_text(finding))}"


def _escaped(text: str, more: str = "") -> str:
    """Escapes a text for workflow commands: a line break would begin a new command."""
    for letter in ("%", "\r", "\n", *more):
        text = text.replace(letter, f"%{ord(letter):02X}")
    return text
