"""When what is due: exact over hours, for rates that no step divides."""

import math
from fractions import Fraction
from types import SimpleNamespace

import pytest

from cartwheel.simulation.clock import NANOSECONDS, Schedule, Task, Ticks, always, to_ns

STEP = 5_000_000


def task(rate, *, order=0, active=lambda: True, topics=None, idle=None):
    return Task(
        rate=rate, before=None, after=None, active=active, topics=topics, idle=idle, order=order
    )


def due_steps(rate, steps, *, step_ns=STEP):
    """The steps on which a task alone is due."""
    schedule, step, found = Schedule([task(rate)], step_ns=step_ns), 0, []
    while step < steps:
        tasks, _, upcoming = schedule.at(step)
        if tasks:
            found.append(step)
        step = upcoming
    return found


@pytest.mark.parametrize("rate", [30, 29.97, 7, 60, 100, 50, 0.3])
def test_due_times_do_not_drift_in_a_thousand_seconds(rate):
    """The k-th is the first step at or after k / rate."""
    steps = 1000 * NANOSECONDS // STEP
    found = due_steps(rate, steps)
    exact = Fraction(rate).limit_denominator(1_000_000)
    expected = []
    k = 0
    while (step := math.ceil(Fraction(k) / exact * NANOSECONDS / STEP)) < steps:
        expected.append(step)
        k += 1
    assert found == expected
    assert len(found) == math.ceil(1000 * exact)


@pytest.mark.parametrize("rate", [0, 200, 1000, 1e6])
def test_a_rate_beyond_the_step_is_every_step(rate):
    assert due_steps(rate, 50) == list(range(50))


def test_a_step_that_is_no_round_number():
    """At 1/3 ms (rounded to ns) 100 Hz stays 100 Hz."""
    step = to_ns(1 / 3000)
    count = len(due_steps(100, 10 * NANOSECONDS // step, step_ns=step))
    assert abs(count - 1000) <= 1


def test_a_schedule_looked_at_late_goes_on_with_the_next():
    """Steps that were missed, as after a spawn far into a run, are not made up for."""
    schedule = Schedule([task(50)], step_ns=STEP)
    assert schedule.at(1002) == ((), (), 1004)


def test_tasks_due_together_come_in_their_order():
    late, early, other = task(50, order=2), task(100, order=1), task(30, order=0)
    schedule = Schedule([late, early, other], step_ns=STEP)
    assert schedule.at(0)[0] == (other, early, late)
    assert schedule.at(2)[0] == (early,)
    assert schedule.at(4)[0] == (early, late)


def test_tasks_that_only_read_the_state_are_listed_apart():
    asked, reads = task(50), task(100, order=1, active=always)
    schedule = Schedule([reads, asked], step_ns=STEP)
    assert schedule.at(0) == ((asked,), (reads,), 2)
    assert schedule.at(2) == ((), (reads,), 4)


def test_a_task_sleeps_while_none_of_its_topics_has_subscribers():
    """Topics can be added later."""
    topics = [SimpleNamespace(wanted=False)]
    rare, sleeper = task(50), task(0, order=1, topics=topics)
    assert Schedule([rare, sleeper], step_ns=STEP).at(0) == ((rare,), (), 4)
    topics.append(SimpleNamespace(wanted=True))
    assert Schedule([rare, sleeper], step_ns=STEP).at(0) == ((rare, sleeper), (), 1)


def test_a_task_without_topics_sleeps_until_its_owner_wakes_it():
    sleeper = task(0)
    sleeper.asleep = True
    assert Schedule([sleeper], step_ns=STEP).at(0)[:2] == ((), ())
    sleeper.asleep = False
    assert Schedule([sleeper], step_ns=STEP).at(0)[:2] == ((sleeper,), ())


@pytest.mark.parametrize("rate", [30, 29.97, 7, 100, 0.3, 0, 1000])
@pytest.mark.parametrize("origin_ns", [0, 1_000_000, 1_234_567_891])
def test_after_a_change_of_the_step_due_times_are_the_same(rate, origin_ns):
    """Steps of 3 ms that begin at any time: due at the first step at or after k / rate."""
    step_ns = 3_000_000
    schedule = Schedule([task(rate)], step_ns=step_ns, origin_ns=origin_ns)
    found = [step for step in range(2000) if schedule.at(step)[0]]
    if rate in (0, 1000):
        assert found == list(range(2000))
        return
    exact = Fraction(rate).limit_denominator(1_000_000)
    due = (math.ceil((k / exact * NANOSECONDS - origin_ns) / step_ns) for k in range(10_000))
    assert found == [step for step in due if 0 <= step < 2000]


@pytest.mark.parametrize(("seconds", "ns"), [(0.005, 5_000_000), (0.1, 100_000_000), (1e-9, 1)])
def test_to_ns_rounds(seconds, ns):
    assert to_ns(seconds) == ns


@pytest.mark.parametrize("period", ["1", "2", "20/3", "7/2", "1000/2997"])
@pytest.mark.parametrize("offset", ["0", "5/2"])
def test_the_last_due_step_is_the_one_before(period, offset):
    ticks = Ticks(max(Fraction(period), Fraction(1)), Fraction(offset))
    due = [step for step in range(60) if ticks.due(step) == step]
    assert [ticks.last(step) for step in range(due[0] + 1, 60)] == [
        max(each for each in due if each < step) for step in range(due[0] + 1, 60)
    ]


def test_steps_at_which_all_due_tasks_are_idle_are_skipped():
    idle = [True]
    schedule = Schedule([task(50, idle=lambda: idle[0]), task(20)], step_ns=STEP)
    assert schedule.may_skip
    assert [schedule.skip(step, 100) for step in (4, 10, 12)] == [10, 10, 20]
    assert schedule.skip(4, 7) == 8
    idle[0] = False
    assert schedule.skip(4, 100) == 4
    reads = Schedule([task(50, idle=lambda: True), task(25, active=always)], step_ns=STEP)
    assert reads.skip(4, 100) == 8
    assert not Schedule([task(50)], step_ns=STEP).may_skip


def test_what_is_due_at_every_step_need_not_be_looked_up():
    always_due = [task(0, order=0), task(1000, order=1)]
    schedule = Schedule(always_due, step_ns=STEP)
    first, last, gap = schedule.every
    for step in range(5):
        assert schedule.at(step) == (first, last, step + gap)
    assert Schedule([*always_due, task(50, order=2)], step_ns=STEP).every is None
