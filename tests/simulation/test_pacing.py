"""Time goes on whatever other threads ask for."""

import time

from cartwheel.description import load_world
from cartwheel.session import Session

MOST = 3000


def test_commands_without_a_pause_do_not_hold_time():
    session = Session(load_world("empty"))
    simulation = session.simulation
    simulation.set_speed(None)
    run = []

    def again():
        run.append(simulation.time_ns)
        time.sleep(0.001)
        if len(run) < MOST:
            simulation.post(again)

    simulation.post(again)
    session.pacer(until_ns=50_000_000).run()
    assert 10 < len(run) < MOST
    assert run == sorted(run)
    session.close()
