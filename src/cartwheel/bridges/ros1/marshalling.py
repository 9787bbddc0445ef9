"""Parsing of XML-RPC values, which may be malformed or malicious."""

from __future__ import annotations

import xmlrpc.client
from typing import Any
from xml.parsers import expat

DEPTH = 64
"""Maximum nesting depth of elements. ROS requests have about ten levels."""


class MalformedError(ValueError):
    """The text is not valid XML-RPC."""


def read_values(body: bytes) -> tuple[tuple[Any, ...], str | None]:
    """Values of a request or response, and the method name of a request.

    Unlike `xmlrpc.client.loads`, this rejects entities, which can expand a short text to a long
    text, and deep nesting.

    Raises:
        xmlrpc.client.Fault: The text is the response of a failed call.
        MalformedError: The text is not valid XML-RPC.
    """
    made = xmlrpc.client.Unmarshaller()
    made.xml("", None)  # The text is already decoded.
    parser = expat.ParserCreate()
    depth = 0

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if depth > DEPTH:
            raise MalformedError(f"elements are nested more than {DEPTH} levels deep")
        made.start(tag, attributes)

    def end(tag: str) -> None:
        nonlocal depth
        depth -= 1
        made.end(tag)

    def refuse(*_: object) -> None:
        raise MalformedError("a document type declaration is not allowed in XML-RPC")

    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.CharacterDataHandler = made.data
    parser.StartDoctypeDeclHandler = refuse
    try:
        parser.Parse(body, True)
        return tuple(made.close()), made.getmethodname()
    except (xmlrpc.client.Fault, MalformedError):
        raise
    except Exception as error:
        # Any error of the parsers: each value type raises different errors.
        raise MalformedError(f"{type(error).__name__}: {str(error)[:200]}") from error
    finally:
        # Break the reference cycle with the functions.
        parser.StartElementHandler = parser.EndElementHandler = None
        parser.CharacterDataHandler = parser.StartDoctypeDeclHandler = None
