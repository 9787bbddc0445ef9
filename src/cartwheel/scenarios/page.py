"""The report as one HTML file, which needs no network."""

from __future__ import annotations

import base64
import shlex
from collections.abc import Sequence
from html import escape
from pathlib import Path

import cartwheel
from cartwheel.scenarios.drawing import drawing
from cartwheel.scenarios.outcome import Outcome

_MOST_LINES = 300
"""Maximum number of trajectories in a scenario's drawing."""
_MOST_PICTURES = 200
"""Maximum number of pictures in the report."""
_MOST_DETAILS = 500
"""Maximum number of failed cases with details."""
_STYLE = """
:root { color-scheme: light dark; --text: #1b1f24; --dim: #5b6570; --line: #d9dee3; --paper: #fff;
  --panel: #f5f7f9; --good: #1a7f4b; --bad: #c62f2f; --track: #3b6fb6; --solid: #aab3bc; }
@media (prefers-color-scheme: dark) { :root { --text: #e6e9ec; --dim: #9aa5b1; --line: #343b43;
  --paper: #15191d; --panel: #1d2329; --good: #4cc38a; --bad: #ff7b72; --track: #7fb0f5;
  --solid: #55606b; } }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 24px; max-width: 1120px; background: var(--paper);
  color: var(--text); font: 15px/1.5 system-ui, sans-serif; }
h1 { font-size: 22px; margin: 0 0 4px; } h2 { font-size: 17px; margin: 36px 0 8px; }
.dim, .dim a { color: var(--dim); } .good { color: var(--good); } .bad { color: var(--bad); }
.bar { display: flex; height: 8px; border-radius: 4px; overflow: hidden; margin: 12px 0 20px;
  background: var(--line); } .bar i { display: block; }
.bar .good { background: var(--good); } .bar .bad { background: var(--bad); }
table { border-collapse: collapse; width: 100%; font-size: 14px; }
th { text-align: left; color: var(--dim); font-weight: 500; }
th, td { padding: 3px 12px 3px 0; border-bottom: 1px solid var(--line); }
td.number, th.number { text-align: right; font-variant-numeric: tabular-nums; }
article { background: var(--panel); border: 1px solid var(--line);
  border-left: 4px solid var(--bad); border-radius: 6px; padding: 12px 16px; margin: 12px 0; }
article h3 { font-size: 15px; margin: 0 0 6px; overflow-wrap: anywhere; }
.views { display: flex; flex-wrap: wrap; gap: 16px; align-items: flex-start; margin-top: 10px; }
.views img { max-width: 480px; width: 100%; border-radius: 4px; }
pre { margin: 6px 0; white-space: pre-wrap; overflow-wrap: anywhere; font-size: 13px; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: 2px 12px; margin: 6px 0; }
dt { color: var(--dim); } dd { margin: 0; overflow-wrap: anywhere; }
code { font-size: 13px; } details { margin: 8px 0; } summary { cursor: pointer; color: var(--dim); }
svg { background: var(--paper); border: 1px solid var(--line); border-radius: 4px;
  max-width: 100%; height: auto; }
svg text { font-size: 10px; fill: var(--dim); } svg .grid { stroke: var(--line); fill: none; }
svg .solid { fill: var(--solid); } svg .target { fill: none; stroke: var(--good);
  stroke-dasharray: 4 3; stroke-width: 1.5; }
svg polyline { fill: none; stroke-width: 1.5; stroke-linejoin: round; }
svg g.good polyline { stroke: var(--track); opacity: .65; }
svg g.good circle { fill: var(--track); }
svg g.bad polyline { stroke: var(--bad); } svg g.bad circle { fill: var(--bad); }
svg g:hover polyline { stroke-width: 3; opacity: 1; }
input { font: inherit; padding: 4px 10px; width: 320px; max-width: 100%; border-radius: 4px;
  border: 1px solid var(--line); background: var(--paper); color: inherit; }
label { margin-left: 12px; } [hidden] { display: none; }
"""
_SCRIPT = """
const text = document.getElementById("filter"), only = document.getElementById("only");
function update() {
  for (const row of document.querySelectorAll("[data-case]")) {
    const hidden = !row.dataset.case.includes(text.value) ||
      only.checked && row.dataset.status === "passed";
    row.hidden = hidden;
  }
}
text.addEventListener("input", update); only.addEventListener("change", update);
"""


