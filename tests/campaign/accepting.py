"""Counts inputs that targets accept: ``python -m tests.campaign.accepting FOLDER N TARGET...``.

The inputs are a target's seeds, or N mutations of them. Each target reads them in a process
of its own, as in a campaign: the types of messages that inputs define stay known in it.

The last line printed is a JSON object: for each target, the number of seeds, the number of accepted
inputs and the number of all inputs. The last two are null if the process failed.
"""

from __future__ import annotations

import contextlib
import json
import os
import sys
import traceback
from pathlib import Path
from random import Random

from tests.campaign import registry
from tests.campaign.target import Target


def main(folder: str, mutations: int, *names: str) -> None:
    # Loading and making seeds import much, once for all of them.
    targets = [registry.load(name) for name in names]
    seeds = [target.seeds() for target in targets]
    found = {}
    for target, given in zip(targets, seeds, strict=True):
        room = Path(folder, target.name)
        room.mkdir()
        found[target.name] = (len(given), *_apart(target, given, room, mutations))
    print(json.dumps(found))


def _apart(
    target: Target, seeds: list[bytes], room: Path, mutations: int
) -> tuple[int | None, int | None]:
    """The number of accepted inputs and of all inputs, counted in a fork."""
    result = room.with_suffix(".json")
    child = os.fork()
    if child == 0:
        try:
            os.chdir(room)
            inputs = [
                target.mutate(seeds[number % len(seeds)], seeds, Random(number))
                for number in range(mutations)
            ]
            accepted = 0
            for each in inputs or seeds:
                with contextlib.suppress(*target.allowed):
                    target.run_one(each)
                    accepted += 1
            result.write_text(json.dumps([accepted, len(inputs or seeds)]))
        except BaseException:  # noqa: BLE001 - whatever it was, this process must not go on
            traceback.print_exc()
        finally:
            os._exit(0)
    os.waitpid(child, 0)
    accepted, tried = json.loads(result.read_text()) if result.exists() else (None, None)
    return accepted, tried


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), *sys.argv[3:])
