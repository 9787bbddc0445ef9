"""A program that sweeps, for tests that end it. Prints the table of each sweep."""

from __future__ import annotations

import json
import sys

from tests.sweeps import duties

import cartwheel as cw

if __name__ == "__main__":
    plan = json.loads(sys.argv[1])
    built = cw.build("empty", plan["robots"])
    for each in plan["sweeps"]:
        function = getattr(duties, each.pop("function"))
        table = cw.sweep(function, each.pop("cases"), built, **each)
        print(json.dumps(table.columns()), flush=True)
