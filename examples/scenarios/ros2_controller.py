"""A node of ROS 2 without ROS: drives to x = 1.5 m, with a command for each 0.1 s of odometry."""

import os
import signal

from cartwheel.bridges.loop import Loop
from cartwheel.messages import decode_cdr, encode_cdr, from_dict
from rtps_lite.discovery import EndpointQos
from rtps_lite.network import Reach
from rtps_lite.participant import Participant
from rtps_lite.reader import Taken

TARGET, FASTEST, PERIOD_NS = 1.5, 0.5, 100_000_000


def main() -> None:
    loop = Loop(print, name="controller")
    loop.start()

    def connect() -> None:
        participant = Participant(
            loop,
            domain=int(os.environ.get("ROS_DOMAIN_ID", "0")),
            reach=Reach(),
            name="controller",
            user_data=b"enclave=/;",
            warn=print,
        )
        participant.start()
        qos = EndpointQos(reliable=True)
        writer = participant.writer("rt/part2_cmr/cmd_vel", "geometry_msgs::msg::dds_::Twist_", qos)

        def take(sample: Taken) -> None:
            odometry = decode_cdr(bytes(sample.payload), "nav_msgs/msg/Odometry")
            if odometry.header.stamp.nanosec % PERIOD_NS == 0:
                speed = min(FASTEST, TARGET - odometry.pose.pose.position.x)
                twist = from_dict("geometry_msgs/msg/Twist", {"linear": {"x": speed}})
                writer.write(encode_cdr(twist))

        participant.reader("rt/odom", "nav_msgs::msg::dds_::Odometry_", qos, take)

    loop.call(connect).result(60)
    signal.sigwait({signal.SIGINT, signal.SIGTERM})


signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGTERM})
main()
