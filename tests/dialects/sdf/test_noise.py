"""SDF's <noise> element, read alone."""

import pytest

from cartwheel.codes import devices
from cartwheel.description.model import Element
from cartwheel.devices.noise import Noise
from cartwheel.dialects.sdf.noise import read_noise
from cartwheel.errors import Origin, PluginError

PLACE = Origin(file="robot.sdf", line=7)


def noise(kind, **tags):
    children = [Element(tag="type", text=kind, origin=PLACE)]
    children += [Element(tag=tag, text=value, origin=PLACE) for tag, value in tags.items()]
    return Element(tag="noise", children=tuple(children), origin=PLACE)


def test_the_tags_fill_the_fields():
    tags = {
        "mean": "-0.5",
        "stddev": "0.1",
        "bias_mean": "-1",
        "bias_stddev": "0.2",
        "dynamic_bias_stddev": "0.3",
        "dynamic_bias_correlation_time": "60",
        "precision": "0.01",
    }
    reports = []
    element = noise("gaussian_quantized", **tags)
    assert read_noise(element, reports.append) == Noise(
        mean=-0.5,
        stddev=0.1,
        bias_mean=-1.0,
        bias_stddev=0.2,
        dynamic_bias_stddev=0.3,
        dynamic_bias_correlation_time=60.0,
        precision=0.01,
    )
    assert not reports


@pytest.mark.parametrize(
    "element", [None, *(noise(kind, stddev="1") for kind in ("none", "", "pink", "custom"))]
)
def test_without_noise_all_fields_are_zero(element):
    assert read_noise(element, pytest.fail) == Noise()


@pytest.mark.parametrize(
    ("tags", "expected"),
    [
        ({"precision": "0.5"}, Noise()),
        ({"dynamic_bias_stddev": "0.5"}, Noise(dynamic_bias_stddev=0.5)),
    ],
)
def test_tags_without_effect_are_reported(tags, expected):
    reports = []
    assert read_noise(noise("gaussian", **tags), reports.append) == expected
    assert [(each.code, each.origin) for each in reports] == [
        (devices.SENSOR_SETTING_IGNORED, PLACE)
    ]


@pytest.mark.parametrize(
    "element", [noise("gaussian", stddev="-1"), noise("gaussian", mean="much")]
)
def test_an_invalid_noise_is_an_error_at_its_line(element):
    with pytest.raises(PluginError) as raised:
        read_noise(element, pytest.fail)
    assert raised.value.diagnostic().code == devices.PLUGIN_PARAMETER_INVALID
    assert raised.value.origin == PLACE
