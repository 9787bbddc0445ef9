"""What panels make of messages, without a browser."""

import asyncio
import math
import queue
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from types import SimpleNamespace
from unittest.mock import MagicMock

import numpy as np
import pytest

from cartwheel.errors import Diagnostic, Origin
from cartwheel.graph import Graph, TopicInfo
from cartwheel.messages import header, message_class
from cartwheel.viewer.every import Every
from cartwheel.viewer.page import Page
from cartwheel.viewer.panels.bumper import CONTACTS, BumperPanel, light_html, other_side
from cartwheel.viewer.panels.camera import pixels_of
from cartwheel.viewer.panels.drive import DrivePanel
from cartwheel.viewer.panels.imu import IMU, ImuPanel, row_of, thin
from cartwheel.viewer.panels.notes import notes_html
from cartwheel.viewer.panels.topics import list_html


def image(encoding, data, *, width, height, step):
    return SimpleNamespace(
        encoding=encoding,
        is_bigendian=0,
        width=width,
        height=height,
        step=step,
        data=np.array(data, dtype=np.uint8),
    )


def test_a_key_drives_what_reads_commands_with_a_stamp_too():
    graph, stage = Graph(), MagicMock()
    stage.session.graph = graph
    seat = MagicMock()
    seat.gui.add_dropdown.return_value = SimpleNamespace(value="", options=())
    panel = DrivePanel(stage, seat)
    panel.show_topics(graph.topics())
    assert not seat.gui.add_dropdown.call_args.kwargs["visible"], "nothing drives yet"
    plain, stamped = [], []
    graph.subscribe("/a", plain.append, type_name="geometry_msgs/msg/Twist")
    graph.subscribe("/b", stamped.append, type_name="geometry_msgs/msg/TwistStamped")
    panel.show_topics(graph.topics())
    assert seat.gui.add_dropdown.return_value.visible
    assert seat.gui.add_html.return_value.visible
    panel.press("i")
    assert [message.linear.x for message in plain] == [0.5]
    assert [message.twist.linear.x for message in stamped] == [0.5]


def test_the_value_of_a_control_is_that_of_the_moment_it_was_used():
    page, seen = Page.__new__(Page), []
    page._jobs = queue.SimpleQueue()
    slider = SimpleNamespace(value=3.0, _impl=SimpleNamespace(removed=False))
    used = page.on_value(lambda _, value: seen.append(value))
    # Not on this thread, on which the browser of other tests runs a loop of its own.
    with ThreadPoolExecutor(1) as pool:
        event = SimpleNamespace(target=slider, client_id=1)
        pool.submit(asyncio.run, used(event)).result(timeout=60)
    slider.value = 0.0  # A panel that follows the simulation sets it back.
    function, _ = page._jobs.get_nowait()
    function()
    assert seen == [3.0]


def test_bgr_becomes_rgb():
    picture = pixels_of(image("bgr8", [1, 2, 3, 4, 5, 6], width=2, height=1, step=6))
    assert picture.tolist() == [[[3, 2, 1], [6, 5, 4]]]


def test_padding_at_the_end_of_a_row_is_no_pixel():
    data = [10, 20, 99, 99, 30, 40, 99, 99]
    picture = pixels_of(image("mono8", data, width=2, height=2, step=4))
    assert picture[:, :, 0].tolist() == [[10, 20], [30, 40]]
    assert picture.shape == (2, 2, 3)


def test_an_encoding_without_colours_is_refused():
    assert pixels_of(image("yuv422", [0] * 8, width=2, height=1, step=8)) is None


def test_an_imu_message_becomes_a_row():
    vector = message_class("geometry_msgs/msg/Vector3")
    zeros = np.zeros(9)
    message = message_class("sensor_msgs/msg/Imu")(
        header=header(2_500_000_000, "imu"),
        orientation=message_class("geometry_msgs/msg/Quaternion")(
            x=0.0, y=0.0, z=math.sin(math.radians(15)), w=math.cos(math.radians(15))
        ),
        orientation_covariance=zeros,
        angular_velocity=vector(x=1.0, y=2.0, z=3.0),
        angular_velocity_covariance=zeros,
        linear_acceleration=vector(x=4.0, y=5.0, z=9.8),
        linear_acceleration_covariance=zeros,
    )
    assert row_of(message) == pytest.approx((2.5, 1, 2, 3, 4, 5, 9.8, 0, 0, 30))


def test_headings_of_the_imu_show_only_with_one():
    stage = MagicMock()
    made = []

    def add(*_, visible=True, **__):
        made.append(SimpleNamespace(visible=visible, content=""))
        return made[-1]

    stage.page.gui.add_html.side_effect = stage.page.gui.add_uplot.side_effect = add
    panel = ImuPanel(stage)
    assert [each.visible for each in made] == [True, *[False] * 6], "only the note"
    imu = TopicInfo(name="/imu", type=IMU, publishers=("imu",), subscribers=(), rate=1.0, qos="")
    panel.show_topics([imu])
    assert all(each.visible for each in made)
    panel.show_topics([])
    assert not any(each.visible for each in made[1:])


