"""Followers of mimic joints stop at their own limits, and do not hold their leaders back."""

import numpy as np
import pytest

import cartwheel as cw
from cartwheel.description import load_text
from cartwheel.simulation.models.couplings import couplings

BODY = (
    '<inertial><mass value="{mass}"/><origin xyz="0.1 0 0"/>'
    '<inertia ixx="0.001" iyy="0.001" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial>'
)
LEAD = (
    f'<link name="world"/><link name="arm">{BODY.format(mass=1)}</link>'
    '<joint name="lead" type="continuous"><parent link="world"/><child link="arm"/>'
    '<origin xyz="0 0 2"/><axis xyz="0 1 0"/></joint>'
)


def follower(limits, mimic, *, name="follow", leader="lead", mass=1, y=1):
    """Horizontal at 0, as its leader, which gravity turns in the positive direction."""
    return (
        f'<link name="{name}_link">{BODY.format(mass=mass)}</link>'
        f'<joint name="{name}" type="revolute"><parent link="world"/><child link="{name}_link"/>'
        f'<origin xyz="0 {y} 2"/><axis xyz="0 1 0"/><limit {limits} effort="9" velocity="9"/>'
        f'<mimic joint="{leader}" {mimic}/></joint>'
    )


def world(*parts):
    made = cw.World("empty")
    made.spawn(load_text(f'<robot name="r">{LEAD}{"".join(parts)}</robot>', file="r.urdf"))
    return made


def positions(made, *names):
    return [made.session.simulation.joint_position("r", name) for name in names]


def swing(made, *names, steps=60):
    found = []
    for _ in range(steps):
        made.run(0.02)
        found.append(positions(made, *names))
    return np.array(found)


@pytest.mark.parametrize(
    ("limits", "mimic"),
    [
        # Its target is outside from the start.
        ('lower="0" upper="1"', 'multiplier="-1"'),
        # A small ratio, for which the engine's constraint is written the other way round.
        ('lower="0" upper="1"', 'multiplier="-0.2"'),
        ('lower="0.5" upper="1"', 'multiplier="0" offset="0.2"'),
    ],
)
def test_a_leader_moves_as_if_its_follower_at_a_limit_were_not_there(limits, mimic):
    with world() as alone, world(follower(limits, mimic)) as both:
        # Less than a period, so that the leader does not return.
        free = swing(alone, "lead", steps=30)[:, 0]
        lead, follow = swing(both, "lead", "follow", steps=30).T
    assert np.ptp(free) > 2.0
    assert lead == pytest.approx(free, abs=1e-3)
    assert follow[5:] == pytest.approx(float(limits.split('"')[1]), abs=0.01)


def test_a_follower_follows_within_its_limits_and_waits_there():
    with world(follower('lower="-1" upper="0.4"', 'multiplier="0.5"', mass=0.1)) as made:
        lead, follow = swing(made, "lead", "follow").T
    assert lead.max() > 1.5
    assert follow == pytest.approx(np.minimum(0.5 * lead, 0.4), abs=0.05)
    assert np.ptp(follow) > 0.3


def test_a_small_follower_of_a_light_leader_does_not_lag():
    """The constraint is as stiff as that of a follower whose limits contain all targets."""
    light = LEAD.replace(BODY.format(mass=1), BODY.format(mass=0.001).replace("0.001", "1e-6"))
    slide = follower('lower="0" upper="0.02"', 'multiplier="0.01"', mass=0.05)
    slide = slide.replace('type="revolute"', 'type="prismatic"')
    with cw.World("empty") as made:
        made.spawn(load_text(f'<robot name="r">{light}{slide}</robot>', file="r.urdf"))
        simulation = made.session.simulation
        assert simulation.engine.stepping.followers is not None
        simulation.drive("r", "lead", velocity=1.0, max_effort=10.0)
        lead, follow = swing(made, "lead", "follow", steps=75).T
    assert lead[-1] == pytest.approx(1.5, abs=0.01)
    assert follow == pytest.approx(0.01 * lead, abs=1e-4)


