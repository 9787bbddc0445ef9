"""The pixels of a point: of the camera matrix, of the image and of the point cloud."""

import numpy as np
import pytest

import cartwheel as cw

CAMERA = """<camera><horizontal_fov>1.2</horizontal_fov>
<image><width>161</width><height>120</height><format>R8G8B8</format></image>
<clip><near>0.05</near><far>20</far></clip></camera>"""
CLASSIC = f"""<sensor name="eye" type="depth"><update_rate>20</update_rate>{CAMERA}
<plugin name="eye" filename="libgazebo_ros_depth_camera.so"><cameraName>eye</cameraName>
<imageTopicName>image</imageTopicName><cameraInfoTopicName>camera_info</cameraInfoTopicName>
<depthImageTopicName>depth_image</depthImageTopicName>
<pointCloudTopicName>points</pointCloudTopicName><frameName>optical</frameName>
<pointCloudCutoff>0.05</pointCloudCutoff></plugin></sensor>"""
GZ = f"""<sensor name="eye" type="rgbd_camera"><update_rate>20</update_rate>{CAMERA}
<topic>eye</topic></sensor>"""
ROBOT = """<robot name="eye"><link name="world"/><link name="base"/>
<joint name="base" type="fixed"><parent link="world"/><child link="base"/>
<origin xyz="0 0 1"/></joint>
<gazebo reference="base">{}</gazebo></robot>"""
BALL = """<sdf version="1.9"><model name="ball"><static>true</static><link name="ball">
<visual name="ball"><geometry><sphere><radius>0.05</radius></sphere></geometry><material>
<ambient>1 0 0 1</ambient><diffuse>1 0 0 1</diffuse><emissive>1 0 0 1</emissive></material></visual>
</link></model></sdf>"""


@pytest.mark.parametrize(("sensor", "first"), [(CLASSIC, 1.0), (GZ, 0.5)], ids=["classic", "gz"])
def test_a_point_is_at_its_pixel(sensor: str, first: float) -> None:
    point = np.array([2.0, 0.4, -0.2])  # x forward, y left, z up
    with cw.World("empty") as world:
        world.spawn(ROBOT.format(sensor))
        names = ("image", "camera_info", "points")
        image, information, points = (world.topic(f"/eye/{name}") for name in names)
        world.run(0.1)
        before = cw.image(image.latest).astype(int)
        world.spawn(BALL, x=point[0], y=point[1], z=1.0 + point[2])
        world.run(0.1)
        info, cloud = information.latest, cw.cloud(points.latest)
        matrix = cw.camera_matrix(info)
        size = np.array([info.width, info.height])
        assert (matrix[:2, 2] - (size - 1) / 2).tolist() == [first, first]
        seen = matrix @ (-point[1], -point[2], point[0])
        expected = seen[:2] / seen[2] - first
        darker = before - cw.image(image.latest)
        rows, columns = np.nonzero(darker[..., 1] > 60)
        assert rows.size > 20
        # The ball has a radius of 3 pixels; a mistake of half a pixel is visible.
        assert (columns.mean(), rows.mean()) == pytest.approx(expected, abs=0.2)
        optical = cloud if first == 1.0 else cloud[..., [1, 2, 0]] * (-1, -1, 1)
        row, column = np.mgrid[: info.height, : info.width]
        known = np.isfinite(optical).all(axis=-1)
        assert known.sum() > 1000
        seen = optical[known] @ matrix.T
        pixels = seen[:, :2] / seen[:, 2:] - first
        assert pixels == pytest.approx(np.stack([column, row], axis=-1)[known], abs=1e-3)
