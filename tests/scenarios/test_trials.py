"""Steps and conditions, each met and unmet."""

from __future__ import annotations

import pytest

from cartwheel.codes.command import OPTION_INVALID, SCENARIO_EXPRESSION, SCENARIO_INVALID
from cartwheel.codes.graph import SERVICE_UNKNOWN, TOPIC_TYPE_MISMATCH, TOPIC_UNKNOWN

from .conftest import CART, DRIVE

CAMERA = "/cart/camera1/image_raw"
GO = f"steps: [{{publish: {DRIVE}, message: {{linear: {{x: 0.5}}}}}}]\n"
POST = (
    "world: post\nrobots: [{robot: rosbots.xacro, name: cart}]\n"
    f"steps: [{{publish: {DRIVE}, message: {{linear: {{x: 1.0}}}}}}]\n"
)

MET = [
    f"{CART}{GO}expect: [{{reaches: cart, x: 1, y: 0, yaw: 0}}]",
    f"{CART}{GO}duration: 2\nexpect: [{{stays_within: cart, x: [-0.1, 1], tilt: 0.1, speed: 0.6}}]",
    f"{CART}{GO}expect: [{{moves: cart, distance: 0.5, timeout: 3}}]",
    f"{CART}duration: 2\nexpect: [{{publishes: /imu/data, rate: 30}}, {{publishes: /clock}}]",
    f"{POST}expect: [{{touches: [cart, post], timeout: 15}}]",
    f"{CART}{GO}duration: 1\nexpect: [{{no_contact: cart}}]",
    f"{CART}{GO}duration: 1\nexpect: [{{moves: cart::wheel_left_link}},"
    " {reaches: cart::wheel_left_link, x: 0.3}, {stays_within: cart::wheel_left_link, y: [0, 1]},"
    " {expression: \"y('cart::wheel_left_link') > 0.1\"}]",
    f"{CART}duration: 1\nexpect: [{{joint: cart::wheel_left_joint, position: 0}}]",
    f"{CART}{GO}duration: 1\nexpect: [{{expression: \"x('cart') > 0.3 and time <= 1.1\"}}]",
    f"{CART}duration: 1\nexpect: [{{expression: \"count('/imu/data') in range(28, 33)\"}}]",
    f"{CART}duration: 1\nexpect: [{{expression: \"field('/odom', 'header.stamp.sec') < 2\"}}]",
    f"{POST}duration: 1\n"
    "expect: [{expression: \"clearance('cart', 'p*t') > 0.5\", when: always}]",
    f"{POST}duration: 6\n"
    "expect: [{touches: [cart, post]}, {expression: \"20 < peak_force('cart', 'post') < 1e5\"},"
    " {expression: \"peak_force('cart') == peak_force('cart::base_link', 'post')\"}]",
    f"{CART}steps: [{{fault: /odom, drop: 1.0}}, {{wait: 1}}, {{end_fault: /odom}}, {{wait: 1}}]\n"
    "expect: [{expression: \"count('/odom') in range(95, 106)\"}]",
    f"{CART}steps: [{{fault: /odom, bias: {{pose.pose.position.x: 5}}, delay: 0.1, frozen: true,"
    " noise: {pose.pose.position.y: 0.1}}, {wait: 1}]\n"
    "expect: [{expression: \"abs(field('/odom', 'pose.pose.position.x') - 5) < 0.1\"}]",
    f"{CART}steps: [{{set: cart, effort_limit: {{wheel_left_joint: 0.001}}}},"
    " {set: cart, effort_limit: {wheel_right_joint: 0.001}},"
    f" {{publish: {DRIVE}, message: {{linear: {{x: 0.5}}}}}}]\n"
    "duration: 1\nexpect: [{stays_within: cart, x: [-0.05, 0.05]}]",
    # After the acceleration.
    f"{CART}{GO}duration: 2\nexpect: [{{publishes: /odom, rate: 100, after: 1}}]",
]
UNMET = [
    (f"{CART}{GO}expect: [{{reaches: cart, x: -1, timeout: 2}}]", "closest", 1.0, 0.05),
    (f"{CART}{GO}duration: 2\nexpect: [{{stays_within: cart, x: [-1, 0.5]}}]", "value", 0.5, 0.02),
    (f"{CART}expect: [{{moves: cart, timeout: 1}}]", "moved", 0.0, 0.01),
    (f"{CART}duration: 2\nexpect: [{{publishes: /imu/data, rate: 60}}]", "rate", 30.0, 1.0),
    (f"{CART}{GO}expect: [{{touches: [cart, ground_plane], when: end}},"
     " {joint: cart::wheel_left_joint, position: -3, timeout: 1}]", "position", None, None),
    (f"{POST}duration: 15\nexpect: [{{no_contact: cart}}]", "other", "post::link", None),
    (f"{CART}{GO}duration: 1\nexpect: [{{expression: x('cart') > 3}}]", "x('cart')", 0.375, 0.05),
    (f"{CART}{GO}duration: 1\nexpect: [{{expression: peak_force('cart') > 1}}]",
     "peak_force('cart')", 0.0, 0.0),
]  # fmt: skip


