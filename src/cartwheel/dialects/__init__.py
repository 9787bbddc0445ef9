"""How robot descriptions specify devices: tags and parameters, one folder for each dialect."""
