"""Robots with controllers, whose parameters are files."""

import pytest
import yaml

import cartwheel as cw
from cartwheel.description import load_text
from cartwheel.messages import from_dict, message_class


class Bench:
    """A robot with controllers in an empty world."""

    def __init__(self, folder, urdf, *files):
        self.world = cw.World("empty")
        names = []
        for number, content in enumerate(files):
            path = folder / f"controllers{number}.yaml"
            path.write_text(yaml.safe_dump(content))
            names.append(path)
        description = load_text(urdf, file=str(folder / "robot.urdf"))
        self.model = self.world.spawn(description, controllers=names)

    def publish(self, topic, kind, **fields):
        self.world.graph.publish(topic, kind, from_dict(kind, fields))

    def call(self, service, /, **fields):
        """Calls a service on this thread, which owns the simulation."""
        service = self.world.graph.service(service)
        request = message_class(f"{service.type}_Request")(**fields)
        return service.handler(request)

    def box(self, topic):
        return self.world.mailbox(topic, size=100_000)

    def position(self, joint):
        return self.world.session.simulation.joint_position("arm", joint)

    @property
    def warnings(self):
        return [d for d in self.world.diagnostics if d.severity != "info"]

    def refuses(self, ok, code, **values):
        """Whether a request was not ok, and the reason that was reported has these values."""
        last = self.warnings[-1]
        return not ok and last.code is code and {**last.values, **values} == dict(last.values)


@pytest.fixture
def bench(tmp_path):
    made = []

    def make(urdf, *files):
        made.append(Bench(tmp_path, urdf, *files))
        return made[-1]

    yield make
    for each in made:
        each.world.close()
