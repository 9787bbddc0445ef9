"""Joints that several controllers command."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks.controller_claims import (
    Claim,
    claims,
)
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import devices as devices_codes
from cartwheel.errors import Diagnostic


@rule(devices_codes.JOINT_CLAIMED_TWICE)
def joint_claimed_twice(subject: Subject) -> Iterator[Diagnostic]:
    for _, file in subject.control:
        holders: dict[tuple[str, str], Claim] = {}
        reported: set[tuple[str, str]] = set()
        for controller in file.controllers:
            for claim in claims(controller):
                first = holders.setdefault((claim.joint, claim.interface), claim)
                both = (first.controller.name, controller.name)
                # Different types are alternatives, such as a trajectory and a position controller.
                alike = first.controller.kind == controller.kind
                if first.controller is controller or not alike or both in reported:
                    continue
                reported.add(both)
                yield devices_codes.JOINT_CLAIMED_TWICE.diagnostic(
                    message=f'the controllers "{both[0]}" and "{both[1]}" both command the '
                    f'{claim.interface} of joint "{claim.joint}"',
                    values={
                        "controller": both[1],
                        "other": both[0],
                        "joint": claim.joint,
                        "interface": claim.interface,
                    },
                    origin=claim.value.origin,
                    mark=claim.value.text,
                    hint=f'They cannot run at the same time. "{both[0]}" is defined at '
                    f"{first.value.origin}.",
                )
