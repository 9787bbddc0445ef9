"""XML-RPC's values from text that anyone may have sent."""

from __future__ import annotations

import xmlrpc.client
from typing import Any
from xml.parsers import expat

DEPTH = 64
"""Elements within each other; a request of ROS has some ten."""


class MalformedError(ValueError):
    """Text that is no XML-RPC."""


def read_values(body: bytes) -> tuple[tuple[Any, ...], str | None]:
    """The values of a request or an answer, and the method of a request.

    Unlike `xmlrpc.client.loads`, this refuses entities, which can make little text long, and
    deep nesting.

    Raises:
        xmlrpc.client.Fault: It is the answer of a call that failed.
        MalformedError: It is no XML-RPC.
    """
    made = xmlrpc.client.Unmarshaller()
    made.xml("", None)  # Text comes decoded.
    parser = expat.ParserCreate()
    depth = 0

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if depth > DEPTH:
            raise MalformedError(f"elements are nested more than {DEPTH} deep")
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
        # Whatever the parsers meet: each type of value has errors of its own.
        raise MalformedError(f"{type(error).__name__}: {str(error)[:200]}") from error
    finally:
        # It refers to the functions, and they to it.
        parser.StartElementHandler = parser.EndElementHandler = None
        parser.CharacterDataHandler = parser.StartDoctypeDeclHandler = None
