"""Air pressure."""

import numpy as np
import pytest
from tests.devices.position.bodies import floating, unit

from cartwheel.devices.position.barometer import pressure_at, pressure_by_qnh
from cartwheel.geometry import Pose

G = 9.8


@pytest.mark.parametrize(
    ("height", "tabulated"), [(0.0, 101325.0), (1000.0, 89875.0), (5000.0, 54020.0)]
)
def test_pressure_is_that_of_the_standard_atmosphere(make, read, height, tabulated):
    """The tables of ICAO's standard atmosphere have five digits."""
    sensor = f"""<sensor name="p" type="air_pressure"><update_rate>10</update_rate><topic>p</topic>
      <air_pressure><reference_altitude>{height}</reference_altitude></air_pressure></sensor>"""
    message = read(floating(make, unit(sensor=sensor)), "/p", 0.5)[0]
    assert message.fluid_pressure == pytest.approx(tabulated, rel=2e-4)
    assert message.variance == 0.0


def test_pressure_falls_by_the_weight_of_the_air(make, read):
    """dp = -ρ g dh with ρ = 1.225 kg/m³ at the sea."""
    sensor = """<sensor name="p" type="air_pressure"><update_rate>10</update_rate><topic>p</topic>
      </sensor>"""
    low = read(floating(make, unit(sensor=sensor)), "/p", 0.5)[0].fluid_pressure
    high = read(floating(make, unit(sensor=sensor), Pose((0, 0, 10))), "/p", 0.5)[0].fluid_pressure
    assert low - high == pytest.approx(1.225 * 9.80665 * 10, rel=2e-3)


def test_the_altimeters_formula_is_the_standard_atmosphere():
    """Its rounded constants are within 0.1 % of the standard atmosphere's up to 5 km."""
    for height in (-100.0, 0.0, 1500.0, 5000.0):
        assert pressure_by_qnh(height, 1013.25) == pytest.approx(
            pressure_at(height) / 100, rel=1e-3
        )
    assert pressure_by_qnh(50_000.0, 1013.25) == 0.0


def test_pressures_of_arrays_have_the_bits_of_those_of_floats():
    heights = np.linspace(-500.0, 50_000.0, 101)
    assert pressure_at(heights).tolist() == [pressure_at(each) for each in heights.tolist()]
    assert pressure_by_qnh(heights, 990.0).tolist() == [
        pressure_by_qnh(each, 990.0) for each in heights.tolist()
    ]
