"""The command line: argument parsing here, the implementation of each command in `commands`."""