def test_thinning_keeps_the_newest_row():
    table = np.arange(1000.0)[:, None]
    thinned = thin(table, 160)
    assert thinned[-1, 0] == 999
    assert 100 <= len(thinned) <= 160
    assert (np.diff(thinned[:, 0]) > 0).all()


def test_the_light_names_the_models_hit_and_escapes_them():
    contacts = [("/left", "wall::link::c"), ("/<i>", "a<b::l::c"), ("/left", "wall::link::d")]
    lit = light_html(contacts)
    assert "cw-hit" in lit
    assert "Contact: <b>wall</b>, <b>a&lt;b</b></span>" in lit
    assert "<b::" not in lit
    assert "cw-hit" not in light_html([])
    both = light_html(contacts, topics=True)
    assert "Contact: <b>wall</b> (/left), <b>a&lt;b</b> (/&lt;i&gt;)</span>" in both


def test_the_light_names_the_bumper_where_there_are_several():
    graph, stage = Graph(), MagicMock()
    stage.session.graph = graph
    stage.page.clients = {1}
    stage.seats = {}
    light = stage.page.gui.add_html.return_value
    panel = BumperPanel(stage)
    left = graph.advertise("/left", CONTACTS)
    panel.show_topics(graph.topics())

    def publish(topic):
        topic.publish(message_class(CONTACTS)(header=header(0, ""), states=[contact(1.0)]))
        panel.update(None, 10.0)

    publish(left)
    assert "<b>post</b></span>" in light.content
    right = graph.advertise("/right", CONTACTS)
    panel.show_topics(graph.topics())
    publish(right)
    assert "<b>post</b> (/left), <b>post</b> (/right)</span>" in light.content


def test_what_is_hit_is_not_the_sensors_own_collision():
    state = SimpleNamespace(collision1_name="cart::base::c", collision2_name="post::link::c")
    assert other_side(state) == "post::link::c"


def contact(force):
    """A state of a bumper with one contact at (1, 2, 3) m."""
    vector = SimpleNamespace(x=1.0, y=2.0, z=3.0)
    wrench = SimpleNamespace(force=SimpleNamespace(x=0.0, y=0.0, z=force))
    return SimpleNamespace(
        collision1_name="cart::base::c",
        collision2_name="post::link::c",
        contact_positions=[vector],
        wrenches=[wrench],
    )


def test_two_bumpers_have_their_arrows_and_each_takes_its_own_away():
    graph, stage = Graph(), MagicMock()
    stage.session.graph = graph
    stage.page.clients = {1}
    kind = message_class(CONTACTS)
    left, right = (graph.advertise(name, CONTACTS) for name in ("/left", "/right"))
    seat = MagicMock()
    seat.display.contacts = True
    stage.seats = {1: seat}
    panel = BumperPanel(stage)
    assert not stage.page.gui.add_html.call_args.kwargs["visible"], "no bumper yet"
    panel.show_topics(graph.topics())
    assert stage.page.gui.add_html.return_value.visible is True

    def publish(topic, states):
        # What the panel reads of it is made here.
        message = kind(header=header(0, ""), states=states)
        topic.publish(message)
        panel.update(None, 10.0)

    def drawn():
        return seat.scene.add_arrows.call_args.args[1][:, 1, 2].tolist()

    publish(left, [contact(50.0)])
    publish(right, [contact(100.0)])
    assert drawn() == pytest.approx([3.2, 3.4])
    publish(left, [])
    assert drawn() == pytest.approx([3.4])
    publish(right, [])
    seat.scene.add_arrows.return_value.remove.assert_called_once()
    seat.display.contacts = False
    publish(left, [contact(50.0)])
    assert seat.scene.add_arrows.call_count == 3, "nobody shows it"


def test_topics_show_type_and_stated_rate():
    info = TopicInfo(
        name="/imu/data",
        type="sensor_msgs/msg/Imu",
        publishers=("imu",),
        subscribers=(),
        rate=100.0,
        qos="default",
    )
    shown = list_html([info])
    assert "/imu/data" in shown
    assert "sensor_msgs/<wbr>Imu" in shown
    assert "100 Hz" in shown
    assert "dropped" not in shown
    slow = replace(info, subscribers=("a", "b"), dropped=(0, 3))
    assert "3 dropped</span>" in list_html([slow])
    assert "a, b (3 dropped)" in list_html([slow])


def test_warnings_stand_before_remarks_with_their_place():
    notes = notes_html(
        [
            Diagnostic(severity="info", message="first"),
            Diagnostic(severity="warning", message="second", origin=Origin(file="a.urdf", line=7)),
        ]
    )
    assert notes.index("second") < notes.index("first")
    assert "a.urdf:7" in notes


def test_a_limit_of_rate_holds():
    due = Every(10.0)
    done = sum(due(i / 1000) for i in range(1000, 2000))
    assert done == 10
