"""RTPS, the wire of DDS: discovery, and samples as bytes.

Source: OMG DDSI-RTPS 2.3; what of it ROS 2's middlewares use over UDP and IPv4.
"""
