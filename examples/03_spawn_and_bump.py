"""Put a post in the cart's way, drive into it, and read the bumper."""

import cartwheel as cw

world = cw.World("empty")
cart = world.spawn("rosbots.xacro")
post = world.spawn("object.urdf", name="my_object", x=1.5)
bumper = world.mailbox("/bumpers")

cart.publish("/part2_cmr/cmd_vel", linear_x=0.3)
touched = None
while touched is None and world.time < 20:
    world.run(seconds=0.1)
    touched = next((message for message in bumper.drain() if message.states), None)

assert touched is not None, "the cart never reached the post"
state = touched.states[0]
print(f"at {cw.seconds(touched.header.stamp):.2f} s: {state.collision1_name}")
print(f"touches {state.collision2_name} with {state.total_wrench.force.x:.1f} N along x")
assert state.collision2_name.startswith("my_object::")

cart.publish("/part2_cmr/cmd_vel")
world.run(seconds=1)
post.delete()
print(f"what stands there now: {', '.join(world.models)}")
