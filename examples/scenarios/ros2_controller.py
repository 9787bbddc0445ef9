"""A node of ROS 2 without ROS: drives to x = 1.5 m, with a command for each 0.1 s of odometry."""

from cartwheel.msgs.geometry_msgs import Twist
from cartwheel.msgs.nav_msgs import Odometry
from cartwheel.testing import Node

TARGET, FASTEST, PERIOD_NS = 1.5, 0.5, 100_000_000


def main() -> None:
    with Node("controller") as node:
        drive = node.advertise("/part2_cmr/cmd_vel", Twist)

        def take(odometry: Odometry) -> None:
            if odometry.header.stamp.nanosec % PERIOD_NS == 0:
                drive.publish(linear_x=min(FASTEST, TARGET - odometry.pose.pose.position.x))

        node.subscribe("/odom", take, type=Odometry)
        node.spin()


main()
