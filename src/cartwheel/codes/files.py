"""CW101 to CW199: files, XML, xacro and YAML."""
