"""A session with everything that a run connects it to."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING

from cartwheel.assembly.middleware import Rmw, check_rmw
from cartwheel.assembly.names import world_title
from cartwheel.assembly.observer import AtEnd, Observer
from cartwheel.assembly.processes import Kind, Processes
from cartwheel.assembly.recording import Recording, RecordingOptions
from cartwheel.errors import ControlError, Diagnostic
from cartwheel.gate.access import Access

if TYPE_CHECKING:
    from cartwheel.assembly.foxglove import FoxgloveServer
    from cartwheel.assembly.ros1 import Ros1Connection
    from cartwheel.assembly.ros2 import Ros2Connection
    from cartwheel.assembly.viewer import AnnouncedViewer
    from cartwheel.assembly.viewer_on_demand import ViewerOnDemand
    from cartwheel.bridges.apart.process import BridgeProcess
    from cartwheel.control.server import ControlServer
    from cartwheel.gazebo import GazeboApi
    from cartwheel.gazebo.ros2_api import Ros2Api
    from cartwheel.session import Session
    from cartwheel.simulation.pacing import Pacer


def at_block_end(function: Callable[[], None]) -> contextlib.AbstractContextManager[object]:
    """Calls a function at the end of the block: the default `AtEnd`."""
    # Not a generator: a forked process that exits would run its last part.
    stack = contextlib.ExitStack()
    stack.callback(function)
    return stack


class Assembly:
    """The connections of a session: control server, ROS, Foxglove, recordings and viewer.

    Except for `prepare`, call the methods on the thread that owns the simulation. `close` ends all
    connections, the last one first.

    Args:
        access: Who may connect to the viewer and to the Foxglove server.
        package_path: Folders to search first for packages of spawned models.
        observer: Is notified of connections.
        at_end: Creates the context managers that close the connections.
    """

    def __init__(
        self,
        *,
        access: Access,
        package_path: Sequence[Path] = (),
        observer: Observer | None = None,
        at_end: AtEnd = at_block_end,
    ) -> None:
        self.access = access
        self._package_path = tuple(package_path)
        self._observer = observer or Observer()
        self._at_end = at_end
        self._processes = Processes()
        self._stack = contextlib.ExitStack()
        self._stack.callback(self._processes.close)
        self._session: Session | None = None
        self._pacer: Pacer | None = None
        self._control: ControlServer | None = None
        self._joined: set[str] = set()
        """The versions of ROS that the session is connected to."""
        self._recordings: list[Recording] = []
        self._updated = -1
        """`Graph.changed` at the last update."""
        self._ended: Diagnostic | None = None
        """Why another ROS 1 node ended the run."""
        self._ros1_api: GazeboApi | None = None
        self._ros2_api: Ros2Api | None = None

    def __enter__(self) -> Assembly:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def prepare(self, kinds: Iterable[Kind | Path]) -> None:
        """Starts bridge processes, which start up while the simulation's files are read.

        Args:
            kinds: Bridges, and paths of recordings.
        """
        for kind in kinds:
            self._processes.start(kind)

    def attach(self, session: Session, pacer: Pacer) -> None:
        """Sets the session, and the pacer that runs it."""
        self._session, self._pacer = session, pacer

    @property
    def session(self) -> Session:
        """The session, after `attach`."""
        assert self._session is not None
        return self._session

    @property
    def pacer(self) -> Pacer:
        """The pacer, after `attach`."""
        assert self._pacer is not None
        return self._pacer

    @property
    def control(self) -> ControlServer:
        """The control server, after `serve_control`."""
        assert self._control is not None
        return self._control

    # -- parts

    def serve_control(self, title: str, *, ros: bool = False) -> None:
        """Lets commands such as ``cartwheel topic`` connect.

        Args:
            title: A short description of what is simulated.
            ros: Whether ROS 1 is connected next.

        Raises:
            ControlError: The socket cannot be created.
        """
        from cartwheel.control.server import ControlServer
        from cartwheel.description import load_robot

        world = world_title(self.session.simulation.world)
        server = ControlServer(self.session, title=title, load=load_robot, world=world, ros=ros)
        self._stack.enter_context(self._at_end(server.close))
        self._control = server

    def add_viewer(self, port: int, *, open_browser: bool = False) -> AnnouncedViewer:
        """Adds the web viewer. `AnnouncedViewer.start` starts it.

        Args:
            port: Port to listen on.
            open_browser: Whether to open a browser.

        Raises:
            ControlError: The port is not available.
        """
        from cartwheel.assembly.viewer import AnnouncedViewer

        return AnnouncedViewer(
            self.session,
            self.control,
            self._observer,
            access=self.access,
            port=port,
            open_browser=open_browser,
        )

    def offer_viewer(self, port: int, *, until_exit: bool = False) -> ViewerOnDemand:
        """Adds a web viewer that starts when a client requests it.

        Args:
            port: The first port to try; ports in use are skipped.
            until_exit: Leave the viewer open when the assembly is closed, because the process
                exits.
        """
        from cartwheel.assembly.viewer_on_demand import ViewerOnDemand

        viewer = ViewerOnDemand(
            self.session,
            self.control,
            self.pacer,
            self._observer,
            access=self.access,
            port=port,
        )
        if not until_exit:
            self._stack.callback(viewer.close)
        return viewer

    def connect_ros1(self, node: str, arguments: Sequence[str] = ()) -> Ros1Connection:
        """Adds a ROS 1 node with Gazebo's topics and services.

        Args:
            node: Name of the node.
            arguments: ROS arguments ``name:=value``.

        Raises:
            CartwheelError: A name or address is invalid, or no ROS master can be used.
        """
        from cartwheel.assembly.ros1 import Ros1Connection
        from cartwheel.gazebo import GazeboApi

        session = self.session
        api = None
        if self._ros1_api is None:
            api = self._ros1_api = GazeboApi(session, package_path=self._package_path)
        with self._opening("ros1") as process:
            connection = Ros1Connection(
                session,
                process,
                api=api,
                node=node,
                arguments=arguments,
                observer=self._observer,
                ended=self._ros1_ended,
            )
            connection.start()
        self.control.announce_ros(connection.master_uri)
        self._joined.add("ros1")
        session.others_publish_states = "ros2" not in self._joined
        return connection

    def connect_ros2(self, node: str, rmw: Rmw = "dds") -> Ros2Connection:
        """Adds a ROS 2 node with Gazebo's topics and services.

        Args:
            node: Name of the node.
            rmw: The middleware.

        Raises:
            CartwheelError: A name or an environment variable of ROS is invalid, or a dependency is
                missing.
        """
        from cartwheel.assembly.ros2 import Ros2Connection

        check_rmw(rmw)
        self.session.others_publish_states = False
        with self._opening("ros2") as process:
            connection = Ros2Connection(
                self.session,
                process,
                api=self._new_ros2_api(),
                node=node,
                rmw=rmw,
                observer=self._observer,
            )
            connection.start()
        self._joined.add("ros2")
        return connection

    def serve_foxglove(self, port: int, *, end_ns: int | None = None) -> FoxgloveServer:
        """Adds a server for Foxglove.

        Args:
            port: Port to listen on; 0 selects a free port.
            end_ns: Simulation time at which the run ends; None if unlimited.

        Raises:
            CartwheelError: The optional dependency is missing, or the port is in use.
        """
        from cartwheel.assembly.foxglove import FoxgloveServer

        self._describe_robots()
        with self._opening("foxglove") as process:
            server = FoxgloveServer(
                self.session,
                process,
                access=self.access,
                port=port,
                end_ns=end_ns,
                package_path=self._package_path,
                observer=self._observer,
            )
            # Otherwise, the ROS connections offer Gazebo's services.
            server.start(None if self._joined else self._new_ros2_api())
        return server

    def record(self, path: Path, options: RecordingOptions) -> Recording:
        """Records all messages from now on.

        Args:
            path: File or folder to record to.
            options: What is recorded.

        Raises:
            RecordingError: The recording cannot be written.
        """
        self._describe_robots()
        session = self.session
        with self._opening(path) as process:
            recording = Recording(
                session,
                process,
                path,
                options,
                observer=self._observer,
                failed=session.simulation.stop,
            )
            # The command line completes it even after Ctrl-C: a second of messages takes longer to
            # write than the shutdown timeout allows.
            with contextlib.ExitStack() as opened:
                opened.enter_context(self._at_end(recording.finish))
                recording.start()
                self._stack.push(opened.pop_all())
        self._stack.callback(recording.close)
        self._recordings.append(recording)
        return recording

    def update(self) -> None:
        """Publishes the descriptions of new robots, and records new topics from the start."""
        self.session.update_robots()
        graph = self.session.graph
        if graph.changed == self._updated:
            return
        for recording in self._recordings:
            recording.update()
        self._updated = graph.changed

    def raise_failure(self) -> None:
        """Raises the error of a part that has ended the run.

        Raises:
            RecordingError: A recording has failed.
            ControlError: Another node has replaced the ROS 1 node.
        """
        for recording in self._recordings:
            if recording.failed:
                recording.close()
        ended, self._ended = self._ended, None
        if ended is not None:
            raise ControlError(ended.message, code=ended.code, hint=ended.hint, values=ended.values)

    # -- shared by the parts

    def _ros1_ended(self, diagnostic: Diagnostic) -> None:
        self._ended = diagnostic
        self.session.simulation.stop()

    @contextlib.contextmanager
    def _opening(self, kind: Kind | Path) -> Iterator[BridgeProcess]:
        """A process that is closed with the assembly, or at once if the block raises an error."""
        process = self._processes.take(kind)
        with contextlib.ExitStack() as opened:
            opened.enter_context(self._at_end(process.close))
            yield process
            self._stack.push(opened.pop_all())

    def _new_ros2_api(self) -> Ros2Api | None:
        """Gazebo's ROS 2 services; None if they are already offered."""
        if self._ros2_api is not None:
            return None
        from cartwheel.gazebo.ros2_api import Ros2Api

        self._ros2_api = Ros2Api(self.session, package_path=self._package_path)
        return self._ros2_api

    def _describe_robots(self) -> None:
        """Publishes the robots for programs that display them.

        In ROS, another node may publish the poses of their links.
        """
        from cartwheel.gazebo.robot_descriptions import hold_descriptions
        from cartwheel.gazebo.robot_states import hold_states

        if self._joined:
            hold_descriptions(self.session)
        else:
            hold_states(self.session)

    # -- end

    def close(self) -> None:
        """Ends all connections and completes the recordings.

        Raises:
            RecordingError: A recording has failed.
        """
        self._stack.close()
