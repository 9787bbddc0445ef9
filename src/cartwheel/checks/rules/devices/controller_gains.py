"""PID gains of controllers."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks.controller_claims import (
    gains_missing,
    gains_zero,
    severity_in,
    used_controllers,
)
from cartwheel.checks.controller_files import Value
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import devices as devices_codes
from cartwheel.errors import Diagnostic

_GAINS = "{p: 100.0, i: 0.0, d: 1.0}"
_TUNED = "Tune the gains: p in N m/rad, d in N m s/rad."


@rule(devices_codes.CONTROLLER_GAINS_MISSING)
def controller_gains(subject: Subject) -> Iterator[Diagnostic]:
    for controller in used_controllers(subject):
        missing = gains_missing(controller)
        zero = [] if missing else gains_zero(controller)
        if zero:
            names = [value.text.strip() for value in zero]
            yield devices_codes.CONTROLLER_GAINS_MISSING.diagnostic(
                severity="warning",
                message=f'the gains of controller "{controller.name}" for {", ".join(names)} are '
                "all 0, so the controller does not move "
                + ("the joint" if len(names) == 1 else "these joints"),
                values={"controller": controller.name, "joints": tuple(names), "missing": ""},
                origin=zero[0].origin,
                mark=zero[0].text,
                hint=_TUNED,
            )
        if not missing:
            continue
        ros2 = controller.file.is_ros2
        names = [joint for joint, _, _ in missing]
        path = missing[0][2]
        under, top, text = f"{path}/p", path.partition("/")[0], ""
        if names == [""]:
            text = f"{path}: {_GAINS}"
        elif path == f"{top}/{names[0]}":
            inner = ", ".join(f"{name}: {_GAINS}" for name in names)
            text = f"{top}: {{{inner}}}"
        whole = bool(text) and not controller.has(top)
        of = "" if names == [""] else f" for {', '.join(names)}"
        yield devices_codes.CONTROLLER_GAINS_MISSING.diagnostic(
            severity="warning" if ros2 else severity_in(controller.file),
            message=f'controller "{controller.name}" has no gains{of} ({under} is missing), so '
            + ("its joints do not move" if ros2 else "it does not start"),
            values={
                "controller": controller.name,
                "joints": tuple(value.text.strip() for _, value, _ in missing),
                "missing": under,
            },
            origin=controller.type.origin if whole else missing[0][1].origin,
            instead=text if whole else f"{under.rpartition('/')[2]}: 100.0",
            place="after" if whole and _has_own_line(controller.type) else "",
            mark="" if whole else missing[0][1].text,
            hint=_TUNED if whole else f"Add the gains to {under.rpartition('/')[0]}. {_TUNED}",
        )


def _has_own_line(value: Value) -> bool:
    """Whether a line can be inserted below the value; not possible within ``{braces}``."""
    line = value.file.lines[value.node.start_mark.line]
    return "{" not in line
