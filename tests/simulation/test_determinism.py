"""The same seed and commands give the same bits, however the run is cut, paced or watched."""

import dataclasses
import hashlib
import subprocess
import sys

import numpy as np
import pytest

from cartwheel.geometry import Pose
from cartwheel.simulation.pacing import Pacer

SECONDS = 60
COMMANDS = [(1.0, 0.5, 0.0), (8.0, 0.5, 0.3), (20.0, 0.0, -0.5), (32.0, 0.4, 0.4), (50.0, 0.0, 0.0)]
"""s, m/s and rad/s: it turns, bumps into the post and shoves it."""
TOPICS = ("/odom", "/imu/data", "/joint_states", "/bumpers", "/tf", "/rosbots/camera1/image_raw")


def noisy(make, robot):
    """The cart with a noisy IMU and a picture every two seconds."""
    robot = make.with_parameters(robot, "imu_plugin", gaussianNoise="0.05")
    return make.with_sensors(
        robot,
        lambda sensor: dataclasses.replace(sensor, update_rate=0.5) if sensor.cameras else sensor,
    )


class Run:
    """A world with the cart and a post, and a digest of everything that it publishes."""

    def __init__(self, make, robot, *, seed=3, extra=()):
        post = make.box(
            "post", (0.3, 0.3, 0.8), mass=10, mu=0.4, pose=Pose((4.0, 0.1, 0.4)), colour=(1, 0, 0)
        )
        self.world = make.world(post, *extra, seed=seed)
        self.world.session.spawn(noisy(make, robot), pose=Pose((0, 0, 0.05)))
        self.simulation = self.world.session.simulation
        self.digests = {topic: hashlib.sha256() for topic in TOPICS}
        self.counts = dict.fromkeys(TOPICS, 0)
        self.states = hashlib.sha256()
        for topic in TOPICS:
            self.world.subscribe(topic, self._add(topic))
        self.simulation.schedule(10, after=self._state, active=lambda: True)
        self.commanded = 0
        # Commands come at simulated times, as those of a bag or a node that follows /clock.
        self.simulation.schedule(100, before=self._command)

    def _add(self, topic):
        from cartwheel.messages import encode_cdr

        def add(message):
            self.digests[topic].update(encode_cdr(message))
            self.counts[topic] += 1

        return add

    def _state(self):
        data = self.simulation.data
        for model in ("rosbots::base_footprint", "post::link"):
            joint = data.joint(model)
            self.states.update(np.concatenate([joint.qpos, joint.qvel]).tobytes())

    def _command(self):
        from cartwheel.messages import from_dict

        if self.commanded < len(COMMANDS):
            when, forward, turn = COMMANDS[self.commanded]
            if self.simulation.time_ns >= round(when * 1e9):
                twist = from_dict(
                    "geometry_msgs/msg/Twist", {"linear": {"x": forward}, "angular": {"z": turn}}
                )
                self.world.graph.publish("/part2_cmr/cmd_vel", "geometry_msgs/msg/Twist", twist)
                self.commanded += 1

    def restart(self):
        self.commanded = 0
        self.counts = dict.fromkeys(TOPICS, 0)
        self.digests.update({topic: hashlib.sha256() for topic in TOPICS})
        self.states = hashlib.sha256()

    def result(self):
        return {
            "states": self.states.hexdigest(),
            "counts": dict(self.counts),
            **{topic: digest.hexdigest() for topic, digest in self.digests.items()},
        }


@pytest.fixture(scope="module")
def plain(make_once, rosbots):
    """What one uninterrupted run gives."""
    run = Run(make_once, rosbots)
    run.world.run(SECONDS)
    result = run.result()
    # It is worth comparing: it moved, hit the post, saw and shook.
    assert result["counts"]["/odom"] == 100 * SECONDS + 1
    assert result["counts"]["/rosbots/camera1/image_raw"] == SECONDS / 2 + 1
    assert run.world.model("post").pose.x > 4.05
    return result


