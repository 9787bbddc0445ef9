"""RTPS, the wire protocol of DDS: discovery and samples.

Source: OMG DDSI-RTPS 2.3, limited to what ROS 2 middlewares use over UDP and IPv4.
"""
