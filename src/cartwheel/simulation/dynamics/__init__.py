"""Physics that Cartwheel adds to MuJoCo's step."""
