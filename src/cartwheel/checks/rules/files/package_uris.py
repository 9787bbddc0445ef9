"""URIs that Gazebo Classic does not know."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from cartwheel.checks import nodes
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import files as files_codes
from cartwheel.errors import DescriptionError, Diagnostic

_SCHEME = "package://"
_GZ = re.compile(r"(?<![a-z])(?:lib)?(?:gz|ign(?:ition)?)[-_](?:sim|gazebo|ros)", re.IGNORECASE)
"""Names of plugins of newer versions of Gazebo, which accept any scheme."""
_CLASSIC = re.compile(r"libgazebo_")
_MODEL = ("model.config", "model.sdf")


@rule(files_codes.PACKAGE_URI_IN_SDF)
def package_uri_in_sdf(subject: Subject) -> Iterator[Diagnostic]:
    if subject.is_urdf:
        return
    # A plugin of any model in the file shows for which Gazebo it is.
    plugins = [node for node in nodes.walk(subject.root) if node.tag == "plugin"]
    names = [nodes.text_of(node, "filename") for node in plugins]
    if any(_GZ.search(name) for name in names):
        return
    found = [
        node
        for node in nodes.walk(subject.root)
        if node.tag == "uri" and node.text.strip().startswith(_SCHEME)
    ]
    if not found:
        return
    first, *more = found
    uri = first.text.strip()
    lines = sorted({each.origin.line for each in more} - {first.origin.line})
    also = f" It has {len(more)} more such URIs, the last in line {lines[-1]}." if lines else ""
    yield files_codes.PACKAGE_URI_IN_SDF.diagnostic(
        f'Gazebo Classic does not find "{uri}": in SDF, it knows model:// and file://, but not '
        f"{_SCHEME}",
        severity="warning" if any(map(_CLASSIC.search, names)) else "info",
        origin=first.origin,
        values={"name": uri, "places": len(found)},
        hint=f"Write {_model_uri(subject, uri)}.{also}",
        mark=uri,
    )


def _model_uri(subject: Subject, uri: str) -> str:
    """The URI of a file by the folder of its model."""
    plain = "model://" + uri.removeprefix(_SCHEME)
    try:
        path = subject.packages.resolve(uri, subject.root.origin)
    except DescriptionError:
        return plain
    above = next((each for each in path.parents if _is_model(each)), None)
    return plain if above is None else f"model://{above.name}/{path.relative_to(above).as_posix()}"


def _is_model(folder: Path) -> bool:
    return any((folder / name).is_file() for name in _MODEL)
