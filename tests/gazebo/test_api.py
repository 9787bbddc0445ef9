"""The API as a whole: what it offers, under which names and types."""

import threading

import pytest
from tests.coded import raises

from cartwheel.codes.graph import SERVICE_TAKEN
from cartwheel.gazebo import GazeboApi
from cartwheel.messages import zero

from .conftest import EMPTY, SERVICES


def offered(world):
    found = {service.name: service for service in world.graph.services()}
    return {name: found[name] for name in found if name.startswith("/gazebo/")}


def test_every_service_of_gazebo_is_offered_with_its_type(make, gazebo):
    world = make.world()
    gazebo(world)
    services = offered(world)
    expected = {f"/gazebo/{name}": f"gazebo_msgs/srv/{kind}" for name, kind in SERVICES.items()}
    expected |= {f"/gazebo/{name}": "std_srvs/srv/Empty" for name in EMPTY}
    assert len(expected) == 27
    assert expected.items() <= {name: each.type for name, each in services.items()}.items()
    assert {each.node for each in services.values()} == {"gazebo"}


def test_topics(make, gazebo):
    world = make.world()
    gazebo(world)
    topics = {topic.name: topic for topic in world.graph.topics()}
    for name, kind in (("model_states", "ModelStates"), ("link_states", "LinkStates")):
        assert topics[f"/gazebo/{name}"].type == f"gazebo_msgs/msg/{kind}"
        assert topics[f"/gazebo/{name}"].publishers == ("gazebo",)
    for name, kind in (("set_model_state", "ModelState"), ("set_link_state", "LinkState")):
        assert topics[f"/gazebo/{name}"].type == f"gazebo_msgs/msg/{kind}"
        assert topics[f"/gazebo/{name}"].subscribers == ("gazebo",)


def test_close_takes_everything_off_the_graph(make, gazebo):
    world = make.world()
    api = gazebo(world)
    box = world.mailbox("/gazebo/model_states")
    api.api.close()
    assert not offered(world)
    world.run(0.1)
    assert not box.drain()
    api.api.start()
    world.run(0.1)
    assert len(box.drain()) == 21


def test_a_second_one_on_a_session_is_refused_and_harms_nothing(make, gazebo):
    world = make.world()
    gazebo(world)
    before = offered(world)
    with raises(SERVICE_TAKEN, name="/gazebo/spawn_urdf_model"):
        GazeboApi(world.session).start()
    assert offered(world) == before


@pytest.mark.parametrize("name", [*SERVICES, *EMPTY])
def test_an_empty_request_is_answered(make, gazebo, name):
    """With zeros and empty names; those without a status simply come back."""
    world = make.world(make.box("box", (1, 1, 1)))
    api = gazebo(world)
    answer = api(name)
    if name not in EMPTY and name not in ("clear_body_wrenches", "clear_joint_forces"):
        gets = {"get_world_properties", "get_physics_properties"}
        assert answer.success == (name in gets), answer.status_message
        assert answer.status_message
    world.run(0.05)


def test_calls_from_another_thread_while_it_runs(make, gazebo):
    """As a bridge makes them: the owner runs, the caller waits for each answer."""
    world = make.world(make.box("box", (1, 1, 1)))
    gazebo(world)
    simulation = world.session.simulation
    simulation.set_speed(None)
    answers = []

    def client():
        for _ in range(20):
            request = zero("gazebo_msgs/srv/GetModelState_Request")
            request.model_name = "box"
            future = world.graph.call("/gazebo/get_model_state", request)
            answers.append(future.result(timeout=60))
        simulation.post(simulation.stop)

    thread = threading.Thread(target=client)
    thread.start()
    world.session.pacer().run()
    thread.join(60)
    assert len(answers) == 20
    assert all(answer.success for answer in answers)
