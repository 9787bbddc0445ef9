"""Worlds of very many models."""

from cartwheel.geometry import Pose


def test_more_pairs_of_bodies_than_the_engine_reserves_memory_for(make):
    """It keeps 4 bytes for each pair: n² / 2 pairs of 3000 bodies are 18 MB, of its usual 14."""
    count = 3000
    stones = [
        make.box(f"stone{i}", (0.4, 0.4, 0.4), static=True, pose=Pose((i % 60, 10.0 + i // 60, 0)))
        for i in range(count)
    ]
    world = make.world(*stones, make.box("box", (0.2, 0.2, 0.2), pose=Pose((0, 10, 0.4))))
    model = world.session.simulation.model
    assert 2 * model.nbody**2 > 14e6
    world.run(0.5)
    # It lies on a stone of 0.2 m above the ground.
    assert abs(world.model("box").pose.z - 0.3) < 1e-3