def test_followers_of_followers_follow_the_positions_that_these_reach():
    parts = (
        follower('lower="-1" upper="0.4"', 'multiplier="1"', mass=0.1),
        follower('lower="-1" upper="0.1"', 'multiplier="0.5"', name="last", leader="follow", y=2),
    )
    with world(*parts) as made:
        swing(made, "lead", steps=20)
        lead, follow, last = positions(made, "lead", "follow", "last")
    assert lead > 1.0
    assert (follow, last) == pytest.approx((0.4, 0.1), abs=0.01)


def test_a_position_of_a_leader_places_its_follower_at_its_limit():
    with world(follower('lower="-1" upper="0.4"', 'multiplier="1"')) as made:
        made.model("r").joints.positions["lead"] = 1.0
        assert positions(made, "follow") == pytest.approx([0.4], abs=1e-9)


@pytest.mark.parametrize("multiplier", [-0.5, 0.5])
def test_a_limited_coupling_is_reported_with_its_own_ratio(multiplier):
    """Also while it is written for the leader, within the limits."""
    with world(follower('lower="0" upper="1"', f'multiplier="{multiplier}" offset="0.1"')) as made:
        made.run(0.3)
        simulation = made.session.simulation
        engine = simulation.engine
        names = {engine.joint_id("r", name): name for name in ("lead", "follow")}
        (found,) = couplings(engine.model, engine.data, names)
    assert (found.follower, found.leader) == ("follow", "lead")
    assert (found.ratio, found.offset) == (multiplier, 0.1)


@pytest.mark.parametrize(("lower", "limited"), [(-0.5, False), (-0.4, True)])
def test_followers_whose_limits_contain_all_targets_need_no_python_code(lower, limited):
    lead = 'type="revolute"><limit lower="0" upper="1" effort="9" velocity="9"/>'
    text = LEAD.replace('type="continuous">', lead)
    part = follower(f'lower="{lower}" upper="0"', 'multiplier="-0.5"')
    with cw.World("empty") as made:
        made.spawn(load_text(f'<robot name="r">{text}{part}</robot>', file="r.urdf"))
        assert (made.session.simulation.engine.stepping.followers is not None) == limited


def test_a_saved_state_continues_with_the_same_bits():
    """The follower leaves its limit, and reaches it again, after the state was saved."""
    part = follower('lower="-1" upper="0.4"', 'multiplier="0.5"')
    with world(part) as made:
        made.run(0.31)
        state = made.save()
        first = swing(made, "lead", "follow")
        made.restore(state)
        second = swing(made, "lead", "follow")
    assert first.tobytes() == second.tobytes()
    assert (first[:, 1] > 0.39).any()
    assert (first[:, 1] < 0.3).any()


def test_runs_of_one_step_and_of_many_have_the_same_bits():
    part = follower('lower="-1" upper="0.4"', 'multiplier="0.5"')
    with world(part) as one, world(part) as other:
        for _ in range(200):
            one.run(0.005)
        other.run(1.0)
        assert positions(one, "lead", "follow") == positions(other, "lead", "follow")


@pytest.mark.parametrize("multiplier", [0.5, 1])
def test_limits_that_change_release_and_couple_the_leader(multiplier):
    """The limits of a leader and of its follower, while the world runs."""
    lead = LEAD.replace(
        'type="continuous">', 'type="revolute"><limit lower="0" upper="1" effort="9" velocity="9"/>'
    )
    part = follower('lower="0" upper="1"', f'multiplier="{multiplier}"', mass=0.1)
    with cw.World("empty") as made:
        model = made.spawn(load_text(f'<robot name="r">{lead}{part}</robot>', file="r.urdf"))
        engine = made.session.simulation.engine
        made.run(0.1)
        assert engine.stepping.followers is None
        model.joints["follow"].limits = 0.0, 0.2
        made.run(1.0)
        assert engine.stepping.followers is not None
        assert positions(made, "lead", "follow") == pytest.approx([1.0, 0.2], abs=0.01)
        model.joints["lead"].limits = 0.0, 0.1
        made.run(1.0)
        assert engine.stepping.followers is None
        assert positions(made, "lead", "follow") == pytest.approx([0.1, 0.1 * multiplier], abs=0.01)
