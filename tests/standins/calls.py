"""A call of each macro of the stand-ins, with the frames and topics that it makes.

Positions are relative to ``base_link``. They are those of the original packages.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from cartwheel.geometry import Vec3

ORIGIN = '<origin xyz="0.1 0 0.2"/>'


@dataclass(frozen=True)
class Call:
    """A macro call below ``<robot>``."""

    file: str
    """As a user includes it: the package, and the path in it."""
    text: str
    frames: dict[str, Vec3]
    """Positions of links, in m."""
    topics: dict[str, str] = field(default_factory=dict)
    """Frame ID of the messages on each topic."""
    hung: str = ""
    """The link that the robot itself attaches to ``base_link`` at `ORIGIN`."""
    optical: tuple[str, ...] = ()
    """Links whose z axis is the x axis of ``base_link``, and whose x axis is its -y axis."""

    def __str__(self) -> str:
        """The test's name."""
        return self.text.split(">")[0].replace("<xacro:", "").replace('"', "")[:80]


def on_base(macro: str, attributes: str = "") -> str:
    """A macro that attaches itself to a parent with an origin."""
    return f'<xacro:{macro} parent="base_link" {attributes}>{ORIGIN}</xacro:{macro}>'


def _realsense(
    name: str, eyes: dict[str, Vec3], *, imu: bool = False, infra: str = "infra1"
) -> dict[str, str]:
    """The topics of a RealSense camera with these lenses."""
    topics = {
        f"/{name}/depth/image_rect_raw": f"{name}_depth_optical_frame",
        f"/{name}/depth/camera_info": f"{name}_depth_optical_frame",
        f"/{name}/depth/color/points": f"{name}_depth_optical_frame",
        f"/{name}/{infra}/image_rect_raw": f"{name}_depth_optical_frame",
    }
    if f"{name}_color_frame" in eyes:
        topics[f"/{name}/color/image_raw"] = f"{name}_color_optical_frame"
        topics[f"/{name}/color/camera_info"] = f"{name}_color_optical_frame"
        if infra == "infra1":
            topics[f"/{name}/infra2/image_rect_raw"] = f"{name}_infra2_optical_frame"
    if imu:
        topics[f"/{name}/accel/sample"] = f"{name}_accel_optical_frame"
        topics[f"/{name}/gyro/sample"] = f"{name}_gyro_optical_frame"
    return topics


