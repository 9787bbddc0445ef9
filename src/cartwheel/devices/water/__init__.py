"""Buoyancy, hydrodynamic forces and thrusters of boats and underwater vehicles."""
