"""What a robot has, without XML, YAML or dialect: drives, cameras, rays and so on."""
