"""Lidars that measure meshes continue bit for bit, although Embree's shapes are not saved."""

import copy

import numpy as np
import pytest
from tests.saving.scanning import make_world, restored, scans, write_robot

from cartwheel.simulation.sensing.embree_rays import EmbreeCaster
from cartwheel.simulation.sensing.ray_triangles import AVAILABLE
from cartwheel.simulation.sensing.rays import RayHandle


def ray_handle(world):
    part = world.session.simulation.population.residents["robot"].part
    (found,) = (each for each in part.handles if isinstance(each, RayHandle))
    return found


@pytest.mark.parametrize("link", ["base", "arm"])
@pytest.mark.parametrize("kind", ["lidar", "gpu_lidar"])
def test_meshes_that_stand_and_swing(kind, link, elsewhere, make, tmp_path):
    file = write_robot(tmp_path, kind, link)
    with make_world(file) as world:
        scans(world)
        assert not AVAILABLE or isinstance(ray_handle(world)._caster, EmbreeCaster)
        state = world.save()
        assert state.left_out == ()
        before, _ = ray_handle(world).cast()
        expected = scans(world)
        after, _ = ray_handle(world).cast()
        assert len(expected) >= 14
        assert (np.isfinite(after) & (after != before)).sum() > 10
        for other in (state, copy.deepcopy(state)):
            world.restore(other)
            assert scans(world) == expected
        # A spawn compiles another model; the lidar must not go on measuring the one of before.
        world.spawn(make.box("crate", (0.3, 0.3, 0.3), static=True), x=-1.5, z=2.0)
        assert scans(world) != expected
        for other in (state, copy.deepcopy(state)):
            world.restore(other)
            assert scans(world) == expected
    assert restored(file, state) == expected
    assert elsewhere(restored, file, state) == expected
