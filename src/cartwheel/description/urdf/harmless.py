"""Elements in published URDFs that no URDF reader uses: they need a note, not a warning."""

_NOBODY = "no URDF parser supports it"
_SAFETY = "it configures the safety controller of the PR2"
_IDENTIFIED = "it is a measured value of the real arm; URDF defines only damping and friction"
_PLANNER = "it is for a planner"
_SURFACE = "colours and surfaces for Gazebo must be in a <gazebo> tag"
_OLD = "it is from an early version of URDF"

HARMLESS: dict[tuple[str, str], str] = {
    ("axis", "@rpy"): "an axis has no orientation",
    ("collision", "contact_coefficients"): _OLD,
    ("collision", "material"): _SURFACE,
    ("collision", "surface"): _SURFACE,
    ("collision", "verbose"): _OLD,
    ("dynamics", "@D"): _IDENTIFIED,
    ("dynamics", "@K"): _IDENTIFIED,
    ("dynamics", "@mu_coulomb"): _IDENTIFIED,
    ("dynamics", "@mu_viscous"): _IDENTIFIED,
    ("gazebo", "stopKd"): _OLD,
    ("gazebo", "stopKp"): _OLD,
    ("geometry", "@name"): _NOBODY,
    ("geometry", "material"): "a <material> must be next to the <geometry>, not inside it",
    ("inertial", "@name"): _NOBODY,
    ("joint", "anchor"): _OLD,
    ("joint", "calibration"): "it is for the encoder of a real joint",
    ("joint", "insert_point"): _OLD,
    ("joint", "joint_properties"): _OLD,
    ("joint", "verbose"): _OLD,
    ("limit", "@acceleration"): _PLANNER,
    ("limit", "@drop"): _NOBODY,
    ("limit", "@jerk"): _PLANNER,
    ("limit", "@k_position"): _SAFETY,
    ("limit", "@k_velocity"): _SAFETY,
    ("limit", "@safety_length_max"): _SAFETY,
    ("limit", "@safety_length_min"): _SAFETY,
    ("link", "@type"): _NOBODY,
    ("link", "self_collision_checking"): _OLD,
    ("link", "verbose"): _OLD,
    ("robot", "link_group"): _PLANNER,
    ("robot", "group"): _PLANNER,
    ("safety_controller", "@safety_length_max"): _SAFETY,
    ("visual", "verbose"): _OLD,
}
"""By an element's tag and its child's tag, or its attribute's name after an ``@``."""
