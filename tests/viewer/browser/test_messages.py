"""Messages that no page sends: each is dropped, one warning is printed, others go on."""

from __future__ import annotations

import itertools
import math
import socket
from typing import Any

import pytest
from tests.viewer.browsing import CAMERA, browsing
from tests.viewer.running import running
from websockets.exceptions import ConnectionClosed

from cartwheel.codes import files
from cartwheel.codes.recording import UPLOAD_REFUSED
from cartwheel.viewer import uploads

NAN = math.nan


@pytest.fixture
def simulation(tmp_path):
    with running(tmp_path) as started:
        yield started


def malformed(pause: str, speed: str, box: str) -> list[Any]:
    """Of all kinds, with names of controls that are there."""

    def change(uuid: object, **updates: object) -> dict[str, object]:
        return {"type": "GuiUpdateMessage", "uuid": uuid, "updates": updates}

    gizmo = {"type": "TransformControlsUpdateMessage", "name": "/gizmo", "owner": ""}
    return [
        change(speed, nonsense=1),
        change(speed, update_cb=["x"]),
        change(speed, removed=True),
        change(speed, value="11"),
        change(speed, value=[1]),
        change(speed, value=5),
        change(pause, value="Explode"),
        change(box, value="yes"),
        change(box, value=1e308),
        change(box, value=None),
        change("unknown", nonsense=1),
        change(7, value=1),
        {"type": "GuiUpdateMessage", "uuid": speed},
        {"type": "GuiUpdateMessage", "uuid": speed, "updates": 5},
        {"type": "GuiFormDirtyMessage", "uuid": "x" * 900},
        {"type": "ShareUrlRequest"},
        {"type": "RunJavascriptMessage", "source": "alert(1)"},
        {"type": "CommandTriggerMessage"},
        {"type": "CommandTriggerMessage", "uuid": 5},
        {**CAMERA, "wxyz": [NAN] * 4},
        {**CAMERA, "wxyz": [0, 0, 0, 0]},
        {**CAMERA, "position": [1e308, 0, 0]},
        {**CAMERA, "position": "abc"},
        {**CAMERA, "fov": -1},
        {**CAMERA, "more": 1},
        {**gizmo, "wxyz": [1, 0, 0], "position": [0, 0, 0]},
        {**gizmo, "wxyz": [1, 0, 0, 0], "position": [0, 0, NAN]},
        {"type": "SceneNodeClickMessage", "name": "/models/rosbots"},
        {"type": "FileTransferPart", "source_component_uuid": speed, "transfer_uuid": "x"},
        {"type": 5},
        [],
        None,
    ]


def test_malformed_messages_give_one_warning_and_disturb_nobody(simulation):
    with browsing(simulation.port) as bad, browsing(simulation.port) as good:
        for browser in (bad, good):
            browser.look()
        pause, speed = bad.control("Time"), bad.control("Speed")
        box = bad.control("Show the image")
        for message in malformed(pause, speed, box):
            bad.send(message)
        bad.link.send("text")
        bad.link.send(b"\xc1\xff garbage")
        bad.link.send(b"\x91" * 5000)
        # The same connection still works, and the other one sees what it does.
        bad.send({"type": "GuiUpdateMessage", "uuid": pause, "updates": {"value": "Pause"}})
        good.hear(lambda m: "cw-paused" in str((m.get("updates") or {}).get("content")))
    simulation.process.terminate()
    out, _ = simulation.process.communicate(timeout=60)
    assert simulation.process.returncode == 0
    assert "Traceback" not in out
    assert out.count("[CW811") == 1, out
    assert "viser" not in out


def test_a_message_that_is_too_large_ends_its_connection_alone(simulation):
    with browsing(simulation.port) as good:
        good.look()
        pause = good.control("Time")
        with browsing(simulation.port) as bad, pytest.raises(ConnectionClosed):
            bad.look()
            bad.link.send(b"\x90" * 2_000_000)
            while True:
                bad.link.recv(timeout=60)
        good.send({"type": "GuiUpdateMessage", "uuid": pause, "updates": {"value": "Pause"}})
        good.hear(lambda m: "cw-paused" in str((m.get("updates") or {}).get("content")))