@pytest.mark.parametrize("text", MET, ids=range(len(MET)))
def test_a_condition_that_is_met_passes(run, text):
    outcome = run(text)
    assert outcome.status == "passed", outcome.findings[0].text


@pytest.mark.parametrize(("text", "name", "value", "within"), UNMET, ids=range(len(UNMET)))
def test_a_condition_that_is_not_met_states_the_value(run, text, name, value, within):
    outcome = run(text)
    assert outcome.status == "failed"
    finding = outcome.findings[-1]
    assert finding.line and finding.time is not None and name in finding.values
    if within is not None:
        assert finding.values[name] == pytest.approx(value, abs=within)
    elif value is not None:
        assert finding.values[name] == value


@pytest.mark.wording
def test_a_field_that_does_not_exist_has_a_suggestion(run):
    text = "expect: [{expression: \"field('/odom', 'pose.poes.position.x') < 2\"}]"
    outcome = run(f"{CART}duration: 0.1\n{text}")
    assert outcome.status == "error"
    assert 'the field "poes"' in outcome.findings[0].text and '"pose"' in outcome.findings[0].text
    assert "Error" not in outcome.findings[0].text


@pytest.mark.parametrize("text", ["x('cart')", "count('/odom')", "'true'", "x('cart') > 1 or 0.5"])
def test_an_expression_that_compares_nothing_is_an_error(run, text):
    outcome = run(f'{CART}duration: 0.1\nexpect: [{{expression: "{text}"}}]')
    assert outcome.status == "error"
    assert outcome.findings[0].code == SCENARIO_EXPRESSION.number


@pytest.mark.parametrize(
    ("field", "status", "time"),
    [
        ("pose.covariance[0]", "passed", None), ("pose.covariance[-1]", "passed", None),
        ("pose.covariance[36]", "error", 0.0), ("pose.covariance[x]", "error", 0.0),
        ("pose.covariance", "error", 0.0), ("pose.covariance[:3]", "error", 0.0),
        ("header.stamp", "passed", None), ("header", "error", 0.0),
    ],
)  # fmt: skip
def test_a_field_must_be_a_single_value(run, field, status, time):
    outcome = run(
        f"{CART}duration: 0.1\nexpect: [{{expression: \"field('/odom', '{field}') >= 0\"}}]"
    )
    assert outcome.status == status
    if time is not None:
        assert outcome.findings[0].time == time


def test_a_case_ends_when_a_condition_has_failed(run):
    outcome = run(f"{CART}{GO}duration: 50\nexpect: [{{stays_within: cart, x: [-1, 0.5]}}]")
    assert outcome.status == "failed" and outcome.time < 2


def test_steps_change_the_world(run):
    outcome = run(
        CART
        + f"""
steps:
  - hold: {DRIVE}
    message: {{linear: {{x: 0.4}}}}
    rate: 20
  - until: {{reaches: cart, x: 0.5, y: 0}}
    timeout: 5
  - release: {DRIVE}
  - publish: {DRIVE}
  - wait: 1
  - set: cart
    x: 3
    y: 1
    yaw: 1.57
  - set: cart
    joints: {{wheel_left_joint: 0.5}}
  - spawn: object.urdf
    name: post
    x: 5
  - push: post
    force: [0, 0, 0.1]
    seconds: 0.1
  - wait: 0.5
  - call: /cart/camera1/set_camera_info
    request: {{camera_info: {{width: 3}}}}
    response: {{success: false}}
  - delete: post
expect:
  - {{reaches: cart, x: 3, y: 1, yaw: 1.57}}
  - {{expression: "joint('cart', 'wheel_left_joint') > 0.3"}}
"""
    )
    assert outcome.status == "passed", outcome.findings[0].text