def test_cut_into_pieces(make, rosbots, plain):
    run = Run(make, rosbots)
    pieces = [0.005, 0.015, 0.1, 0.335, 1.0, 2.25]
    index = 0
    while (left := round(SECONDS * 1e9) - run.simulation.time_ns) > 0:
        run.world.run(min(pieces[index % len(pieces)], left / 1e9))
        # Looking between steps changes nothing.
        _ = run.world.model("rosbots").pose
        run.simulation.snapshot()
        index += 1
    assert run.result() == plain


def test_paced_and_watched(make, rosbots, plain):
    """At twenty times real time, with a listener, and extra readers that come and go."""
    run = Run(make, rosbots)
    run.simulation.set_speed(20.0)
    pacer = Pacer(run.simulation, until_ns=SECONDS * 1_000_000_000)
    seen, guests = [], []

    def watch(snapshot):
        seen.append(snapshot.time_ns)
        if guests:
            guests.pop().close()
        else:
            guests.append(run.world.mailbox(TOPICS[len(seen) % len(TOPICS)]))

    pacer.add_listener(watch, rate=50.0)
    pacer.run()
    run.simulation.complete()
    assert len(seen) > 50
    assert run.result() == plain


def test_after_a_reset(make, rosbots, plain):
    run = Run(make, rosbots)
    run.world.run(13.37)
    run.world.reset()
    run.restart()
    run.world.run(SECONDS)
    assert run.result() == plain


def test_another_model_far_away_changes_no_noise(make, rosbots):
    """And nothing of what the others do."""
    far = make.box("far", (1, 1, 1), pose=Pose((-500, 300, 0.5)))
    readings = []
    for extra in ((), (far,)):
        run = Run(make, rosbots, extra=extra)
        reported = []
        run.world.subscribe("/imu/data", reported.append)
        run.world.run(6.0)
        readings.append(
            [
                [
                    getattr(getattr(message, vector), axis)
                    for vector in ("angular_velocity", "linear_acceleration")
                    for axis in "xyz"
                ]
                for message in reported
            ]
        )
    alone, beside = map(np.array, readings)
    assert alone.std(axis=0).min() > 0.04, "no noise to compare"
    # The physics may round otherwise with more bodies to solve for; noise drawn otherwise would
    # differ by 0.07.
    assert np.abs(alone - beside).max() < 1e-6


def test_another_seed_is_another_run(make, rosbots, plain):
    run = Run(make, rosbots, seed=4)
    run.world.run(SECONDS)
    result = run.result()
    assert result["/imu/data"] != plain["/imu/data"]
    # Only what is noisy differs.
    assert result["states"] == plain["states"]
    assert result["/rosbots/camera1/image_raw"] == plain["/rosbots/camera1/image_raw"]


SCRIPT = """
import hashlib, sys
import cartwheel as cw
from cartwheel.messages import encode_cdr
world = cw.World("post", seed=5)
world.spawn("rosbots.xacro", z=0.1)
digest = hashlib.sha256()
topics = ("/odom", "/imu/data", "/bumpers", "/rosbots/camera1/image_raw")
for topic in topics[:3]:
    world.subscribe(topic, lambda message: digest.update(encode_cdr(message)))
for k in range(12):
    world.publish("/part2_cmr/cmd_vel", linear_x=0.1 * (k % 6), angular_z=0.2 * (k % 3 - 1))
    box = world.mailbox(topics[3], size=1)
    world.run(5.0)
    for image in box.drain():
        digest.update(image.data.tobytes())
    box.close()
print(digest.hexdigest())
"""


def test_two_fresh_processes():
    """Sixty seconds each, with pictures; hash seeds differ from process to process."""
    runs = [
        subprocess.Popen(
            [sys.executable, "-c", SCRIPT],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        for _ in range(2)
    ]
    outputs = [run.communicate(timeout=120) for run in runs]
    assert outputs[0][0] == outputs[1][0]
    assert len(outputs[0][0].strip()) == 64, outputs[0][1]
