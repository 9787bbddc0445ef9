"""Plugins that move nothing and that Gazebo refuses."""

from __future__ import annotations

from collections.abc import Collection, Iterator

from cartwheel.codes import running
from cartwheel.corpus.faults import Fault, coded
from cartwheel.corpus.movers import LEFT_OUT
from cartwheel.corpus.verdict import Verdict
from cartwheel.dialects.catalogue import short_name


def bodiless(verdict: Verdict, movers: Collection[str]) -> Iterator[Fault]:
    """Plugins that publish nothing because the link on which they measure does not exist.

    Args:
        verdict: The measurements.
        movers: Names of plugins that are faults in any case.
    """
    said = verdict.diagnostics
    # The missing part may contain the link.
    sure = coded(said, LEFT_OUT) is None
    found = {
        short_name(str(each.values.get("plugin"))): each
        for each in reversed(said)
        if each.code is running.PLUGIN_LEFT_OUT
        and each.values.get("cause") == running.UNKNOWN_LINK.number
    }
    for name, reason in reversed(found.items()):
        if name not in movers:
            yield Fault(test="publish", subject=name, reason=reason, sure=sure)
