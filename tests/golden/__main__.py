"""Records what every robot does, and compares two records.

$ python -m tests.golden record before.json
$ PYTHONPATH=../other/src python -m tests.golden record after.json
$ python -m tests.golden compare before.json after.json
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import sys
import time
from pathlib import Path
from typing import Any


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.golden", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    tasks = parser.add_subparsers(dest="task", required=True)
    record = tasks.add_parser("record", help="measure everything and write a JSON file")
    record.add_argument("output", type=Path)
    record.add_argument(
        "--robots", type=Path, nargs="+", default=[], help="further folders with robots"
    )
    record.add_argument("--only", default="", help="subjects whose name contains this text")
    record.add_argument("--workers", type=int, default=2)
    compare = tasks.add_parser(
        "compare", help="list the differences; exits with 1 if there are any"
    )
    compare.add_argument("first", type=Path)
    compare.add_argument("second", type=Path)
    tasks.add_parser("expect", help="write expected.json, which test_golden.py compares with")
    given = parser.parse_args()
    if given.task == "record":
        return _record(given.output, given.robots, given.only, given.workers)
    if given.task == "expect":
        from .expected import write

        write()
        return 0
    return _compare(given.first, given.second)


def _record(output: Path, folders: list[Path], only: str, workers: int) -> int:
    from .adapter import tree
    from .pool import measure_all
    from .subjects import all_subjects

    subjects = [each for each in all_subjects(folders) if only in each.key]
    begun = time.monotonic()
    results = measure_all(subjects, workers=workers, note=_note)
    took = time.monotonic() - begun
    faults = {key: each["fault"] for key, each in results.items() if "fault" in each}
    record: dict[str, Any] = {
        "tree": str(tree()),
        "commit": _git(tree(), "rev-parse", "HEAD"),
        "changed": _git(tree(), "status", "--porcelain", "--", "src").splitlines(),
        "machine": platform.processor() or platform.machine(),
        "seconds": round(took, 1),
        "subjects": results,
    }
    output.write_text(json.dumps(record, indent=1) + "\n")
    _note(f"{len(results)} subjects in {took:.0f} s, {len(faults)} faults: {output}")
    for key, fault in faults.items():
        _note(f"fault: {key}: {fault}")
    return int(bool(faults))


def _git(folder: Path, *arguments: str) -> str:
    done = subprocess.run(
        ["git", "-C", str(folder), *arguments],
        capture_output=True,
        text=True,
        check=False,
        env=os.environ,
    )
    return done.stdout.strip()


def _compare(first: Path, second: Path) -> int:
    from .comparing import differences

    one, other = json.loads(first.read_text()), json.loads(second.read_text())
    for name, each in (("A", one), ("B", other)):
        print(f"{name}: {each['commit'][:10]} of {each['tree']}, {len(each['subjects'])} subjects")
    found, before = 0, ""
    for key, kind, text in differences(one, other):
        if key != before:
            print(f"\n{key}")
            before = key
        print(f"  {kind}: {text}")
        found += 1
    print(f"\n{found} differences" if found else "no differences")
    return int(bool(found))


def _note(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


if __name__ == "__main__":
    raise SystemExit(main())