def test_names_in_steps_and_conditions_need_no_slash(run):
    outcome = run(
        CART
        + f"""
steps:
  - hold: {DRIVE[1:]}
    message: {{linear: {{x: 0.4}}}}
  - fault: odom
    drop: 1
  - wait: 1
  - end_fault: /odom
  - wait: 1
  - release: {DRIVE}
expect:
  - publishes: odom
  - expression: count('odom') > 50 and field('odom', 'twist.twist.linear.x') > 0.3
  - moves: cart
"""
    )
    assert outcome.status == "passed", outcome


@pytest.mark.parametrize("step", ["publish", "hold"])
def test_messages_of_steps_have_the_values_of_yaml(run, step):
    # YAML 1.1 reads 4e-1 as a text, and a value that is not given as null.
    steps = f"steps: [{{{step}: {DRIVE}, message: {{linear: {{x: 4e-1, y: }}, angular: }}}}]\n"
    outcome = run(f"{CART}{steps}duration: 2\nexpect: [{{moves: cart, distance: 0.5}}]")
    assert outcome.status == "passed", outcome.findings[0].text


def test_steps_change_properties(run):
    outcome = run(
        CART
        + """
steps:
  - spawn: object.urdf
    name: box
    x: 5
    z: 10
  - set: box
    velocity: [1, 0, 0]
  - set_gravity: [0, 0, -2]
  - wait: 1
  - set: box::my_object_link
    mass: 3
    friction: 0.2
    color: [1, 0, 0]
    gravity: false
  - set_light: sun
    intensity: 0.5
  - set: cart
    damping: {wheel_left_joint: 0.01}
    joint_friction: {wheel_left_joint: 0.02}
  - push: box
    force: [30, 0, 0]
    seconds: 0.1
  - wait: 1
expect:
  - {expression: "abs(x('box') - 7.95) < 0.02", when: end}
  - {expression: "abs(z('box') - 7) < 0.02", when: end}
"""
    )
    assert outcome.status == "passed", outcome.findings[0].text


@pytest.mark.parametrize(
    ("condition", "status"),
    [
        ("{reaches: box, x: 2, y: 0, timeout: 1}", "passed"),
        ("{no_contact: [box, cart]}", "passed"),
        ("{expression: \"x('box') > 1\", when: once}", "passed"),
        ("{reaches: boks, x: 2, y: 0, timeout: 1}", "error"),
        ("{expression: \"x('boks') > 1\", when: once}", "error"),
        ("{no_contact: [boks, cart]}", "error"),
    ],
)
def test_conditions_wait_for_models_that_steps_spawn(run, condition, status):
    steps = "steps: [{wait: 0.2}, {spawn: object.urdf, name: box, x: 2}]\n"
    outcome = run(f"{CART}{steps}duration: 1.5\nexpect: [{condition}]")
    assert outcome.status == status, [each.text for each in outcome.findings]


@pytest.mark.parametrize(
    "step",
    [
        "{set: cart, mass: 1}", "{set: 'cart::base_link', x: 1}", "{set: 'cart::base_link'}",
        "{set_light: sun}", "{set: 'cart::base_link', mass: 0}",
        "{set: cart, damping: {no_joint: 1}}", "{set_light: no_light, enabled: true}",
    ],
)  # fmt: skip
def test_a_property_that_cannot_be_set_is_an_error(run, step):
    outcome = run(f"{CART}steps:\n  - {step}\nexpect: [{{expression: 'True'}}]")
    assert (outcome.status, outcome.findings[0].line) == ("error", 3)


