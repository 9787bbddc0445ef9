"""RTPS, the wire protocol of DDS: discovery and samples.

Participants on the network are not trusted. An incomplete sample takes no more memory than the
bytes received. A participant that has not responded gets no samples, and can be replaced by
others. Data is sent only to the address that the participant's messages come from.
``README.md`` lists the limits, what is supported, and the peers that it was tried with.

Source: OMG DDSI-RTPS 2.3, limited to what ROS 2 middlewares use over UDP and IPv4.
"""
