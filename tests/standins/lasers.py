"""Calls of the macros of lasers, and of packages with several kinds of sensors."""

from __future__ import annotations

from tests.standins.calls import ORIGIN, Call, on_base


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
    calls += [
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
        for model in ("OS0-32", "OS0-64", "OS0-128", "OS1-16", "OS1-32", "OS1-64", "OS1-128")
    ]
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
    calls += [
        Call(
            f"{folder}/hokuyo_utm30lx.urdf.xacro",
            on_base(f"hokuyo_utm30lx{end}", f'{scan} min_angle="130" max_angle="-130"'),
            {"h_frame": (0.1, 0.0, 0.2)},
            {"/scan": "h_frame"},
        )
        for end in ("", "_gpu")
    ]
    calls += [
        Call(
            f"{folder}/generic_camera.urdf.xacro",
            on_base(
                "generic_camera",
                'name="cam" ros_topic="camera/image" cam_info_topic="camera/camera_info" '
                'update_rate="20" res_x="64" res_y="48" image_format="L8" hfov="100"',
            ),
            {"cam_link": (0.1, 0.0, 0.2)},
            {
                "/cam/camera/image": "cam_optical_frame",
                "/cam/camera/camera_info": "cam_optical_frame",
            },
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
    for model, height in (
        ("a2", 0.031),
        ("a3", 0.031),
        ("s1", 0.04),
        ("s2", 0.0285),
        ("s3", 0.0305),
    ):
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


LASERS = [*_lasers(), *_hector(), *_robotnik(), *_components()]