def test_a_case_that_is_shown_runs_in_real_time(scenario, tmp_path):
    from cartwheel.scenarios import Options, Runner, cases_of, digests

    loaded = scenario(f"{CART}duration: 1\nexpect: [{{expression: 'True'}}]")
    (case,) = digests(loaded, cases_of(loaded))
    reported: list[str] = []
    options = Options(folder=tmp_path / "out", view=True)
    outcome = Runner([loaded], options, announce=reported.append).run(case)
    assert outcome.status == "passed" and outcome.wall > 0.9
    assert reported[0].startswith("http://127.0.0.1:")


def test_a_step_that_fails_has_a_line(run):
    outcome = run(
        f"{CART}steps:\n  - wait: 0.1\n  - until: {{moves: cart}}\n    timeout: 1\n"
        "expect: [{expression: 'True'}]"
    )
    (finding,) = outcome.findings
    assert (outcome.status, finding.kind, finding.line) == ("failed", "step", 4)
    assert finding.time == pytest.approx(1.1, abs=0.03)


@pytest.mark.parametrize(
    ("steps", "code"),
    [
        ("{publish: /cmd_val}", TOPIC_UNKNOWN),
        ("{call: /nothing}", SERVICE_UNKNOWN),
        ("{send_goal: /nothing}", SERVICE_UNKNOWN),
        ("{release: /cmd_vel}", SCENARIO_INVALID),
        ("{set: cart}", SCENARIO_INVALID),
    ],
)
def test_an_invalid_step_is_an_error(run, steps, code):
    outcome = run(f"{CART}steps:\n  - {steps}\nexpect: [{{expression: 'True'}}]")
    assert outcome.status == "error"
    assert (outcome.findings[0].code, outcome.findings[0].line) == (code.number, 3)


def test_the_same_case_gives_the_same_result(scenario, tmp_path):
    from cartwheel.scenarios import Options, Runner, cases_of, digests

    loaded = scenario(
        "robots: [{robot: rosbots.xacro, name: cart, x: '${start}'}]\nseeds: 3\n"
        f"parameters: {{start: {{uniform: [0, 1]}}}}\n{GO}duration: 2\nexpect: [{{moves: cart}}]"
    )
    cases = list(digests(loaded, cases_of(loaded)))
    options = Options(folder=tmp_path, record="none", pictures="none")
    forward = Runner([loaded], options)
    backward = Runner([loaded], options)
    first = {case.id: forward.run(case).trajectories for case in cases}
    second = {case.id: backward.run(case).trajectories for case in reversed(cases)}
    assert first == second
    assert len({str(each) for each in first.values()}) == 3


def test_a_failed_case_has_a_recording_and_a_picture(run, tmp_path):
    text = f"{CART}{GO}expect: [{{reaches: cart, x: -1, timeout: 1}}]"
    outcome = run(text, record="failures", pictures="failures")
    assert outcome.recording and outcome.picture
    assert (tmp_path / "out" / outcome.recording).stat().st_size > 1000
    assert (tmp_path / "out" / outcome.picture).stat().st_size > 1000


def test_a_file_that_cannot_be_used_is_an_error_of_the_case(run):
    from cartwheel.errors import CartwheelError

    with pytest.raises(CartwheelError):
        run("robots: [{robot: missing.urdf}]\nexpect: [{moves: a}]")


@pytest.mark.parametrize(
    ("condition", "code"),
    [
        ("stays_within: cart, x: [1, -1]", OPTION_INVALID),
        ("sees: /imu/data, color: [1, 0, 0]", TOPIC_TYPE_MISMATCH),
        (f"sees: {CAMERA}, model: nobody", TOPIC_TYPE_MISMATCH),
        (f"sees: {CAMERA}, range: 2", TOPIC_TYPE_MISMATCH),
        (f"sees: {CAMERA}, share: 0.5", OPTION_INVALID),
        (f"sees: {CAMERA}, angle: 0.5", TOPIC_TYPE_MISMATCH),
    ],
)
def test_a_condition_that_cannot_be_tested_is_an_error(run, condition, code):
    outcome = run(f"{CART}expect:\n  - {{{condition}}}")
    assert outcome.status == "error"
    assert (outcome.findings[0].code, outcome.findings[0].line) == (code.number, 3)