def _realsenses() -> list[Call]:
    calls = []
    link = {
        "d405": (0.11085, 0.009, 0.221),
        "d415": (0.1, 0.02, 0.2115),
        "d435": (0.1106, 0.0175, 0.2125),
        "d435i": (0.1106, 0.0175, 0.2125),
        "d455": (0.11115, 0.0475, 0.2145),
    }
    # The y coordinates of the second infrared lens and of the colour lens, seen from the depth lens.
    lenses = {
        "d405": (-0.018, 0.0),
        "d415": (-0.055, 0.015),
        "d435": (-0.05, 0.015),
        "d435i": (-0.05, 0.015),
        "d455": (-0.095, -0.059),
    }
    imus = {"d435i": (-0.01174, -0.00552, 0.0051), "d455": (-0.01602, -0.03022, 0.0074)}
    for model, at in link.items():
        x, y, z = at
        for name, nominal in (("camera", ""), ("eye", 'use_nominal_extrinsics="true"')):
            infra2, color = lenses[model]
            frames = {
                f"{name}_bottom_screw_frame": (0.1, 0.0, 0.2),
                f"{name}_link": at,
                f"{name}_depth_frame": at,
                f"{name}_infra1_frame": at,
                f"{name}_infra2_frame": (x, y + infra2, z),
                f"{name}_color_frame": (x, y + color, z),
            }
            if model in imus:
                dx, dy, dz = imus[model]
                frames[f"{name}_accel_frame"] = (x + dx, y + dy, z + dz)
                frames[f"{name}_gyro_frame"] = (x + dx, y + dy, z + dz)
            calls.append(
                Call(
                    f"realsense2_description/urdf/_{model}.urdf.xacro",
                    on_base(f"sensor_{model}", f'name="{name}" {nominal}'),
                    frames,
                    _realsense(name, frames, imu=model in imus),
                    optical=tuple(f"{name}_{eye}_optical_frame" for eye in ("depth", "color")),
                )
            )
    eye = (0.1075, 0.0, 0.22115)
    frames = {"camera_link": eye, "camera_color_frame": (0.1075, 0.0, 0.24515)}
    calls.append(
        Call(
            "realsense2_description/urdf/_l515.urdf.xacro",
            on_base("sensor_l515"),
            {
                **frames,
                "camera_infra_frame": eye,
                "camera_lower_mount": (0.086, 0.0, 0.21015),
                "camera_upper_mount": (0.086, 0.0, 0.25015),
                "camera_gyro_frame": (0.1034, -0.01298, 0.24771),
            },
            _realsense("camera", frames, imu=True, infra="infra"),
            optical=("camera_depth_optical_frame", "camera_color_optical_frame"),
        )
    )
    for model, y, z, half in (("r410", -0.0425, 0.226, 0.0275), ("r430", -0.035, 0.228, 0.025)):
        frames = {
            "camera_link": (0.1, 0.0, 0.2),
            "camera_depth_frame": (0.1, y, z),
            "camera_infra1_frame": (0.1, y - half, z),
            "camera_infra2_frame": (0.1, y + half, z),
        }
        calls.append(
            Call(
                f"realsense2_description/urdf/_{model}.urdf.xacro",
                on_base(f"sensor_{model}"),
                frames,
                _realsense("camera", frames),
                optical=("camera_infra2_optical_frame",),
            )
        )
    calls.append(
        Call(
            "realsense2_camera/urdf/_d435.urdf.xacro",
            on_base("sensor_d435", 'add_plug="true" use_mesh="false"'),
            {"camera_link": link["d435"], "camera_usb_plug_link": (0.10455, -0.0353, 0.2125)},
            {"/camera/color/image_raw": "camera_color_optical_frame"},
        )
    )
    return calls


def _lasers() -> list[Call]:
    calls = []
    for model, height in (("VLP-16", 0.0377), ("HDL-32E", 0.09081), ("VLP-32C", 0.0377)):
        file = f"velodyne_description/urdf/{model}.urdf.xacro"
        frames = {"velodyne_base_link": (0.1, 0.0, 0.2), "velodyne": (0.1, 0.0, 0.2 + height)}
        calls.append(
            Call(file, f"<xacro:{model}>{ORIGIN}</xacro:{model}>", frames,
                 {"/velodyne_points": "velodyne"})
        )  # fmt: skip
    calls.append(
        Call(
            "velodyne_description/urdf/VLP-16.urdf.xacro",
            on_base("VLP-16", 'name="top" topic="/top/points" hz="20" lasers="4" samples="90" '
                    'min_angle="-1" max_angle="0.5" gpu="true" organize_cloud="true"'),
            {"top": (0.1, 0.0, 0.2377)},
            {"/top/points": "top"},
        )
    )  # fmt: skip
    for model in ("OS0-32", "OS0-64", "OS0-128", "OS1-16", "OS1-32", "OS1-64", "OS1-128"):
        calls.append(
            Call(
                f"ouster_description/urdf/{model}.urdf.xacro",
                f'<xacro:{model} samples="64">{ORIGIN}</xacro:{model}>',
                {
                    "os_sensor_baseplate": (0.1, 0.0, 0.208),
                    "os_sensor": (0.1, 0.0, 0.25),
                    "os_lidar": (0.1, 0.0, 0.25),
                    "os_imu": (0.106253, -0.011775, 0.257645),
                },
                {"/ouster/points": "os_lidar", "/ouster/imu": "os_imu"},
            )
        )
    lms = "lms1xx/urdf/sick_lms1xx.urdf.xacro"
    laser = {"laser": (0.1, 0.0, 0.2)}
    calls += [
        Call(lms, "<xacro:sick_lms1xx/>", laser, {"/scan": "laser"}, hung="laser"),
        Call(
            lms,
            '<xacro:sick_lms1xx topic="back" sample_size="11" robot_namespace="/r/"/>',
            laser,
            {"/r/back": "laser"},
            hung="laser",
        ),
    ]
    for model, height in (("tim310", 0.05595), ("tim551", 0.06296), ("tim571", 0.06296)):
        calls.append(
            Call(
                "sick_tim/urdf/sick_tim.urdf.xacro",
                f'<xacro:sick_{model} name="laser" ros_topic="scan"/>',
                {"laser": (0.1, 0.0, 0.2 + height)},
                {"/scan": "laser"},
                hung="laser_mount_link",
            )
        )
    calls.append(
        Call(
            "sick_tim/urdf/sick_mrs1000.urdf.xacro",
            '<xacro:sick_mrs1000 name="laser" ros_topic="cloud"/>',
            {"laser": (0.1, 0.0, 0.2658)},
            {"/cloud": "laser"},
            hung="laser_mount_link",
        )
    )
    return calls


