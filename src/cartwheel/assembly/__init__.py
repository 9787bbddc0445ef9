"""Runs put together from parts: a session, its connections to other programs, and its viewer.

`Assembly` is used by the command line and by `cartwheel.World`.
"""
