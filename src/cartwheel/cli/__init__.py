"""The command line: parsing here, the work of each command in `commands`."""
