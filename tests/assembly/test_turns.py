"""Who may use a simulation when, and who answers clients in between."""

import contextlib
import queue
import threading
from collections.abc import Callable

import pytest
from tests.bridges.ros1_peers import wait_for

from cartwheel.assembly.attendant import Attendant
from cartwheel.assembly.turns import Turns
from cartwheel.simulation.run_state import Run


def test_a_shared_turn_lets_others_in_when_it_says_so() -> None:
    turns, commands = Turns(), queue.SimpleQueue[Callable[[], None]]()
    inside: list[int] = []

    def use(number: int) -> None:
        with turns, turns:
            inside.append(number)

    with turns, turns.shared(commands.put):
        threads = [threading.Thread(target=use, args=(number,)) for number in range(5)]
        for thread in threads:
            thread.start()
        assert inside == []
        commands.get(timeout=60)()
        assert inside

        def all_inside() -> bool:
            # Several may enter together, and their requests then do nothing.
            with contextlib.suppress(queue.Empty):
                commands.get(timeout=0.1)()
            return sorted(inside) == [0, 1, 2, 3, 4]

        wait_for(all_inside, "all")
    for thread in threads:
        thread.join(60)


def test_an_exclusive_turn_makes_others_wait() -> None:
    turns = Turns()
    entered = threading.Event()

    def use() -> None:
        with turns:
            entered.set()

    with turns:
        thread = threading.Thread(target=use)
        thread.start()
        thread.join(0.2)
        assert thread.is_alive()
        assert not entered.is_set()
    thread.join(60)
    assert entered.is_set()


def test_who_was_let_in_by_the_end_of_the_turn_is_not_let_in_again() -> None:
    turns, commands = Turns(), queue.SimpleQueue[Callable[[], None]]()
    inside = threading.Event()

    def use() -> None:
        with turns:
            inside.set()

    thread = threading.Thread(target=use)
    with turns, turns.shared(commands.put):
        thread.start()
        late = commands.get(timeout=60)
    thread.join(60)
    assert inside.is_set()
    with turns:
        late()
        assert not entered_meanwhile(turns)


def entered_meanwhile(turns: Turns) -> bool:
    """Whether another thread could have its turn now."""
    found: list[bool] = []
    thread = threading.Thread(target=lambda: found.append(turns.acquire_within(0.0)))
    thread.start()
    thread.join(60)
    return found[0]


def test_reads_are_served_between_two_turns_and_commands_wait() -> None:
    simulation, turns = Run(), Turns()
    attendant = Attendant(simulation, turns)
    commanded: list[bool] = []
    simulation.post(lambda: commanded.append(True))
    assert simulation.read(threading.get_ident).result(60) == attendant._thread.ident
    assert commanded == []
    with turns:
        answer = simulation.read(threading.get_ident)
        assert not answer.done()
        # The thread that has its turn serves them as well.
        simulation.drain()
        assert answer.result(0) == threading.get_ident()
        assert commanded == [True]
    attendant.close()
    assert not attendant._thread.is_alive()
    # Without it, they wait like all others.
    answer = simulation.read(lambda: 1)
    assert not answer.done()
    simulation.drain()
    assert answer.result(0) == 1


def test_the_queue_does_not_grow_with_reads() -> None:
    simulation, turns = Run(), Turns()
    attendant = Attendant(simulation, turns)
    for number in range(100):
        assert simulation.read(lambda number=number: number).result(60) == number
    assert simulation.commands.qsize() == 1
    attendant.close()


@pytest.mark.parametrize("held", [False, True])
def test_an_attendant_can_be_closed_by_who_has_the_turn(held: bool) -> None:
    simulation, turns = Run(), Turns()
    attendant = Attendant(simulation, turns)
    with turns:
        if held:
            answer = simulation.read(lambda: 1)
        attendant.close()
        if held:
            assert not answer.done()
            simulation.end()
            assert answer.result(0) == 1
