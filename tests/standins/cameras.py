"""Calls of the macros of cameras."""

from __future__ import annotations

from tests.standins.calls import ORIGIN, Call, on_base

from cartwheel.geometry import Vec3


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
    # The y coordinates of the second infrared lens and of the colour lens.
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


def _cameras() -> list[Call]:
    calls = []
    calls += [
        Call(
            f"flir_camera_description/urdf/{model}.urdf.xacro",
            f'<xacro:{model} frame="eye" name="front" fps="20" width="64" height="48"/>',
            {"eye_lens": (0.12685, 0.0, 0.21425), "eye_optical": (0.16685, 0.0, 0.21425)},
            {"/front/image_raw": "eye_optical", "/front/camera_info": "eye_optical"},
            hung="eye",
            optical=("eye_optical",),
        )
        for model in ("flir_blackflys", "flir_blackfly_s")
    ]
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
    calls += [
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
        for kind in ("03S2C", "08S2C")
        for focal in (25, 38, 60)
    ]
    return calls


def _oaks() -> list[Call]:
    pose = " ".join(
        f'cam_{name}="{value}"'
        for name, value in {
            "pos_x": 0.1,
            "pos_y": 0,
            "pos_z": 0.2,
            "roll": 0,
            "pitch": 0,
            "yaw": 0,
        }.items()
    )
    macro = (
        '<xacro:depthai_camera camera_name="oak" camera_model="{}" parent="base_link" '
        'base_frame="oak_frame" {} rs_compat="{}"/>'
    )
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


CAMERAS = [*_realsenses(), *_cameras(), *_oaks(), *_zeds()]