def _cameras() -> list[Call]:
    calls = []
    for model in ("flir_blackflys", "flir_blackfly_s"):
        calls.append(
            Call(
                f"flir_camera_description/urdf/{model}.urdf.xacro",
                f'<xacro:{model} frame="eye" name="front" fps="20" width="64" height="48"/>',
                {"eye_lens": (0.12685, 0.0, 0.21425), "eye_optical": (0.16685, 0.0, 0.21425)},
                {"/front/image_raw": "eye_optical", "/front/camera_info": "eye_optical"},
                hung="eye",
                optical=("eye_optical",),
            )
        )
    calls.append(
        Call(
            "pointgrey_camera_description/urdf/pointgrey_flea3.urdf.xacro",
            '<xacro:pointgrey_flea3 fps="20"/>',
            {"camera_optical": (0.1, 0.0, 0.2)},
            {"/camera/image_raw": "camera_optical"},
            hung="camera",
            optical=("camera_optical",),
        )
    )
    for kind in ("03S2C", "08S2C"):
        for focal in (25, 38, 60):
            calls.append(
                Call(
                    "pointgrey_camera_description/urdf/pointgrey_bumblebee2.urdf.xacro",
                    f"<xacro:BB2-{kind}-{focal}/>",
                    {"bumblebee_optical": (0.1, 0.0, 0.2)},
                    {
                        "/bumblebee/left/image_raw": "bumblebee_optical",
                        "/bumblebee/right/camera_info": "bumblebee_optical",
                    },
                    hung="bumblebee",
                    optical=("bumblebee_optical",),
                )
            )
    return calls


