"""JUnit XML for CI servers."""

from __future__ import annotations

import re
from collections.abc import Sequence
from xml.etree import ElementTree

from cartwheel.scenarios.outcome import Outcome

_NOT_XML = re.compile("[^\t\n\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def as_junit(outcomes: Sequence[Outcome]) -> str:
    """A test suite for each scenario, with a test case for each case."""
    suites = ElementTree.Element("testsuites", {"name": "cartwheel test"})
    by_scenario: dict[tuple[str, str], list[Outcome]] = {}
    for outcome in outcomes:
        by_scenario.setdefault((outcome.scenario, outcome.file), []).append(outcome)
    for (name, file), cases in by_scenario.items():
        suite = ElementTree.SubElement(
            suites,
            "testsuite",
            {
                "name": _in_xml(name),
                "tests": str(len(cases)),
                "failures": str(sum(each.status == "failed" for each in cases)),
                "errors": str(sum(each.status == "error" for each in cases)),
                "time": f"{sum(each.wall for each in cases):.3f}",
            },
        )
        for outcome in cases:
            _add(suite, outcome, file)
    ElementTree.indent(suites)
    return ElementTree.tostring(suites, encoding="unicode", xml_declaration=True)


def _add(suite: ElementTree.Element, outcome: Outcome, file: str) -> None:
    case = ElementTree.SubElement(
        suite,
        "testcase",
        {
            "classname": _in_xml(outcome.scenario),
            "name": _in_xml(outcome.id),
            "file": _in_xml(file),
            "time": f"{outcome.wall:.3f}",
        },
    )
    # Random parameters are not in the name.
    values = {**outcome.parameters, "seed": outcome.seed}
    properties = ElementTree.SubElement(case, "properties")
    for name, value in values.items():
        ElementTree.SubElement(
            properties, "property", {"name": _in_xml(name), "value": _in_xml(str(value))}
        )
    if outcome.status == "passed":
        return
    first = outcome.findings[0] if outcome.findings else None
    message = "" if first is None else (first.actual if first.kind == "error" else first.expected)
    tag = "error" if outcome.status == "error" else "failure"
    failure = ElementTree.SubElement(case, tag, {"message": _in_xml(message)})
    failure.text = _in_xml("\n".join(each.text for each in outcome.findings))
    said = [*outcome.diagnostics, outcome.output]
    said += [f"recording: {outcome.recording}"] if outcome.recording else []
    said += [f"picture: {outcome.picture}"] if outcome.picture else []
    output = ElementTree.SubElement(case, "system-out")
    output.text = _in_xml("\n".join(filter(None, said)))


def _in_xml(text: str) -> str:
    return _NOT_XML.sub("\N{REPLACEMENT CHARACTER}", text)
