"""Reset a world, drive again, and get the same bits: what makes a test of a robot reliable."""

import cartwheel as cw


def drive(world: cw.World, cart: cw.Model) -> tuple[float, ...]:
    """Three seconds of a curve; where it ends."""
    cart.publish("/part2_cmr/cmd_vel", linear_x=0.5, angular_z=0.4)
    world.run(seconds=3)
    return (*cart.pose.position, *cart.pose.orientation)


with cw.World("walls", seed=1) as world:
    cart = world.spawn("rosbots.xacro")
    first = drive(world, cart)
    world.reset()
    second = drive(world, cart)

with cw.World("walls", seed=1) as another:
    third = drive(another, another.spawn("rosbots.xacro"))

print(f"it ends at x {first[0]:.6f}, y {first[1]:.6f}, three times")
assert first == second == third
