"""Tell the slope of a ramp from what the IMU feels on it."""

import math

import cartwheel as cw

SLOPE = math.radians(12)

world = cw.World("empty")
world.spawn("ramp", x=4.0)
cart = world.spawn("rosbots.xacro")
imu = world.mailbox("/imu/data")
cart.publish("/part2_cmr/cmd_vel", linear_x=0.5)

# The ramp begins at x = 1.9; from 2.2 on the cart is on it with wheels and caster.
slopes: list[float] = []
while cart.pose.x < 2.6:
    world.run(seconds=0.1)
    readings = imu.drain()
    if cart.pose.x > 2.2:
        # On a slope a part of gravity's reaction points forward.
        slopes += [math.atan2(r.linear_acceleration.x, r.linear_acceleration.z) for r in readings]

felt = sum(slopes) / len(slopes)
print(f"the ramp rises by {math.degrees(SLOPE):.1f} degrees, felt are {math.degrees(felt):.1f}")
assert abs(felt - SLOPE) < math.radians(1)
