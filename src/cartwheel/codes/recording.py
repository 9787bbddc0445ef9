"""CW901 to CW999: recording, playback and the page."""
