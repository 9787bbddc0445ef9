"""Look through the cart's camera at a red post, and save the picture."""

from PIL import Image

import cartwheel as cw

world = cw.World("post")
world.spawn("rosbots.xacro")
images = world.mailbox("/rosbots/camera1/image_raw", size=1)
world.run(seconds=1)

image = images.get(timeout=0)
assert image is not None, "no image: cameras require OpenGL, see world.diagnostics"
pixels = image.data.reshape(image.height, image.width, 3)
Image.fromarray(pixels).save("camera.png")

red, green, blue = pixels[image.height // 2, image.width // 2].tolist()
print(f"{image.width} x {image.height}, the middle is ({red}, {green}, {blue})")
print("saved camera.png")
assert red > 2 * max(green, blue)
