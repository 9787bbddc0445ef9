"""The controllers, one file for each family."""
