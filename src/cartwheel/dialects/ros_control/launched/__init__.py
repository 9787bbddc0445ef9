"""Which of the controllers in files a launch file starts, and what is wrong with it."""
