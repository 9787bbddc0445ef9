"""Ctrl-C while the models of a world change."""

import signal
from collections.abc import Iterator

import pytest

import cartwheel as cw
from cartwheel.simulation.models.population import Population

pytestmark = pytest.mark.usefixtures("tidy")


@pytest.fixture(autouse=True)
def default_sigint() -> Iterator[None]:
    """SIGINT has its default handler, also where the tests were started in the background."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.parametrize("connected", [False, True])
@pytest.mark.parametrize("step", ["compile", "observe", "welcome"])
def test_ctrl_c_takes_effect_after_the_change(
    step: str, connected: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    pressed = 0

    def press(population: Population, *arguments: object, **options: object) -> None:
        nonlocal pressed
        pressed += 1
        signal.raise_signal(signal.SIGINT)
        original(population, *arguments, **options)

    with cw.World("empty") as world:
        if connected:
            world.serve_commands()
        first = world.spawn("object.urdf", name="first", z=1.0)
        original = getattr(Population, step)
        with monkeypatch.context() as patch:
            patch.setattr(Population, step, press)
            with pytest.raises(KeyboardInterrupt):
                world.spawn("object.urdf", name="second", x=3.0, z=1.0)
            assert world.models == ("ground_plane", "first", "second")
            if step != "welcome":
                with pytest.raises(KeyboardInterrupt):
                    first.delete()
                assert world.models == ("ground_plane", "second")
        assert pressed
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
        world.run(1.0)
        third = world.spawn("object.urdf", name="third", x=6.0, z=1.0)
        world.run(1.0)
        # Both have fallen from a height of 1 m to the ground, each at its place.
        for model, x in ((world.model("second"), 3.0), (third, 6.0)):
            assert model.pose.position == pytest.approx((x, 0.0, 0.0), abs=0.01)
