"""Access rules: host names of this server, origins of web pages, and the token."""

from __future__ import annotations

import ipaddress
import re
import socket
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from urllib.parse import parse_qsl, urlencode

from cartwheel.codes.wires import ADDRESS_UNAVAILABLE, ORIGIN_INVALID, PAGE_REFUSED
from cartwheel.errors import ControlError, Diagnostic
from cartwheel.gate.listening import is_loopback, resolve
from cartwheel.options import ALLOW_ORIGIN, HOST

PARAMETER = "token"
"""Query parameter that contains the token."""
_AUTHORITY = re.compile(r"(?P<name>[a-z0-9._-]+|\[[0-9a-f:.]+\])(?::(?P<port>\d{1,5}))?")
_ORIGIN = re.compile(r"(?P<scheme>[a-z][a-z0-9+.-]*)://(?P<authority>[^/?#@\s]*)/?")
_PORTS = {"http": "80", "https": "443"}
_ANY = {"": "127.0.0.1", "0.0.0.0": "127.0.0.1", "::": "::1"}  # noqa: S104
"""Wildcard addresses, and the loopback address that reaches each of them."""
EMBED = "frame"
"""Query parameter that contains the key with which other pages may show this one in a frame."""
_TOKEN_BYTES = 24
_NOBODY = ("null", "")
"""Origins that do not identify a site."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Asked:
    """The parts of a request that the rules examine."""

    target: str
    """Path and query."""
    host: str
    origin: str | None
    """Origin of the requesting web page. None if the request has no such header."""
    cookies: str = ""


@dataclass(frozen=True, kw_only=True, slots=True)
class Refusal:
    """Why a request is refused."""

    status: int
    """HTTP status."""
    text: str
    """Response body for the client."""
    origin: str | None = None
    """Origin of the web page, if the origin is the reason."""


class _Key:
    """A random key, generated when it is first used."""

    def __init__(self) -> None:
        self.value: str | None = None

    def get(self) -> str:
        if self.value is None:
            self.value = _new_token()
        return self.value


@dataclass(frozen=True, kw_only=True, slots=True)
class Access:
    """Access rules of a run, which the web viewer and Foxglove share.

    On a loopback address, any user of this computer may connect. On other addresses, clients
    also need a token.
    """

    host: str
    """Host that the servers listen on, as the user specified it."""
    origins: tuple[str, ...] = ()
    """Origins of additional web pages that may connect."""
    token: str | None = field(default=None, repr=False)
    _frame: _Key = field(default_factory=_Key, init=False, repr=False, compare=False)

    @classmethod
    def of(cls, host: str, origins: Sequence[str] = ()) -> Access:
        """Rules for an address, with a new token if other computers can reach the address.

        Raises:
            ControlError: `host` cannot be resolved, or one of `origins` is malformed.
        """
        try:
            _, (address, _) = resolve(host, 0)
        except (OSError, UnicodeError) as error:
            raise ControlError(
                f"{HOST.given(host)} cannot be used: {error}",
                code=ADDRESS_UNAVAILABLE,
                values={"host": host},
            ) from error
        return cls(
            host=host,
            origins=tuple(_normal_origin(origin) for origin in origins),
            token=None if is_loopback(address) else _new_token(),
        )

    @property
    def is_open(self) -> bool:
        """Whether other computers may connect."""
        return self.token is not None

    def url(self, scheme: str, port: int, *, elsewhere: bool = False) -> str:
        """URL of a server, with the token if one is required.

        Args:
            scheme: ``http`` or ``ws``.
            port: Port of the server.
            elsewhere: Whether the URL is for other computers instead of this one.
        """
        host = _ANY.get(self.host, self.host)
        if elsewhere and self.host in _ANY:
            host = socket.gethostname()
        if ":" in host and not host.startswith("["):
            host = f"[{host}]"
        query = "" if self.token is None else f"/?{urlencode({PARAMETER: self.token})}"
        return f"{scheme}://{host}:{port}{query}"

    def refusal(self, asked: Asked, *, apps: Iterable[str] = (), cookie: str) -> Refusal | None:
        """Why a request is refused; None if it is allowed.

        Args:
            asked: The request.
            apps: Origins of programs that may use this server, in addition to its own pages.
            cookie: Name of the cookie that contains the token.
        """
        host = asked.host.lower()
        if not self._knows(host):
            return Refusal(
                status=403,
                text=f"This server does not accept the host name {asked.host}. To allow it: "
                f"{ALLOW_ORIGIN.given(f'http://{asked.host}')}",
            )
        origin = asked.origin
        if origin is not None and not self._admits(origin.lower(), host, apps):
            remedy = "" if origin in _NOBODY else f" To allow them: {ALLOW_ORIGIN.given(origin)}"
            return Refusal(
                status=403,
                text=f"Web pages from the origin {origin} may not connect.{remedy}",
                origin=origin,
            )
        if not self._has_token(asked, cookie):
            return Refusal(
                status=403,
                text="A token is required. Open the address that Cartwheel printed at startup, "
                f"which ends in ?{PARAMETER}=...",
            )
        return None

    def framed(self, url: str) -> str | None:
        """The URL of a page, for a frame in any other page that knows the result.

        None if a token is required, because browsers do not send its cookie from a frame.
        """
        return None if self.is_open else f"{url}/?{urlencode({EMBED: self._frame.get()})}"

    def may_be_framed(self, target: str) -> bool:
        """Whether the query of a request contains the key of `framed`."""
        key = self._frame.value
        return key is not None and any(_equal(value, key) for value in _values(target, EMBED))

    def has_token_in_query(self, target: str) -> bool:
        """Whether the query of a request contains the token."""
        if self.token is None:
            return False
        return any(_equal(value, self.token) for value in _values(target, PARAMETER))

    def _knows(self, host: str) -> bool:
        """Whether the host name belongs to this server. Prevents DNS rebinding."""
        match = _AUTHORITY.fullmatch(host)
        if match is None:
            return False
        name = match["name"]
        if name == "localhost" or is_loopback(name.strip("[]")):
            return True
        if name == self.host.lower() or host in (
            origin.partition("://")[2] for origin in self.origins
        ):
            return True
        # DNS cannot redirect a numeric address, so any numeric address is safe here.
        return self.is_open and (_is_address(name.strip("[]")) or name in _own_names())

    def _admits(self, origin: str, host: str, apps: Iterable[str]) -> bool:
        if origin in self.origins or origin in apps:
            return True
        # A page belongs to this server if its origin is the address in the request.
        return origin in (f"{scheme}://{host}" for scheme in _PORTS)

    def _has_token(self, asked: Asked, cookie: str) -> bool:
        if self.token is None or self.has_token_in_query(asked.target):
            return True
        pairs = (pair.strip().partition("=") for pair in asked.cookies.split(";"))
        return any(name == cookie and _equal(value, self.token) for name, _, value in pairs)


def refused_page(title: str, origin: str) -> Diagnostic:
    """Diagnostic for a web page that was refused.

    Args:
        title: Name of the server.
        origin: Origin of the page, safe to print.
    """
    hint = "" if origin in _NOBODY else f"To allow it: {ALLOW_ORIGIN.given(origin)}"
    message = f"{title} rejected a web page from the origin {origin or '(empty)'}"
    return PAGE_REFUSED.diagnostic(message, hint=hint, values={"server": title, "origin": origin})


def without_secrets(target: str) -> str:
    """Path and query of a request without token and key, for the server behind."""
    path, _, query = target.partition("?")
    kept = [pair for pair in _pairs(query) if pair[0] not in (PARAMETER, EMBED)]
    return f"{path}?{urlencode(kept)}" if kept else path


def _values(target: str, parameter: str) -> list[str]:
    """The values of a parameter in the query of a request."""
    query = target.partition("?")[2]
    return [value for name, value in _pairs(query) if name == parameter]


def _pairs(query: str) -> list[tuple[str, str]]:
    return parse_qsl(query, keep_blank_values=True)


def _new_token() -> str:
    # This import takes some ms, which a run on loopback saves. The same holds for hmac.
    import secrets

    return secrets.token_urlsafe(_TOKEN_BYTES)


def _equal(one: str, other: str) -> bool:
    import hmac

    return hmac.compare_digest(one.encode(errors="replace"), other.encode())


def _is_address(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True


def _own_names() -> set[str]:
    own = socket.gethostname().lower()
    short = own.partition(".")[0]
    return {own, short, f"{short}.local"}


def _normal_origin(text: str) -> str:
    """Origin in the form that browsers send.

    Raises:
        ControlError: The text is not an origin.
    """
    match = _ORIGIN.fullmatch(text.strip().lower())
    if match is None or bool(match["authority"]) == (match["scheme"] == "file"):
        raise ControlError(
            f'"{text}" is not a valid origin for {ALLOW_ORIGIN}',
            code=ORIGIN_INVALID,
            hint=(
                "Expected SCHEME://HOST or SCHEME://HOST:PORT, such as https://robots.example.org."
            ),
            values={"origin": text},
        )
    scheme, authority = match["scheme"], match["authority"]
    if scheme in _PORTS:
        authority = authority.removesuffix(f":{_PORTS[scheme]}")
    return f"{scheme}://{authority}"
