"""Systems and sensors of new Gazebo (gz-sim)."""
