"""Who may connect: names of this server, origins of web pages, and the token."""

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

PARAMETER = "token"
"""Of the query of an address, where a token is needed."""
_AUTHORITY = re.compile(r"(?P<name>[a-z0-9._-]+|\[[0-9a-f:.]+\])(?::(?P<port>\d{1,5}))?")
_ORIGIN = re.compile(r"(?P<scheme>[a-z][a-z0-9+.-]*)://(?P<authority>[^/?#@\s]*)/?")
_PORTS = {"http": "80", "https": "443"}
_ANY = {"": "127.0.0.1", "0.0.0.0": "127.0.0.1", "::": "::1"}  # noqa: S104
"""All addresses of this computer, and the one that it reaches itself by."""
_TOKEN_BYTES = 24
_NOBODY = ("null", "")
"""Origins that name no site."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Asked:
    """What a request says of itself."""

    target: str
    """Path and query."""
    host: str
    origin: str | None
    """Of the web page that asks; None where no browser says one."""
    cookies: str = ""


@dataclass(frozen=True, kw_only=True, slots=True)
class Refusal:
    """Why a request is not let through."""

    status: int
    """Of HTTP."""
    text: str
    """For whoever asked."""
    origin: str | None = None
    """The web page's, where that was the reason."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Access:
    """The rules of a run, the same for its page and for Foxglove.

    On a loopback address whoever has an account on this computer may connect. On others a token
    is needed as well.
    """

    host: str
    """That the servers listen on, as the user wrote it."""
    origins: tuple[str, ...] = ()
    """Of web pages that may connect beside the server's own."""
    token: str | None = field(default=None, repr=False)

    @classmethod
    def of(cls, host: str, origins: Sequence[str] = ()) -> Access:
        """The rules for an address; with a new token where other computers reach it.

        Raises:
            ControlError: `host` is unknown, or one of `origins` is malformed.
        """
        try:
            _, (address, _) = resolve(host, 0)
        except (OSError, UnicodeError) as error:
            raise ControlError(
                f"--host {host} cannot be used: {error}",
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
        """The address of a server, with the token where one is needed.

        Args:
            scheme: http or ws.
            port: That the server listens on.
            elsewhere: As other computers know it; else as this one does.
        """
        host = _ANY.get(self.host, self.host)
        if elsewhere and self.host in _ANY:
            host = socket.gethostname()
        if ":" in host and not host.startswith("["):
            host = f"[{host}]"
        query = "" if self.token is None else f"/?{urlencode({PARAMETER: self.token})}"
        return f"{scheme}://{host}:{port}{query}"

    def refusal(self, asked: Asked, *, apps: Iterable[str] = (), cookie: str) -> Refusal | None:
        """Why a request is refused; None where it is let through.

        Args:
            asked: The request.
            apps: Origins of programs that may use this server beside its own pages.
            cookie: Name of the cookie that holds the token.
        """
        host = asked.host.lower()
        if not self._knows(host):
            return Refusal(
                status=403,
                text=f"This server does not accept the host name {asked.host}. To allow it: "
                f"--allow-origin http://{asked.host}",
            )
        origin = asked.origin
        if origin is not None and not self._admits(origin.lower(), host, apps):
            remedy = "" if origin in _NOBODY else f" To allow them: --allow-origin {origin}"
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

    def has_token_in_query(self, target: str) -> bool:
        """Whether a request brings the token in its address."""
        if self.token is None:
            return False
        return any(_equal(value, self.token) for value in _tokens(target))

    def _knows(self, host: str) -> bool:
        """Against DNS rebinding: a foreign name that is made to stand for our address."""
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
        # No name server can make an address stand for another one, so any will do there.
        return self.is_open and (_is_address(name.strip("[]")) or name in _own_names())

    def _admits(self, origin: str, host: str, apps: Iterable[str]) -> bool:
        if origin in self.origins or origin in apps:
            return True
        # The page is the server's own where it came from the very address that is asked now.
        return origin in (f"{scheme}://{host}" for scheme in _PORTS)

    def _has_token(self, asked: Asked, cookie: str) -> bool:
        if self.token is None or self.has_token_in_query(asked.target):
            return True
        pairs = (pair.strip().partition("=") for pair in asked.cookies.split(";"))
        return any(name == cookie and _equal(value, self.token) for name, _, value in pairs)


def refused_page(title: str, origin: str) -> Diagnostic:
    """What the user should know of a web page that was refused.

    Args:
        title: Of the server.
        origin: The page's, safe to print.
    """
    hint = "" if origin in _NOBODY else f"To allow it: --allow-origin {origin}"
    message = f"{title} rejected a web page from the origin {origin or '(empty)'}"
    return PAGE_REFUSED.diagnostic(message, hint=hint, values={"server": title, "origin": origin})


def without_token(target: str) -> str:
    """A request's path and query as the server behind sees it."""
    path, _, query = target.partition("?")
    kept = [(name, value) for name, value in _pairs(query) if name != PARAMETER]
    return f"{path}?{urlencode(kept)}" if kept else path


def _tokens(target: str) -> list[str]:
    query = target.partition("?")[2]
    return [value for name, value in _pairs(query) if name == PARAMETER]


def _pairs(query: str) -> list[tuple[str, str]]:
    return parse_qsl(query, keep_blank_values=True)


def _new_token() -> str:
    # Some ms that a run on loopback does not spend; so is the next.
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
    """An origin as browsers write it.

    Raises:
        ControlError: It is not one.
    """
    match = _ORIGIN.fullmatch(text.strip().lower())
    if match is None or bool(match["authority"]) == (match["scheme"] == "file"):
        raise ControlError(
            f'"{text}" is not an origin for --allow-origin',
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