def _hector() -> list[Call]:
    folder = "hector_sensors_description/urdf"
    calls = []
    for model, depth, rgb in (("asus", 0.049, 0.022), ("kinect", -0.02, -0.0125)):
        calls.append(
            Call(
                f"{folder}/{model}_camera.urdf.xacro",
                on_base(f"{model}_camera", 'name="cam"'),
                {
                    "cam_link": (0.1, 0.0, 0.2),
                    "cam_depth_frame": (0.1, depth, 0.2),
                    "cam_rgb_frame": (0.1, rgb, 0.2),
                },
                dict.fromkeys(
                    ("/cam/rgb/image_raw", "/cam/depth/image_raw", "/cam/depth/points"),
                    "cam_depth_optical_frame",
                ),
                optical=("cam_depth_optical_frame", "cam_rgb_optical_frame"),
            )
        )
    scan = 'name="h" ros_topic="scan" update_rate="30" ray_count="1040" '
    for end in ("", "_gpu"):
        calls.append(
            Call(
                f"{folder}/hokuyo_utm30lx.urdf.xacro",
                on_base(f"hokuyo_utm30lx{end}", f'{scan} min_angle="130" max_angle="-130"'),
                {"h_frame": (0.1, 0.0, 0.2)},
                {"/scan": "h_frame"},
            )
        )
    calls += [
        Call(
            f"{folder}/generic_camera.urdf.xacro",
            on_base(
                "generic_camera",
                'name="cam" ros_topic="camera/image" cam_info_topic="camera/camera_info" '
                'update_rate="20" res_x="64" res_y="48" image_format="L8" hfov="100"',
            ),
            {"cam_link": (0.1, 0.0, 0.2)},
            {"/cam/camera/image": "cam_optical_frame", "/cam/camera/camera_info": "cam_optical_frame"},
            optical=("cam_optical_frame",),
        ),
        Call(
            f"{folder}/sonar_sensor.urdf.xacro",
            on_base(
                "sonar_sensor",
                'name="sonar" ros_topic="height" update_rate="10" min_range="0.03" max_range="3" '
                'field_of_view="${40*pi/180}" ray_count="3"',
            ),
            {"sonar_link": (0.1, 0.0, 0.2)},
            {"/height": "sonar_link"},
        ),
        Call(
            f"{folder}/vlp16.urdf.xacro",
            on_base("vlp16", 'name="v" ros_topic="points"'),
            {"v_frame": (0.1, 0.0, 0.2)},
            {"/points": "v_frame"},
        ),
    ]
    return calls


def _oaks() -> list[Call]:
    pose = " ".join(
        f'cam_{name}="{value}"'
        for name, value in {"pos_x": 0.1, "pos_y": 0, "pos_z": 0.2, "roll": 0, "pitch": 0, "yaw": 0}.items()
    )
    macro = '<xacro:depthai_camera camera_name="oak" camera_model="{}" parent="base_link" base_frame="oak_frame" {} rs_compat="{}"/>'
    calls = []
    for model, left, right, imu in (
        ("OAK-D", 0.0375, -0.0375, (0.1, -0.015, 0.186338)),
        ("OAK-D-PRO", 0.0375, -0.0375, (0.092, -0.037945, 0.19921)),
        ("OAK-D-LITE", 0.0375, -0.0375, None),
        ("OAK-D-PRO-W", 0.0375, -0.0375, None),
        ("OAK-D-LR", 0.1, -0.05, None),
        ("OAK-D-SR", 0.01, -0.01, None),
        ("OAK-9", 0.0375, -0.0375, None),
    ):
        for compatible in (False, True):
            sides = ("infra2", "infra1", "color") if compatible else ("left", "right", "rgb")
            end = "" if compatible else "_camera"
            frames = {
                "oak_frame": (0.1, 0.0, 0.2),
                f"oak_{sides[0]}{end}_frame": (0.1, left, 0.2),
                f"oak_{sides[1]}{end}_frame": (0.1, right, 0.2),
            }
            lenses = sides[:2] if model == "OAK-D-SR" else sides
            topics = {f"/oak/{s}/image_raw": f"oak_{s}{end}_optical_frame" for s in lenses}
            depth = "depth" if compatible else "stereo"
            main = sides[1] if model == "OAK-D-SR" else sides[2]
            topics[f"/oak/{depth}/image_raw"] = f"oak_{main}{end}_optical_frame"
            topics["/oak/points"] = f"oak_{main}{end}_optical_frame"
            if imu is not None:
                frames["oak_imu_frame"] = imu
                topics["/oak/imu/data"] = "oak_imu_frame"
            calls.append(
                Call(
                    "depthai_descriptions/urdf/include/depthai_macro.urdf.xacro",
                    macro.format(model, pose, str(compatible).lower()),
                    frames,
                    topics,
                    optical=tuple(f"oak_{side}{end}_optical_frame" for side in lenses),
                )
            )
    return calls


