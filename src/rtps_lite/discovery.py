"""Discovery data of participants and endpoints."""

from __future__ import annotations

import math
import struct
from collections.abc import Iterable
from dataclasses import dataclass

from rtps_lite import wire
from rtps_lite.wire import VENDOR, VERSION, Guid, MalformedError, Prefix

PARTICIPANT = b"\x00\x00\x01\xc1"
SPDP_WRITER, SPDP_READER = b"\x00\x01\x00\xc2", b"\x00\x01\x00\xc7"
PUBLICATIONS_WRITER, PUBLICATIONS_READER = b"\x00\x00\x03\xc2", b"\x00\x00\x03\xc7"
SUBSCRIPTIONS_WRITER, SUBSCRIPTIONS_READER = b"\x00\x00\x04\xc2", b"\x00\x00\x04\xc7"
ENDPOINTS = 0x3F
"""Built-in endpoints: announcer and detector of participants, publications and subscriptions."""

_SENTINEL, _LEASE, _TOPIC, _TYPE = 0x01, 0x02, 0x05, 0x07
_DOMAIN, _VERSION, _VENDOR, _RELIABILITY, _LIVELINESS = 0x0F, 0x15, 0x16, 0x1A, 0x1B
_DEADLINE, _LIFESPAN = 0x23, 0x2B
_DURABILITY, _USER_DATA, _USER_LOCATOR, _META_LOCATOR = 0x1D, 0x2C, 0x31, 0x32
_ENDPOINT_LOCATOR, _HISTORY, _PARTICIPANT_GUID, _ENDPOINTS = 0x2F, 0x40, 0x50, 0x58
_ENDPOINT_GUID, _ENTITY_NAME, _KEY_HASH, _STATUS, _REPRESENTATION = 0x5A, 0x62, 0x70, 0x71, 0x73
RELATED, RELATED_FASTDDS = 0x0083, 0x800F
"""Identity of the request that a sample answers: parameters of the standard and of Fast DDS."""
_LONGEST_NAME = 1024
"""Maximum length in bytes of a topic or type name. Fast DDS allows 255."""
_LONGEST_DATA = 1024
"""Maximum length in bytes of an endpoint's user data. ROS uses about 200."""
LONGEST_LEASE = 100.0
"""Maximum lease duration in s, which also limits longer values from peers. Peers announce
themselves every 3 to 30 s. Source: DDSI-RTPS's default."""
_FOREVER_SECONDS = 0x7FFFFFFF
_FOREVER = struct.pack("<iI", _FOREVER_SECONDS, 0xFFFFFFFF)
_UDP4 = 1

Address = tuple[str, int]


@dataclass(frozen=True, kw_only=True, slots=True)
class EndpointQos:
    """QoS that an endpoint offers or requests."""

    reliable: bool = True
    transient_local: bool = False
    depth: int = 10
    """Number of samples kept per writer."""
    deadline: float = math.inf
    """Maximum interval between two samples in s."""
    liveliness: int = 0
    """Liveliness kind of a writer: 0 is automatic, by its participant."""
    lease: float = math.inf
    """Liveliness lease in s, after which a writer counts as gone."""
    lifespan: float = math.inf
    """Time in s after which a sample expires."""

    def misfit(self, asked: EndpointQos) -> str:
        """The policy in which a reader requests more than this offer; empty if compatible."""
        asks_for_more = {
            "RELIABILITY": asked.reliable and not self.reliable,
            "DURABILITY": asked.transient_local and not self.transient_local,
            "DEADLINE": self.deadline > asked.deadline,
            "LIVELINESS": self.liveliness < asked.liveliness or self.lease > asked.lease,
        }
        return next((policy for policy, more in asks_for_more.items() if more), "")


@dataclass(frozen=True, kw_only=True, slots=True)
class Endpoint:
    """A writer or reader."""

    guid: Guid
    topic: str
    type: str
    qos: EndpointQos
    user_data: bytes = b""
    locators: tuple[Address, ...] = ()
    """Addresses of the endpoint; empty if it uses those of the participant."""

    @property
    def is_writer(self) -> bool:
        """Whether the endpoint is a writer, according to the lower bits of its last byte."""
        return self.guid[15] & 0x3F in (0x02, 0x03)


@dataclass(frozen=True, kw_only=True, slots=True)
class ParticipantData:
    """Discovery data of a participant."""

    prefix: Prefix
    meta: tuple[Address, ...]
    """Addresses for discovery traffic."""
    user: tuple[Address, ...]
    lease: float = 20.0
    """Lease duration in s, after which the participant counts as gone."""
    vendor: bytes = VENDOR
    name: str = ""
    user_data: bytes = b""


# -- writing


