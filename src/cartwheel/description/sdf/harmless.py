"""What SDF says and this simulation has no use for: worth a note, not a warning."""

_ENGINE = "it tunes a solver that is not used here"
_OTHER_ENGINE = "it is for another engine"
_WINDOW = "it belongs to Gazebo's window"
_STIFFNESS = "kp and kd say how a contact gives way, as in Gazebo"
_LIGHT = "the renderer does not know it"
_STATE = "it follows from the state that is restored"
_TIME = "time begins at 0"
_TERRAIN = "a terrain is drawn in one colour or with one texture, in full detail"
_REST = "what rests costs next to nothing"
_WIND = "there is no wind"
_STOP = "stops are as hard as can be"
_MEASURED = "it is measured: auto is true"
_SURFACE = "of a physically based material only the colour image is drawn"
_INERTIA = 'it counts in an <inertial auto="true">'

HARMLESS: dict[tuple[str, str], str] = {
    ("axis", "initial_position"): "Gazebo does not read it either; joints begin at 0",
    ("axis2", "initial_position"): "Gazebo does not read it either; joints begin at 0",
    ("bullet", "fdir1"): _OTHER_ENGINE,
    ("collision", "auto_inertia_params"): _INERTIA,
    ("collision", "density"): _INERTIA,
    ("contact", "bullet"): _OTHER_ENGINE,
    ("contact", "collide_without_contact_bitmask"): "<collide_without_contact> alone counts",
    ("contact", "elastic_modulus"): _STIFFNESS,
    ("contact", "poissons_ratio"): _STIFFNESS,
    ("friction", "bullet"): _OTHER_ENGINE,
    ("heightmap", "blend"): _TERRAIN,
    ("heightmap", "sampling"): _TERRAIN,
    ("heightmap", "use_terrain_paging"): _TERRAIN,
    ("include", "allow_auto_disable"): _REST,
    ("inertial", "auto_inertia_params"): "a solid is measured as it is",
    ("inertial", "density"): _INERTIA,
    ("inertial", "inertia"): _MEASURED,
    ("inertial", "pose"): _MEASURED,
    ("light", "visualize"): _WINDOW,
    ("limit", "dissipation"): _STOP,
    ("limit", "stiffness"): _STOP,
    ("link", "acceleration"): _STATE,
    ("link", "static"): "it belongs to the model",
    ("link", "wrench"): _STATE,
    ("material", "ambient"): "a surface has one colour, the diffuse one",
    ("material", "double_sided"): _LIGHT,
    ("material", "lighting"): _LIGHT,
    ("material", "render_order"): _LIGHT,
    ("material", "shader"): _LIGHT,
    ("material", "shininess"): _LIGHT,
    ("mesh", "convex_decomposition"): "what moves collides as its hull, what stands as its surface",
    ("mimic", "@axis"): "of a joint with two axes the first is followed",
    ("model", "allow_auto_disable"): _REST,
    ("model", "enable_wind"): _WIND,
    ("model", "static"): "the first counts",
    ("ode", "bounce"): "a stop does not throw back",
    ("ode", "cfm"): _ENGINE,
    ("ode", "erp"): _ENGINE,
    ("ode", "fudge_factor"): "limits here do not overshoot",
    ("ode", "max_force"): "Gazebo does not read it either: a joint is driven by a plugin",
    ("ode", "max_vel"): "it belongs to <contact>",
    ("ode", "min_depth"): "it belongs to <contact>",
    ("ode", "soft_cfm"): _STIFFNESS,
    ("ode", "soft_erp"): _STIFFNESS,
    ("ode", "suspension"): "only a revolute2 has one",
    ("ode", "velocity"): "Gazebo does not read it either: a joint is driven by a plugin",
    ("pbr", "metal"): _SURFACE,
    ("pbr", "specular"): _SURFACE,
    ("physics", "bullet"): _ENGINE,
    ("physics", "dart"): _ENGINE,
    ("physics", "max_contacts"): "all contacts count",
    ("physics", "ode"): _ENGINE,
    ("physics", "simbody"): _ENGINE,
    ("scene", "fog"): "the air is clear",
    ("scene", "grid"): _WINDOW,
    ("scene", "origin_visual"): _WINDOW,
    ("scene", "shadow_caster_material_name"): "no shadows are drawn",
    ("scene", "sky"): "the background has one colour",
    ("state", "iterations"): _TIME,
    ("state", "real_time"): _TIME,
    ("state", "sim_time"): _TIME,
    ("state", "wall_time"): _TIME,
    ("surface", "soft_contact"): _OTHER_ENGINE,
    ("texture", "normal"): _TERRAIN,
    ("texture", "size"): _TERRAIN,
    ("torsional", "ode"): "what turns on the spot meets friction, not slip",
    ("visual", "meta"): "the viewer has no layers",
    ("visual", "visibility_flags"): "every camera sees every visual",
    ("world", "audio"): "nothing is heard",
    **{
        (workflow, tag): _SURFACE
        for workflow, own in (
            ("metal", ("metalness", "metalness_map", "roughness", "roughness_map")),
            ("specular", ("glossiness", "glossiness_map", "specular_map")),
        )
        for tag in (
            *own,
            "ambient_occlusion_map",
            "emissive_map",
            "environment_map",
            "light_map",
            "normal_map",
        )
    },
}
"""By an element's tag and its child's, or its attribute's name after an ``@``."""
