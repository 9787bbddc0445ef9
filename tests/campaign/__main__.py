"""``python -m tests.campaign``: runs the campaign, or ``replay FILE``s of findings."""

from __future__ import annotations

import argparse
import os
import signal
import sys
from pathlib import Path

from tests.campaign import registry
from tests.campaign.finding import Finding
from tests.campaign.harness import Campaign, replay


def main() -> int:
    """The exit status: 1 where something was found."""
    if sys.argv[1:2] == ["replay"]:
        return _replay([Path(name) for name in sys.argv[2:]])
    parser = argparse.ArgumentParser(
        prog="python -m tests.campaign",
        description="Runs mutated inputs against all readers of files and sockets.",
        epilog="python -m tests.campaign replay FILE... runs findings again. "
        "python -m tests.campaign.load --minutes 30 is the load run.",
    )
    parser.add_argument("--minutes", type=float, default=5.0, help="wall time (default: 5)")
    parser.add_argument("--targets", default="", help="a,b,…; default: all")
    parser.add_argument("--folder", type=Path, default=Path("out/campaign"), help="keeps all state")
    parser.add_argument("--resume", action="store_true", help="go on with what the folder keeps")
    parser.add_argument("--seed", type=int, default=1, help="of the mutations (default: 1)")
    parser.add_argument("--nice", type=int, default=10, help="priority, 0 to 19 (default: 10)")
    arguments = parser.parse_args()
    known = registry.names()
    chosen = arguments.targets.split(",") if arguments.targets else known
    if unknown := sorted(set(chosen) - set(known)):
        parser.error(f"unknown targets: {', '.join(unknown)}; there are: {', '.join(known)}")
    os.nice(arguments.nice)
    targets = [registry.load(name) for name in chosen]
    campaign = Campaign(arguments.folder, targets, arguments.seed)
    if arguments.resume:
        campaign.forget_mended()
    else:
        campaign.clear()
    # Also where it was started in the background, with SIGINT ignored.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        campaign.run(arguments.minutes)
    except KeyboardInterrupt:
        print("stopped; --resume goes on")
    campaign.save()
    print(campaign.table())
    return _report(campaign)


def _report(campaign: Campaign) -> int:
    found = campaign.findings()
    for file in found:
        finding = Finding.load(file)
        print(f"\n{finding.target}: {finding.kind}: {finding.where}")
        print("\n".join(finding.text.strip().splitlines()[-3:]))
        print(f"  python -m tests.campaign replay {file}")
    inputs = sum(each.inputs for each in campaign.counts.values())
    print(f"\ncampaign: {inputs} inputs, {len(found)} findings")
    return 1 if found else 0


def _replay(files: list[Path]) -> int:
    status = 0
    for file in files:
        text = replay(file)
        print(f"{file}: {'passes now' if not text else 'fails'}\n{text}")
        status |= bool(text)
    return status


sys.exit(main())
