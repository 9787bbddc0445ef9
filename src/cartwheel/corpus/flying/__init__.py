"""Aircraft, and what thrusts: propellers, thrusters of water and space."""