def start(upload: str, transfer: str, size: int, parts: int | None = None) -> dict[str, object]:
    return {
        "type": "FileTransferStartUpload",
        "source_component_uuid": upload,
        "transfer_uuid": transfer,
        "filename": "robot.urdf",
        "mime_type": "",
        "part_count": -(-size // uploads.PART_BYTES) if parts is None else parts,
        "size_bytes": size,
    }


def part(upload: str, transfer: str, index: int, content: bytes) -> dict[str, object]:
    return {
        "type": "FileTransferPart",
        "source_component_uuid": upload,
        "transfer_uuid": transfer,
        "part_index": index,
        "content": content,
    }


BALL = b"""<robot name="ball"><link name="ball">
  <inertial><mass value="1"/>
    <inertia ixx=".01" iyy=".01" izz=".01" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><geometry><sphere radius="0.1"/></geometry></collision>
</link></robot>"""


def note(text: str):
    """A note that the page shows."""
    return lambda m: "Notification" in m["type"] and text in str(m)


def nth(wanted, count: int):
    """The message of a kind with this number, from 1 on."""
    numbers = itertools.count(1)
    return lambda m: wanted(m) and next(numbers) == count


def ended(transfer: str):
    """Nothing more of an upload is expected."""
    kind = "FileTransferPartAck"
    return lambda m: (
        m["type"] == kind
        and m["transfer_uuid"] == transfer
        and m["transferred_bytes"] == m["total_bytes"]
    )


def hidden(transfer: str):
    """The note of an upload's progress goes."""
    return lambda m: m["type"] == "RemoveNotificationMessage" and m["uuid"] == f"upload-{transfer}"


def test_an_upload_reads_nothing_of_this_machine(simulation, tmp_path):
    (tmp_path / "secret.yaml").write_text("word: hidden")
    attacks = {
        f"${{xacro.load_yaml('{tmp_path}/secret.yaml')['word']}}": files.FILE_NOT_ALLOWED.number,
        "$(env HOME)": files.XACRO_NAME_UNKNOWN.number,
        "${().__class__.__base__.__subclasses__()}": files.EXPRESSION_INVALID.number,
        "${10**10**10}": files.EXPANSION_TOO_LARGE.number,
    }
    with browsing(simulation.port) as browser:
        browser.look()
        upload = browser.control("Open a file")
        for attack, answer in attacks.items():
            content = (
                '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'
                f'<link name="{attack}"/></robot>'
            ).encode()
            browser.send(start(upload, answer, len(content)) | {"filename": "r.xacro"})
            browser.send(part(upload, answer, 0, content))
            browser.hear(note(answer))


def test_browsers_that_die_amid_an_upload_leave_room_for_others(simulation):
    size = 2 * uploads.PART_BYTES
    for _ in range(uploads.MOST_AT_ONCE + 1):
        with browsing(simulation.port) as browser:
            browser.look()
            upload = browser.control("Open a file")
            browser.send(start(upload, "half", size))
            browser.send(part(upload, "half", 0, bytes(uploads.PART_BYTES)))
            browser.hear(lambda m: m["type"] == "FileTransferPartAck")
            browser.link.socket.shutdown(socket.SHUT_RDWR)
    with browsing(simulation.port) as browser:
        browser.look()
        upload = browser.control("Open a file")
        browser.send(start(upload, "ball", len(BALL)))
        browser.send(part(upload, "ball", 0, BALL))
        browser.hear(note("ball was added to the world"))
        simulation.process.kill()
        with pytest.raises(ConnectionClosed):
            browser.hear(lambda _: False)
    out, _ = simulation.process.communicate(timeout=60)
    assert out.count("Traceback") == 0


REASONS = ("20 MB", "does not match", "wrong size", "already uploading")


@pytest.mark.wording
def test_why_uploads_are_refused_is_said(simulation):
    use_up(simulation, [note(each) for each in REASONS])


def test_uploads_are_bounded_while_they_arrive(simulation):
    use_up(simulation, [nth(note(UPLOAD_REFUSED.number), count) for count in range(1, 5)])


def use_up(simulation, refusals):
    """Uploads whatever is refused; the notes of the first ones are `refusals`."""
    large, false, longer, second = refusals
    with browsing(simulation.port) as browser:
        browser.look()
        upload = browser.control("Open a file")
        whole = bytes(uploads.PART_BYTES)
        browser.send(start(upload, "large", uploads.MOST_BYTES + 1))
        browser.hear(large)
        # Its button waits for the end, and the note of its progress for being taken away.
        browser.hear(ended("large"))
        browser.hear(hidden("large"))
        for index in range(200):
            browser.send(part(upload, "large", index, whole))
        browser.send(start(upload, "lies", 10, parts=1000))
        browser.hear(false)
        # It announces little and sends much.
        browser.send(start(upload, "more", 10))
        browser.send(part(upload, "more", 0, whole))
        browser.hear(longer)
        browser.hear(ended("more"))
        browser.send(start(upload, "first", 2 * len(whole)))
        browser.send(start(upload, "second", 2 * len(whole)))
        browser.hear(second)
        browser.send(part(upload, "first", 0, whole))
        browser.send(part(upload, "first", 0, whole))
        browser.send(start(upload, "ball", len(BALL)))
        browser.send(part(upload, "ball", 0, BALL))
        browser.hear(note("ball was added to the world"))
    simulation.process.terminate()
    out, _ = simulation.process.communicate(timeout=60)
    assert "Traceback" not in out
    assert "malformed" not in out
