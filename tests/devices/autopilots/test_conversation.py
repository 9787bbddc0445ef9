"""Which packets count, and how long a step waits, with a port that a test fills."""

import pytest
from tests.devices.autopilots.ardupilot_client import servo_packet

from cartwheel.codes import wires
from cartwheel.devices.autopilots.conversation import Conversation
from cartwheel.devices.autopilots.reports import Reports

SITL, OTHER = ("127.0.0.1", 5000), ("127.0.0.1", 6000)


class Port:
    """Returns the packets of a list; None is a wait without a packet."""

    def __init__(self):
        self.waiting = []
        self.sent = []
        self.waits = 0

    def receive(self, seconds):
        self.waits += seconds > 0
        return self.waiting.pop(0) if self.waiting else None

    def send(self, data, address):
        self.sent.append((data, address))

    def close(self):
        self.closed = True


class Case:
    """A conversation, and what it reports."""

    def __init__(self, lock_step, most_missed=3):
        self.port = Port()
        self.reports = []
        self.conversation = Conversation(
            self.port,
            lock_step=lock_step,
            most_missed=most_missed,
            reports=Reports(self.reports.append, title="the plugin", origin=None),
        )

    def next(self, *packets):
        self.port.waiting = list(packets)
        packet = self.conversation.next()
        return packet.frame if packet is not None else None

    def codes(self):
        return [each.code for each in self.reports]


def servo(frame, sender=SITL):
    return servo_packet(frame, [1500]), sender


@pytest.fixture(params=[True, False], ids=["lock step", "no lock step"])
def case(request):
    return Case(request.param)


def test_nothing_is_waited_for_without_a_connection(case):
    for _ in range(1000):
        assert case.next() is None
    assert case.port.waits == 0
    assert not case.conversation.connected
    case.conversation.send(b"state")
    assert case.port.sent == []


def test_the_first_valid_packet_connects(case):
    assert case.next((b"nonsense", OTHER), servo(5)) == 5
    assert case.codes() == [wires.AUTOPILOT_PACKET_IGNORED, wires.AUTOPILOT_CONNECTED]
    assert case.reports[0].values == {
        "reason": "length", "address": "127.0.0.1:6000", "bytes": 8
    }  # fmt: skip
    case.conversation.send(b"state")
    assert case.port.sent == [(b"state", SITL)]


def test_packets_of_others_are_ignored_and_reported(case):
    case.next(servo(1))
    assert case.next(servo(2, OTHER), servo(2)) == 2
    assert case.reports[-1].code == wires.AUTOPILOT_PACKET_IGNORED
    assert case.reports[-1].values["reason"] == "sender"


def test_each_packet_controls_one_step_in_lock_step():
    case = Case(lock_step=True)
    assert case.next(servo(1), servo(2), servo(3)) == 1
    assert [each[0] for each in case.port.waiting] == [servo(2)[0], servo(3)[0]]


def test_the_newest_packet_counts_without_lock_step():
    case = Case(lock_step=False)
    assert case.next(servo(1), servo(2), servo(3)) == 3
    assert case.port.waiting == []


def test_the_answer_to_a_repeated_packet_is_repeated():
    case = Case(lock_step=True)
    case.next(servo(1))
    case.conversation.send(b"state")
    assert case.next(servo(1), servo(2)) == 2
    assert case.port.sent == [(b"state", SITL)] * 2
    assert wires.AUTOPILOT_FRAMES_MISSED not in case.codes()


def test_missed_frames_are_counted(case):
    case.next(servo(1))
    case.next(servo(5))
    assert case.reports[-1].code == wires.AUTOPILOT_FRAMES_MISSED
    assert case.reports[-1].values == {"missed": 3}


def test_an_autopilot_may_start_again_with_frame_0(case):
    case.next(servo(100))
    assert case.next(servo(0)) == 0
    assert case.codes() == [wires.AUTOPILOT_CONNECTED]


def test_the_connection_is_lost_after_the_stated_number_of_steps():
    case = Case(lock_step=False, most_missed=3)
    case.next(servo(1))
    for _ in range(3):
        assert case.next() is None
        assert case.conversation.connected
    assert case.next() is None
    assert not case.conversation.connected
    assert case.codes() == [wires.AUTOPILOT_CONNECTED, wires.AUTOPILOT_LOST]
    assert case.next(servo(1, OTHER)) == 1


def test_a_step_waits_100_times_in_lock_step_and_repeats_the_state():
    case = Case(lock_step=True, most_missed=9)
    case.next(servo(1))
    case.conversation.send(b"state")
    case.port.waits = 0
    assert case.next() is None
    assert case.port.waits == 100
    assert case.port.sent == [(b"state", SITL)] * 10
    assert case.codes()[-1] == wires.AUTOPILOT_LOST


def test_a_flood_of_packets_does_not_keep_a_step_waiting():
    case = Case(lock_step=True)
    case.next(servo(1))
    flood = [(b"nonsense", OTHER)] * 100_000
    assert case.next(*flood) is None
    assert len(flood) - len(case.port.waiting) <= 100 * 64
    # The terminal is not flooded.
    assert len(case.reports) < 20


def test_reports_are_limited(case):
    for frame in range(0, 1000, 2):
        case.next((b"", OTHER), servo(frame))
    assert case.codes().count(wires.AUTOPILOT_PACKET_IGNORED) == 10
    assert case.codes().count(wires.AUTOPILOT_FRAMES_MISSED) == 10
