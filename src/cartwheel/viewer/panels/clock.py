"""The simulation clock, its speed, and the buttons to pause, step and reset."""

from __future__ import annotations

from typing import Any

from cartwheel.simulation.snapshot import RunState, Snapshot
from cartwheel.viewer.every import Every
from cartwheel.viewer.panels.base import Panel
from cartwheel.viewer.stage import Stage

SPEEDS: dict[str, float | None] = {
    "0.1": 0.1,
    "0.25": 0.25,
    "0.5": 0.5,
    "1 (real time)": 1.0,
    "2": 2.0,
    "5": 5.0,
    "10": 10.0,
    "max": None,
}


class ClockPanel(Panel):
    """Pause, step, reset, speed."""

    def __init__(self, stage: Stage) -> None:
        super().__init__(stage)
        page, gui = self.page, self.gui
        self._due = Every(8)
        self._text = gui.add_html(clock_html(None))
        self._buttons = gui.add_button_group("Time", ("Pause", "Step", "Reset"))
        self._buttons.on_click(page.on_value(self._press))
        self._speed = gui.add_dropdown("Speed", tuple(SPEEDS), initial_value="1 (real time)")
        self._speed.on_update(page.on_value(self._set_speed))
        space = gui.add_command("Pause or resume", hotkey="space")
        space.on_trigger(page.do(self.toggle))
        gui.add_command("Step").on_trigger(page.do(self.step))
        gui.add_command("Reset the simulation").on_trigger(page.do(self.reset))
        self._paused: bool | None = None
        self._shown_speed: float | None = 1.0

    def toggle(self) -> None:
        """Pauses or resumes the simulation."""
        simulation = self.simulation

        def run() -> None:
            paused = simulation.run_state is RunState.PAUSED
            (simulation.resume if paused else simulation.pause)()

        self.page.then(simulation.call(run))

    def step(self) -> None:
        """Advances by one step; pauses a running simulation."""
        self.page.then(self.simulation.call(self.simulation.step))

    def reset(self) -> None:
        """Resets time and models."""
        self.page.then(self.simulation.call(self.simulation.reset))

    def update(self, snapshot: Snapshot, now: float) -> None:
        paused = snapshot.run_state is RunState.PAUSED
        if paused != self._paused:
            self._paused = paused
            self._buttons.options = ("Resume" if paused else "Pause", "Step", "Reset")
        if snapshot.speed != self._shown_speed:
            # The speed was changed by a command or in a different browser.
            self._shown_speed = snapshot.speed
            name = next((n for n, speed in SPEEDS.items() if speed == snapshot.speed), None)
            if name is not None and self._speed.value != name:
                self._speed.value = name
        if self._due(now):
            content = clock_html(snapshot)
            if content != self._text.content:
                self._text.content = content

    def _press(self, _: Any, button: str) -> None:
        {"Step": self.step, "Reset": self.reset}.get(button, self.toggle)()

    def _set_speed(self, event: Any, name: str) -> None:
        if event.client is None:
            return  # set by `update`, not by a user
        simulation, speed = self.simulation, SPEEDS[name]
        self._shown_speed = speed
        self.page.then(simulation.call(lambda: simulation.set_speed(speed)))


def clock_html(snapshot: Snapshot | None) -> str:
    """Simulation time, run state and real-time factor."""
    if snapshot is None:
        return '<div class="cw cw-clock"><b>0.000 s</b></div>'
    state = snapshot.run_state.value
    factor = snapshot.real_time_factor
    measured = f"{factor:.2f}× real time" if snapshot.run_state is RunState.RUNNING else ""
    return (
        f'<div class="cw cw-clock" data-time-ns="{snapshot.time_ns}">'
        f"<b>{snapshot.time_ns / 1e9:.3f} s</b>"
        f'<span class="cw-dim cw-factor">{measured}</span>'
        f'<span class="cw-state cw-{state}">{state}</span></div>'
    )
