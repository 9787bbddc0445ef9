"""Access control in front of the web viewer's and Foxglove's servers."""
