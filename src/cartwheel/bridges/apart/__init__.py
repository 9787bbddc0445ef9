"""Bridges in separate processes, which do not compete with the simulation for Python's lock.

There is one process per wire. The bridge in this process uses a `RemoteGraph`, and a `GraphHost`
in the simulation's process responds to it. Messages go through shared memory, everything else
over a socket.
"""