def _zeds() -> list[Call]:
    file = "zed_wrapper/urdf/zed_macro.urdf.xacro"
    calls = []
    for model, x, half, z in (
        ("zed", -0.01, 0.06, 0.015),
        ("zed2", -0.01, 0.06, 0.015),
        ("zed2i", -0.01, 0.06, 0.015),
        ("zedm", 0.0, 0.0315, 0.01325),
        ("zedx", -0.01, 0.06, 0.016),
        ("zedxm", -0.01, 0.025, 0.016),
    ):
        # The lenses of the older models look down by 0.05 rad.
        slope = 0.05 if model in ("zed", "zed2") else 0.0
        at = (0.1 + x, half, 0.2 + z - slope * x)
        topics = {
            "/zed/zed_node/left/image_rect_color": "zed_left_camera_frame_optical",
            "/zed/zed_node/right/image_rect_color": "zed_right_camera_frame_optical",
            "/zed/zed_node/depth/depth_registered": "zed_left_camera_frame_optical",
            "/zed/zed_node/point_cloud/cloud_registered": "zed_left_camera_frame_optical",
        }
        if model != "zed":
            topics["/zed/zed_node/imu/data"] = "zed_imu_link"
        calls.append(
            Call(
                file,
                f'<xacro:zed_camera model="{model}" enable_gnss="true">{ORIGIN}</xacro:zed_camera>',
                {"zed_left_camera_frame": at, "zed_gnss_link": (0.2, 0.0, 0.4)},
                topics,
                hung="zed_camera_link",
            )
        )
    calls += [
        Call(
            file,
            on_base("zed_camera", 'name="eye" model="zed2i"'),
            {"eye_base_link": (0.1, 0.0, 0.2), "eye_right_camera_frame": (0.09, -0.06, 0.215)},
            {"/eye/zed_node/rgb/image_rect_color": "eye_left_camera_optical_frame"},
            optical=("eye_left_camera_optical_frame",),
        ),
        Call(
            file,
            on_base("zed_camera", 'model="virtual" custom_baseline="0.4"'),
            {"zed_left_camera_frame": (0.1, 0.2, 0.2155)},
        ),
        Call(
            file,
            '<xacro:zed_camera model="zedxonegs"><origin/></xacro:zed_camera>',
            {"zed_camera_frame": (0.1, 0.0, 0.2155)},
            {"/zed/zed_node/rgb/image_rect_color": "zed_camera_frame_optical"},
            hung="zed_camera_link",
            optical=("zed_camera_frame_optical",),
        ),
    ]
    return calls


