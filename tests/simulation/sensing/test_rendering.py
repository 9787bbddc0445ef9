"""What a renderer leaves out changes no picture."""

import math

import numpy as np
import pytest
from tests.devices.cameras.sensors import pixels_of, sensor, take

SHAPES = (
    "<box><size>{} {} {}</size></box>",
    "<sphere><radius>{}</radius></sphere>",
    "<cylinder><radius>{}</radius><length>{}</length></cylinder>",
    "<capsule><radius>{}</radius><length>{}</length></capsule>",
    "<plane><normal>0 0 1</normal><size>{} {}</size></plane>",
)
SPIKES = "<mesh><uri>file://{}/spikes.obj</uri></mesh>"


def things(make, random, folder):
    corners = random.uniform(-0.8, 0.8, (9, 3))
    (folder / "spikes.obj").write_text(
        "".join(f"v {x} {y} {z + 3}\n" for x, y, z in corners)
        + "".join(f"f {i} {i + 1} {i + 2}\n" for i in range(1, 8))
    )
    for index in range(60):
        form = SPIKES if index % 6 == 5 else SHAPES[index % 6]
        shape = form.format(*(random.uniform(0.1, 1.2, 3) if form != SPIKES else [folder]))
        place = " ".join(map(str, (*random.uniform(-4, 4, 3), *random.uniform(-3, 3, 3))))
        colour = " ".join(map(str, random.uniform(0.1, 1, 3)))
        yield make.sdf(
            f"""<model name="m{index}"><static>1</static><pose>{place}</pose><link name="link">
            <visual name="v"><transparency>{0.5 if index % 7 == 0 else 0}</transparency>
            <geometry>{shape}</geometry><material><diffuse>{colour} 1</diffuse></material></visual>
            </link></model>"""
        )


@pytest.mark.parametrize(
    "lens",
    [
        {"width": 96, "height": 64, "fov": 1.0},
        {"width": 40, "height": 120, "fov": 0.3, "far": 4.0},
        {"width": 96, "height": 64, "fov": 2.6, "near": 1.0},
    ],
    ids=["usual", "high and near-sighted", "wide"],
)
def test_what_is_out_of_view_changes_no_picture(make, monkeypatch, tmp_path, lens):
    sides = {f"eye{number}": number * math.tau / 5 for number in range(5)}
    eyes = [
        make.sdf(sensor(name=name, pose=f"0 0 0.5 0.1 0.2 {yaw}", **lens))
        for name, yaw in sides.items()
    ]

    def pictures():
        world = make.world(*things(make, np.random.default_rng(8), tmp_path), *eyes)
        return [pixels_of(take(world, f"/{name}/image_raw")) for name in sides]

    lean = pictures()
    left_out = []

    def nothing(model, *_):
        left_out.append(1)
        return np.zeros(model.ngeom, dtype=bool)

    monkeypatch.setattr("cartwheel.simulation.sensing.rendering.out_of_view", nothing)
    whole = pictures()
    assert len(np.unique(np.reshape(whole, (-1, 3)), axis=0)) > 20
    assert np.array_equal(lean, whole)
    assert left_out
