"""How many inputs a target accepts: ``python -m tests.campaign.accepting TARGET FOLDER MUTATIONS``.

The inputs are the target's seeds, or that many mutations of them. The last line printed is a JSON
list: the number of accepted inputs and the number of all inputs.
"""

from __future__ import annotations

import contextlib
import json
import os
import sys
from random import Random

from tests.campaign import registry


def main(name: str, folder: str, mutations: int) -> None:
    target = registry.load(name)
    os.chdir(folder)
    seeds = target.seeds()
    inputs = [
        target.mutate(seeds[number % len(seeds)], seeds, Random(number))
        for number in range(mutations)
    ]
    accepted = 0
    for each in inputs or seeds:
        with contextlib.suppress(*target.allowed):
            target.run_one(each)
            accepted += 1
    print(json.dumps([accepted, len(inputs or seeds)]))


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], int(sys.argv[3]))
