"""Bridges in processes of their own: a simulation's thread does not share Python's lock with them.

Each wire has one. The bridge there sees a `RemoteGraph`, which a `GraphHost` beside the simulation
answers for: messages go through memory that both share, everything else over a socket.
"""