def as_page(outcomes: Sequence[Outcome], folder: Path, *, wall: float) -> str:
    """The report as HTML.

    Args:
        outcomes: All cases.
        folder: The folder with pictures and recordings.
        wall: Wall time of the run, s.
    """
    count = len(outcomes)
    failed = [each for each in outcomes if each.status != "passed"]
    passed = count - len(failed)
    share = 100 * passed / count if count else 0
    simulated = sum(each.time for each in outcomes)
    pictures = _Pictures(folder)
    scenarios: dict[tuple[str, str], list[Outcome]] = {}
    for each in outcomes:
        scenarios.setdefault((each.scenario, each.file), []).append(each)
    title = f"{len(failed)} of {count} cases failed" if failed else f"{count} cases passed"
    parts = [
        '<!doctype html><html lang="en"><head><meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f"<title>{title}</title><style>{_STYLE}</style></head><body>",
        f'<h1 class="{"bad" if failed else "good"}">{title}</h1>',
        f'<div class="dim">{len(scenarios)} scenarios, {simulated:.0f} s of simulation time in '
        f"{wall:.0f} s; cartwheel {escape(cartwheel.__version__)}</div>",
        f'<div class="bar"><i class="good" style="width:{share:.2f}%"></i>'
        f'<i class="bad" style="width:{100 - share if count else 0:.2f}%"></i></div>',
        '<input id="filter" placeholder="Filter cases" aria-label="Filter cases">'
        '<label><input id="only" type="checkbox" style="width:auto"> only failed</label>',
    ]
    for (name, file), cases in scenarios.items():
        parts.append(_scenario(name, file, cases, pictures))
    parts.append(f"<script>{_SCRIPT}</script></body></html>\n")
    return "\n".join(parts)


class _Pictures:
    """Pictures as part of the report."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._left = _MOST_PICTURES

    def image(self, outcome: Outcome) -> str:
        """An image element; empty without a picture."""
        path = self._folder / outcome.picture
        if not outcome.picture or not path.is_file():
            return ""
        alt = f"the world at the end of {escape(outcome.id)}"
        if self._left <= 0:
            return f'<img loading="lazy" src="{escape(outcome.picture)}" alt="{alt}">'
        self._left -= 1
        data = base64.b64encode(path.read_bytes()).decode()
        return f'<img src="data:image/jpeg;base64,{data}" alt="{alt}">'


def _scenario(name: str, file: str, cases: Sequence[Outcome], pictures: _Pictures) -> str:
    failed = [each for each in cases if each.status != "passed"]
    verdict = f"{len(failed)} of {len(cases)} failed" if failed else f"{len(cases)} passed"
    shown = [*[each for each in cases if each.status == "passed"][:_MOST_LINES], *failed[:100]]
    parts = [
        f'<section><h2>{escape(name)} <span class="{"bad" if failed else "good"}">{verdict}</span>'
        f'</h2><div class="dim">{escape(file)}</div>',
    ]
    parts += [_failure(each, pictures) for each in failed[:_MOST_DETAILS]]
    if len(cases) > 1 or not failed:
        images = "".join(pictures.image(each) for each in cases[:1] if each.status == "passed")
        parts.append(f'<div class="views">{drawing(shown)}{images}</div>')
    rows = "".join(map(_row, cases))
    is_open = " open" if len(cases) <= 20 else ""
    parts.append(
        f"<details{is_open}><summary>All {len(cases)} cases</summary><table><tr><th>case</th>"
        '<th>result</th><th>random values</th><th class="number">simulation time</th>'
        f'<th class="number">CPU time</th></tr>{rows}</table></details></section>'
    )
    return "\n".join(parts)


def _row(outcome: Outcome) -> str:
    kind = "good" if outcome.status == "passed" else "bad"
    hidden = {
        name: value for name, value in outcome.parameters.items() if f"{name}=" not in outcome.id
    }
    values = ", ".join(
        f"{name} = {value:.4g}" if isinstance(value, float) else f"{name} = {value}"
        for name, value in hidden.items()
    )
    late = f", {outcome.late} late" if outcome.late else ""
    return (
        f'<tr data-case="{escape(outcome.id)}" data-status="{outcome.status}">'
        f'<td>{escape(outcome.id)}</td><td class="{kind}">{outcome.status}{late}</td>'
        f'<td>{escape(values)}</td><td class="number">{outcome.time:.2f} s</td>'
        f'<td class="number">{outcome.cpu:.2f} s</td></tr>'
    )


def _failure(outcome: Outcome, pictures: _Pictures) -> str:
    findings = "".join(
        f'<pre class="{"bad" if index == 0 else ""}">{escape(each.text)}</pre>'
        for index, each in enumerate(outcome.findings)
    )
    parameters = ", ".join(f"{name} = {value}" for name, value in outcome.parameters.items())
    again = ["cartwheel", "test", outcome.file, "--select", outcome.id, "--view"]
    lines = [("seed", str(outcome.seed)), ("run again", _code(shlex.join(again)))]
    if parameters:
        lines.insert(0, ("parameters", escape(parameters)))
    if outcome.recording:
        link = f'<a href="{escape(outcome.recording)}">{escape(outcome.recording)}</a>'
        lines.append(("recording", f"{link}: {_code(f'cartwheel play {outcome.recording}')}"))
    rows = "".join(f"<dt>{name}</dt><dd>{value}</dd>" for name, value in lines)
    more = ""
    for title, text in (
        ("Diagnostics", "\n".join(outcome.diagnostics)), ("Output of the program", outcome.output)
    ):  # fmt: skip
        if text:
            more += f"<details><summary>{title}</summary><pre>{escape(text)}</pre></details>"
    return (
        f'<article data-case="{escape(outcome.id)}" data-status="{outcome.status}">'
        f"<h3>{escape(outcome.id)}</h3>{findings}<dl>{rows}</dl>"
        f'<div class="views">{pictures.image(outcome)}{drawing([outcome])}</div>{more}</article>'
    )


def _code(text: str) -> str:
    return f"<code>{escape(text)}</code>"
