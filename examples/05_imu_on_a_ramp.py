"""Tell the slope of a ramp from what the IMU feels on it."""

import math

import cartwheel as cw

SLOPE = math.radians(12)

world = cw.World("empty")
world.spawn("ramp", x=4.0)
cart = world.spawn("rosbots.xacro")
imu = world.mailbox("/imu/data")
cart.publish("/part2_cmr/cmd_vel", linear_x=0.5)

steepest = 0.0
while world.time < 8 and cart.pose.x < 2.8:
    world.run(seconds=0.1)
    for reading in imu.drain():
        # On a slope a part of gravity's reaction points forward.
        forward, up = reading.linear_acceleration.x, reading.linear_acceleration.z
        steepest = max(steepest, math.atan2(forward, up))

print(f"the ramp rises by {math.degrees(SLOPE):.1f} degrees, felt {math.degrees(steepest):.1f}")
assert abs(cart.pose.rpy[1] + SLOPE) < math.radians(2)
