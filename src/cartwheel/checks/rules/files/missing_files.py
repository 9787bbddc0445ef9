"""Meshes, textures and models that do not exist."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from cartwheel.checks import nodes, spelling
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import ABSENT, Subject
from cartwheel.codes import files as files_codes
from cartwheel.description.elements.node import Node
from cartwheel.errors import DescriptionError, Diagnostic

_PACKAGE = re.compile(r"(?:package://|model://|\$\(find )([\w.-]+)")
_SHOWN = 3


@rule(files_codes.FILE_MISSING)
def file_missing(subject: Subject) -> Iterator[Diagnostic]:
    absences: dict[tuple[object, ...], dict[str, Diagnostic]] = {}
    for each in _absent(subject):
        values = each.values
        several = absences.setdefault((each.code, values.get("kind"), values.get("name")), {})
        several.setdefault(str(each.origin), each)
    for found in absences.values():
        first, *more = found.values()
        if not more:
            yield first
            continue
        places = ", ".join(str(each.origin) for each in more[:_SHOWN])
        places += ", …" if len(more) > _SHOWN else ""
        yield replace(
            first,
            message=f"{_cause(first)}; it is used in {len(more) + 1} places",
            values={**first.values, "places": len(more) + 1},
            hint=f"{first.hint.strip()} Also at {places}.".strip(),
        )


def _cause(absence: Diagnostic) -> str:
    kind, name = absence.values.get("kind"), absence.values.get("name")
    if absence.code is files_codes.FILE_ON_NETWORK:
        return f'"{name}" is on the network'
    if absence.code is not files_codes.FILE_MISSING:
        return absence.message
    return f'the {kind} "{name}" ' + (
        "was not found" if kind in ("model", "package") else "does not exist"
    )


def _absent(subject: Subject) -> Iterator[Diagnostic]:
    yield from (each for each in subject.failures if each.code in ABSENT)
    for diagnostic in subject.read.diagnostics if subject.read is not None else ():
        if diagnostic.code in ABSENT and subject.in_sdf(diagnostic.origin):
            yield _of_sdf(subject, diagnostic)
    if not subject.is_urdf:
        return
    for node in nodes.walk(subject.root):
        uri = nodes.text_of(node, "filename")
        if node.tag not in ("mesh", "texture") or not uri:
            continue
        try:
            subject.packages.resolve(uri, node.origin, what=node.tag)
        except DescriptionError as error:
            meant = _meant(subject, uri, node, str(error.values.get("meant", "")))
            yield replace(
                error.diagnostic("error" if node.tag == "mesh" else "warning"),
                origin=node.origin,
                instead=f'filename="{meant}"' if meant else "",
                place="attribute" if meant else "",
                mark=uri,
            )


def _of_sdf(subject: Subject, diagnostic: Diagnostic) -> Diagnostic:
    """A reader's diagnostic for a missing file, with the corrected URI."""
    node = subject.node_at(diagnostic.origin)
    uri = nodes.child(node, "uri") or (node if node and node.tag == "uri" else None)
    near = str(diagnostic.values.get("meant", ""))
    meant = _meant(subject, uri.text.strip(), uri, near) if uri is not None else ""
    severity = diagnostic.severity
    if diagnostic.code is files_codes.FILE_ON_NETWORK:
        severity = "info"  # Gazebo downloads the file.
    elif diagnostic.values.get("kind") == "model":
        severity = "warning"
    return replace(
        diagnostic,
        severity=severity,
        origin=uri.origin if uri is not None and meant else diagnostic.origin,
        instead=nodes.written("uri", {}, meant) if meant else "",
        place="element" if meant else "",
        mark=nodes.text_of(node, "filename") if node is not None else "",
    )


def _meant(subject: Subject, uri: str, node: Node, near: str) -> str:
    """The URI with the likely package or file name, if that file exists."""
    if not near:
        return ""
    package, name = _PACKAGE.match(uri), Path(uri).name
    tries = [uri.removesuffix(name) + near] if spelling.meant(name, [near]) else []
    if package is not None:
        tries.append(uri[: package.start(1)] + near + uri[package.end(1) :])
    for each in tries:
        try:
            subject.packages.resolve(each, node.origin, folder=True)
        except DescriptionError:
            continue
        return each
    return ""