def _robotnik() -> list[Call]:
    file = "robotnik_sensors/urdf/all_sensors.urdf.xacro"
    heights = {
        "hokuyo_ust10lx": 0.0474, "hokuyo_ust20lx": 0.0474, "hokuyo_utm30lx": 0.055,
        "hokuyo_urg04lx": 0.05315, "sick_tim551": 0.06246, "sick_tim571": 0.06246,
        "sick_s300": 0.116, "rplidar_a2": 0.03086,
    }  # fmt: skip
    calls = [
        Call(
            file,
            on_base(f"sensor_{model}", 'prefix="l" prefix_topic="rear" gpu="false"'),
            {"l_base_link": (0.1, 0.0, 0.2), "l_link": (0.1, 0.0, 0.2 + height)},
            {"/rear/scan": "l_link"},
        )
        for model, height in heights.items()
    ]
    here = (0.1, 0.0, 0.2)
    calls += [
        Call(
            file,
            on_base("sensor_orbbec_astra", 'prefix="rgbd" depth_offset_x="0.01"'),
            {
                "rgbd_rgb_frame": (0.1, 0.0125, 0.215),
                "rgbd_depth_frame": (0.1, 0.0375, 0.215),
                "rgbd_depth_optical_frame": (0.11, 0.0375, 0.215),
            },
            dict.fromkeys(
                ("/front_rgbd_camera/rgb/image_raw", "/front_rgbd_camera/depth/points"),
                "rgbd_depth_optical_frame",
            ),
            optical=("rgbd_depth_optical_frame", "rgbd_rgb_optical_frame"),
        ),
        Call(
            file,
            on_base("sensor_intel_d435", 'prefix="arm"'),
            {"arm_link": (0.11, 0.02, 0.2), "arm_color_frame": (0.11, 0.035, 0.2)},
            {"/robot/front_rgbd_camera/depth/image_raw": "arm_depth_optical_frame"},
        ),
        Call(file, on_base("sensor_imu", 'prefix="i"'), {"i_link": here}, {"/imu/data": "i_link"}),
        Call(
            file,
            on_base("sensor_imu_hector", 'prefix="i" topic="raw"'),
            {"i_link": here},
            {"/raw": "i_link"},
        ),
        Call(
            file, on_base("sensor_gps", 'prefix="g"'), {"g_base_link": here},
            {"/gps/fix": "g_base_link"},
        ),
        Call(
            file,
            on_base("sensor_gps_with_mast", 'prefix="g" gps_latitude="1" update_rate="10"'),
            {"g_mast_base_link": here, "g_base_link": (0.1, 0.0, 0.45)},
            {"/gps/fix": "g_base_link"},
        ),
        Call(
            file,
            on_base("sensor_axis", 'prefix="ptz"'),
            {"ptz_pan_link": here, "ptz_frame_link": here},
            {"/ptz/image_raw": "ptz_optical_frame_link"},
        ),
    ]  # fmt: skip
    return calls


def _components() -> list[Call]:
    folder = "ros_components_description/urdf"
    at = 'parent_link="base_link" xyz="0.1 0 0.2" rpy="0 0 0"'
    calls = []
    for model, height in (("a2", 0.031), ("a3", 0.031), ("s1", 0.04), ("s2", 0.0285), ("s3", 0.0305)):
        name = f"slamtec_rplidar_{model}"
        file = f"{folder}/{name}.urdf.xacro"
        calls += [
            Call(
                file,
                f"<xacro:{name} {at}/>",
                {f"{name}_link": (0.1, 0.0, 0.2), "laser": (0.1, 0.0, 0.2 + height)},
                {"/scan": "laser"},
            ),
            Call(
                file,
                f'<xacro:{name} {at} namespace="r" tf_prefix="t" topic="s" frame_id="scan_link"/>',
                {"t_scan_link": (0.1, 0.0, 0.2 + height)},
                {"/r/s": "t_scan_link"},
            ),
        ]
    calls += [
        Call(
            f"{folder}/orbbec_astra.urdf.xacro",
            f"<xacro:orbbec_astra {at}/>",
            {
                "camera_orbbec_astra_link": (0.1, 0.0, 0.2),
                "camera_color_frame": (-0.002, 0.0125, 0.03325),
                "camera_depth_frame": (0.0, 0.0, 0.03325),
            },
            {
                "/camera/color/image_raw": "camera_color_optical_frame",
                "/camera/depth/image_raw": "camera_depth_optical_frame",
                "/camera/depth/points": "camera_depth_optical_frame",
            },
            optical=("camera_depth_optical_frame",),
        ),
        Call(
            f"{folder}/velodyne_puck.urdf.xacro",
            f'<xacro:velodyne_puck {at} namespace="r"/>',
            {"velodyne": (0.1, 0.0, 0.2378)},
            {"/r/scan": "velodyne"},
        ),
        Call(
            f"{folder}/ouster_os1_32.urdf.xacro",
            f"<xacro:ouster_os1_32 {at}/>",
            {"os_lidar": (0.1, 0.0, 0.23618)},
            {"/os_lidar": "os_lidar"},
        ),
    ]
    return calls


CALLS = [
    *_realsenses(), *_lasers(), *_cameras(), *_hector(), *_oaks(), *_zeds(), *_robotnik(),
    *_components(),
]  # fmt: skip