def encode_participant(data: ParticipantData, *, domain: int) -> bytes:
    """Encodes a participant for SPDP."""
    return _list(
        (_VERSION, VERSION + b"\0\0"),
        (_VENDOR, data.vendor + b"\0\0"),
        (_PARTICIPANT_GUID, data.prefix + PARTICIPANT),
        (_DOMAIN, struct.pack("<I", domain)),
        *((_META_LOCATOR, _locator(address)) for address in data.meta),
        *((_USER_LOCATOR, _locator(address)) for address in data.user),
        (_LEASE, _seconds(data.lease)),
        (_ENDPOINTS, struct.pack("<I", ENDPOINTS)),
        (_ENTITY_NAME, _string(data.name)),
        (_USER_DATA, _octets(data.user_data)),
    )


def encode_endpoint(data: Endpoint) -> bytes:
    """Encodes a writer or reader for SEDP."""
    qos = data.qos
    # RTPS encodes reliability as 1 or 2, followed by a blocking time, which is never used.
    reliability = struct.pack("<IiI", 2 if qos.reliable else 1, 0, 0x19999999)
    lifespan = () if math.isinf(qos.lifespan) else ((_LIFESPAN, _seconds(qos.lifespan)),)
    return _list(
        (_ENDPOINT_GUID, data.guid),
        (_PARTICIPANT_GUID, data.guid[:12] + PARTICIPANT),
        (_VERSION, VERSION + b"\0\0"),
        (_VENDOR, VENDOR + b"\0\0"),
        (_TOPIC, _string(data.topic)),
        (_TYPE, _string(data.type)),
        (_RELIABILITY, reliability),
        (_DURABILITY, struct.pack("<I", int(qos.transient_local))),
        (_HISTORY, struct.pack("<II", 0, qos.depth)),
        (_LIVELINESS, struct.pack("<I", 0) + _FOREVER),
        *lifespan,
        (_REPRESENTATION, struct.pack("<IhH", 1, 0, 0)),
        (_USER_DATA, _octets(data.user_data)),
    )


def encode_key(guid: Guid, *, participant: bool = False) -> bytes:
    """Encodes the key of a disposed participant or endpoint."""
    return _list((_PARTICIPANT_GUID if participant else _ENDPOINT_GUID, guid))


def disposed(guid: Guid) -> bytes:
    """Inline parameters that mark a participant or endpoint as disposed."""
    return inline((_KEY_HASH, guid), (_STATUS, b"\0\0\0\x03"))


def inline(*pairs: tuple[int, bytes]) -> bytes:
    """Encodes parameters in front of a payload."""
    return _parameters(pairs)


def related(guid: Guid, number: int) -> bytes:
    """Inline parameters that identify the request that a sample answers."""
    identity = guid + struct.pack("<iI", number >> 32, number & 0xFFFFFFFF)
    return inline((RELATED, identity), (RELATED_FASTDDS, identity))


def _list(*pairs: tuple[int, bytes]) -> bytes:
    return b"\x00\x03\x00\x00" + _parameters(pairs)


def _parameters(pairs: Iterable[tuple[int, bytes]]) -> bytes:
    parts = []
    for name, value in pairs:
        padded = value + b"\0" * (-len(value) % 4)
        parts.append(struct.pack("<HH", name, len(padded)) + padded)
    return b"".join((*parts, struct.pack("<HH", _SENTINEL, 0)))


def _string(text: str) -> bytes:
    data = text.encode() + b"\0"
    return struct.pack("<I", len(data)) + data


def _seconds(value: float) -> bytes:
    whole = int(value)
    return struct.pack("<iI", whole, int((value - whole) * 2**32))


def _octets(data: bytes) -> bytes:
    return struct.pack("<I", len(data)) + data


def _locator(address: Address) -> bytes:
    host, port = address
    return struct.pack("<II", _UDP4, port) + bytes(12) + bytes(map(int, host.split(".")))


# -- reading


def is_disposal(parameters: dict[int, bytes]) -> bool:
    """Whether a sample's inline parameters mark its subject as disposed."""
    return bool(parameters.get(_STATUS, b"\0\0\0\0")[3:4] > b"\0")


def key_of(parameters: dict[int, bytes], payload: bytes) -> Guid | None:
    """GUID of the disposed participant or endpoint."""
    if len(parameters.get(_KEY_HASH, b"")) >= 16:
        return parameters[_KEY_HASH][:16]
    found = _decode(payload) if payload else {}
    for name in (_ENDPOINT_GUID, _PARTICIPANT_GUID):
        if found.get(name):
            return found[name][0][:16]
    return None


def decode_participant(payload: bytes) -> ParticipantData:
    """Decodes a participant from SPDP.

    Raises:
        MalformedError: The data is invalid.
    """
    found = _decode(payload)
    order = _order(payload)
    guid = _first(found, _PARTICIPANT_GUID, 16)
    lease = _duration(found[_LEASE][0], order) if _LEASE in found else LONGEST_LEASE
    return ParticipantData(
        prefix=guid[:12],
        meta=_locators(found.get(_META_LOCATOR, []), order),
        user=_locators(found.get(_USER_LOCATOR, []), order),
        lease=min(max(1.0, lease), LONGEST_LEASE),
        vendor=found.get(_VENDOR, [b"\0\0"])[0][:2],
    )


