"""Drive the shipped cart along a circle and see whether it comes back."""

import math

import cartwheel as cw

SPEED, TURN = 0.4, 0.4

world = cw.World("empty")
cart = world.spawn("rosbots.xacro")
cart.publish("/part2_cmr/cmd_vel", linear_x=SPEED, angular_z=TURN)

farthest = 0.0
for second in range(round(2 * math.pi / TURN) + 1):
    world.run(seconds=1)
    farthest = max(farthest, math.hypot(cart.pose.x, cart.pose.y))
    print(
        f"{second + 1:3d} s  x {cart.pose.x:6.3f}  y {cart.pose.y:6.3f}  yaw {cart.pose.yaw:6.3f}"
    )

print(f"the circle is {farthest:.2f} m wide; v / w says {2 * SPEED / TURN:.2f} m")
assert abs(farthest - 2 * SPEED / TURN) < 0.1
