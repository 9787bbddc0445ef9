"""Worlds of a batch in other processes."""

from __future__ import annotations

import contextlib
import multiprocessing
import signal
from collections.abc import Sequence
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING, Any, Literal

from cartwheel.batch.abreast import run_abreast
from cartwheel.batch.lane import Lane, Values, stacked
from cartwheel.batch.link import Link, Packed, packed, unpacked
from cartwheel.batch.warp import WarpPhysics, unsupported
from cartwheel.codes.world import BATCH_PROCESS_ENDED
from cartwheel.errors import CartwheelError, fault

if TYPE_CHECKING:
    from cartwheel.api import Built
    from cartwheel.batch.plan import Plan

Method = Literal["spawn", "fork", "forkserver"]
_END = 30.0
"""Wall time in which a process must end, also on a busy computer, s."""

_UNGUARDED = (
    'A script must make the batch below `if __name__ == "__main__":`, because each process imports '
    "it. Or pass workers=0."
)


class Lanes:
    """Several worlds in this process.

    Args:
        built: Makes the worlds.
        plan: What they receive and return.
        seeds: The seed of each world.
        device: Warp's name of the device that computes the physics; None is MuJoCo.
    """

    def __init__(
        self, built: Built, plan: Plan, seeds: Sequence[int], device: str | None = None
    ) -> None:
        self.lanes: list[Lane] = []
        self._period = plan.period
        self._physics: WarpPhysics | None = None
        try:
            self.lanes += [Lane(built, plan, seed) for seed in seeds]
            if device is not None:
                simulations = [lane.world.session.simulation for lane in self.lanes]
                self._physics = WarpPhysics(simulations, device)
        except BaseException:
            self.close()
            raise

    def reset(self, which: Sequence[int], seeds: Sequence[int | None]) -> Values:
        """Restarts some of the worlds, and runs them for a period without an action."""
        lanes = [self.lanes[index] for index in which]
        for lane, seed in zip(lanes, seeds, strict=True):
            lane.begin(seed)
        return self._run(lanes)

    def step(self, which: Sequence[int], actions: Sequence[Sequence[float]]) -> Values:
        """Runs some of the worlds for a period, and returns their observations."""
        lanes = [self.lanes[index] for index in which]
        for lane, action in zip(lanes, actions, strict=True):
            lane.act(action)
        return self._run(lanes)

    def _run(self, lanes: Sequence[Lane]) -> Values:
        worlds = [lane.world for lane in lanes]
        if self._physics is not None and any(world._is_paced for world in worlds):
            raise unsupported("worlds with connections or a pace")
        run_abreast(worlds, self._period, self._physics)
        return stacked([lane.observe() for lane in lanes])

    def close(self) -> None:
        """Closes all worlds."""
        for lane in self.lanes:
            lane.close()


class Process:
    """Several worlds in another process.

    Args:
        built: Makes the worlds.
        plan: What they receive and return.
        seeds: The seed of each world.
        method: How the process is started.
        device: As for `Lanes`.
    """

    def __init__(
        self,
        built: Built,
        plan: Plan,
        seeds: Sequence[int],
        method: Method,
        device: str | None = None,
    ) -> None:
        context: Any = multiprocessing.get_context(method)
        ours, theirs = context.Pipe()
        self._link = Link(ours)
        self._calls = 0
        self._has_answered = False
        # A forked process has a copy of this end, with which it would not notice that this process
        # was killed.
        ends = (theirs, ours) if method == "fork" else (theirs,)
        self._process: Any = context.Process(
            target=_work, args=(ends, built, plan, seeds, device), name="cartwheel-batch",
            daemon=True,
        )  # fmt: skip
        self._process.start()
        theirs.close()

    def ask(self, name: str, *arguments: Any) -> None:
        """Calls a method of `Lanes`; `answer` returns the result."""
        self._calls += 1
        with contextlib.suppress(OSError):  # it has ended, which `answer` reports
            self._link.send((self._calls, name, arguments))

    def answer(self) -> Values:
        """The result of the call.

        Raises:
            CartwheelError: The call raised it, or the process has ended.
        """
        try:
            number = 0
            while number != self._calls:  # an interrupted caller did not wait for the others
                number, error, result = self._link.receive()
        except (EOFError, OSError):
            self._process.join(_END)
            status = self._process.exitcode
            # It ends by itself when this end is closed.
            why = f"with status {status}" if status else "because an earlier call was interrupted"
            raise CartwheelError(
                f"a process of the batch ended {why}",
                code=BATCH_PROCESS_ENDED,
                values={"status": str(status)},
                hint=_UNGUARDED if status == 1 and not self._has_answered else "",
            ) from None
        self._has_answered = True
        if error is not None:
            raise error
        return unpacked(result)

    def close(self) -> None:
        """Ends the process."""
        with contextlib.suppress(OSError):
            self._link.send(None)
        self._link.close()
        self._process.join(_END)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()


def _work(
    ends: Sequence[Connection], built: Built, plan: Plan, seeds: Sequence[int], device: str | None
) -> None:
    """Runs in the process: answers calls until the link is closed.

    Args:
        ends: Its end of the link, and copies of other ends.
        built: As for `Lanes`, like the others.
        plan: The same.
        seeds: The same.
        device: The same.
    """
    connection, *copies = ends
    for each in copies:
        each.close()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent process ends this one
    link = Link(connection)
    with contextlib.suppress(EOFError, OSError):
        try:
            lanes = Lanes(built, plan, seeds, device)
        except Exception as error:  # noqa: BLE001 - each answer reports it
            failure = _picklable(error)
            while (call := link.receive()) is not None:
                link.send((call[0], failure, None))
            return
        with contextlib.closing(lanes):
            while (call := link.receive()) is not None:
                number, name, arguments = call
                answer: tuple[int, CartwheelError | None, Packed]
                try:
                    answer = (number, None, packed(getattr(lanes, name)(*arguments)))
                except Exception as error:  # noqa: BLE001 - the parent process raises it
                    answer = (number, _picklable(error), [])
                link.send(answer)


def _picklable(error: Exception) -> CartwheelError:
    """The error without its traceback and causes, which may not be picklable."""
    if isinstance(error, CartwheelError):
        return CartwheelError(
            error.message, code=error.code, origin=error.origin, hint=error.hint,
            values=error.values,
        )  # fmt: skip
    found = fault("an unexpected error in a world of a batch", error)
    return CartwheelError(found.message, code=found.code, hint=found.hint, values=found.values)