def domain_of(payload: bytes) -> int | None:
    """Domain in a participant's announcement, or None."""
    value = _decode(payload).get(_DOMAIN, [b""])[0]
    return struct.unpack_from(f"{_order(payload)}I", value)[0] if len(value) >= 4 else None


def decode_endpoint(payload: bytes, *, writer: bool) -> Endpoint:
    """Decodes a writer or reader from SEDP. They have different default reliabilities.

    Raises:
        MalformedError: The data is invalid.
    """
    found = _decode(payload)
    order = _order(payload)
    try:
        kinds = [
            struct.unpack_from(f"{order}I", found[name][0])[0] if name in found else default
            for name, default in (
                (_RELIABILITY, 2 if writer else 1),
                (_DURABILITY, 0),
                (_LIVELINESS, 0),
            )
        ]
        liveliness = found.get(_LIVELINESS, [b""])[0]
        topic, type_ = (_text(_first(found, name, 5), order) for name in (_TOPIC, _TYPE))
        guid = _first(found, _ENDPOINT_GUID, 16)
    except (struct.error, UnicodeDecodeError) as error:
        raise MalformedError(str(error)) from None
    user_data = found.get(_USER_DATA, [b"\0\0\0\0"])[0]
    length = int.from_bytes(user_data[:4], "little" if order == "<" else "big")
    return Endpoint(
        guid=guid,
        topic=topic,
        type=type_,
        qos=EndpointQos(
            reliable=kinds[0] >= 2,
            transient_local=kinds[1] >= 1,
            deadline=_duration(found.get(_DEADLINE, [b""])[0], order),
            liveliness=kinds[2],
            lease=_duration(liveliness[4:], order),
            lifespan=_duration(found.get(_LIFESPAN, [b""])[0], order),
        ),
        user_data=user_data[4 : 4 + min(length, _LONGEST_DATA)],
        locators=_locators(found.get(_ENDPOINT_LOCATOR, []), order),
    )


def _order(payload: bytes) -> str:
    return "<" if payload[1:2] == b"\x03" else ">"


def _decode(payload: bytes) -> dict[int, list[bytes]]:
    if payload[:2] not in (b"\x00\x03", b"\x00\x02"):
        raise MalformedError("expected a parameter list")
    order, at = _order(payload), 4
    found: dict[int, list[bytes]] = {}
    while at + 4 <= len(payload):
        name, length = struct.unpack_from(f"{order}HH", payload, at)
        at += 4
        if name == _SENTINEL:
            break
        if at + length > len(payload):
            raise MalformedError("a parameter is truncated")
        found.setdefault(name & 0x3FFF if name < 0x8000 else name, []).append(
            payload[at : at + length]
        )
        at += length
    return found


def _first(found: dict[int, list[bytes]], name: int, length: int) -> bytes:
    if name not in found or len(found[name][0]) < length:
        raise MalformedError(f"parameter {name:#x} is missing")
    value = found[name][0]
    return value[:16] if name in (_ENDPOINT_GUID, _PARTICIPANT_GUID) else value


def _duration(value: bytes, order: str) -> float:
    """Duration in s; infinite if unspecified."""
    if len(value) < 8:
        return math.inf
    seconds, fraction = struct.unpack_from(f"{order}iI", value)
    return math.inf if seconds >= _FOREVER_SECONDS else seconds + fraction / 2**32


def _text(value: bytes, order: str) -> str:
    (length,) = struct.unpack_from(f"{order}I", value)
    if length > min(_LONGEST_NAME, len(value) - 4):
        raise MalformedError("a string extends past its message or exceeds the maximum length")
    return value[4 : 4 + max(0, length - 1)].decode()


def _locators(values: Iterable[bytes], order: str) -> tuple[Address, ...]:
    found = []
    for value in values:
        if len(value) < 24:
            continue
        kind, port = struct.unpack_from(f"{order}iI", value)
        if kind == _UDP4 and 0 < port < 65536:
            found.append((".".join(map(str, value[20:24])), port))
    return tuple(found[:8])


def announcement(data: ParticipantData, *, domain: int) -> bytes:
    """The message that announces a participant."""
    payload = encode_participant(data, domain=domain)
    head = wire.data_head(
        reader=wire.UNKNOWN, writer=SPDP_WRITER, number=1, inline=b"", size=len(payload)
    )
    return wire.message(data.prefix, head, payload)


def farewell(prefix: Prefix) -> bytes:
    """The message that announces the end of a participant."""
    payload = encode_key(prefix + PARTICIPANT, participant=True)
    head = wire.data_head(
        reader=SPDP_READER,
        writer=SPDP_WRITER,
        # Announcements repeat number 1.
        number=2,
        inline=disposed(prefix + PARTICIPANT),
        size=len(payload),
        keyed=True,
    )
    return wire.message(prefix, head, payload)
