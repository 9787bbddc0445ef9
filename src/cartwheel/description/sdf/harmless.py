"""SDF elements without effect here that need a note instead of a warning."""

_ENGINE = "it configures a solver that Cartwheel does not use"
_OTHER_ENGINE = "it is for a different physics engine"
_WINDOW = "it configures Gazebo's user interface"
_STIFFNESS = "kp and kd set the stiffness of contacts, as in Gazebo"
_LIGHT = "the renderer does not support it"
_STATE = "it is computed from the restored state"
_TIME = "time starts at 0"
_TERRAIN = "terrain is rendered with one colour or one texture, in full detail"
_REST = "bodies at rest are put to sleep automatically"
_STOP = "the stiffness of joint limits is fixed"
_MEASURED = "it is computed from the geometry because auto is true"
_SURFACE = "only the colour image of a physically based material is rendered"
_INERTIA = 'it is only used with <inertial auto="true">'

HARMLESS: dict[tuple[str, str], str] = {
    ("axis", "initial_position"): "Gazebo does not read it either; joints start at 0",
    ("axis2", "initial_position"): "Gazebo does not read it either; joints start at 0",
    ("bullet", "fdir1"): _OTHER_ENGINE,
    ("collision", "auto_inertia_params"): _INERTIA,
    ("collision", "density"): _INERTIA,
    ("contact", "bullet"): _OTHER_ENGINE,
    ("contact", "collide_without_contact_bitmask"): "only <collide_without_contact> is used",
    ("contact", "elastic_modulus"): _STIFFNESS,
    ("contact", "poissons_ratio"): _STIFFNESS,
    ("friction", "bullet"): _OTHER_ENGINE,
    ("heightmap", "blend"): _TERRAIN,
    ("heightmap", "sampling"): _TERRAIN,
    ("heightmap", "use_terrain_paging"): _TERRAIN,
    ("include", "allow_auto_disable"): _REST,
    ("inertial", "auto_inertia_params"): "the inertia is computed from the solid itself",
    ("inertial", "density"): _INERTIA,
    ("inertial", "inertia"): _MEASURED,
    ("inertial", "pose"): _MEASURED,
    ("light", "visualize"): _WINDOW,
    ("limit", "dissipation"): _STOP,
    ("limit", "stiffness"): _STOP,
    ("link", "acceleration"): _STATE,
    ("link", "static"): "it must be in the <model>",
    ("link", "wrench"): _STATE,
    ("material", "ambient"): "surfaces have only a diffuse colour",
    ("material", "double_sided"): _LIGHT,
    ("material", "lighting"): _LIGHT,
    ("material", "render_order"): _LIGHT,
    ("material", "shader"): _LIGHT,
    ("material", "shininess"): _LIGHT,
    (
        "mesh",
        "convex_decomposition",
    ): "moving meshes collide as convex hulls, static meshes as surfaces",
    ("mimic", "@axis"): "the joint mimics the first axis",
    ("model", "allow_auto_disable"): _REST,
    ("model", "static"): "the first one is used",
    ("ode", "bounce"): "joints do not bounce off their limits",
    ("ode", "cfm"): _ENGINE,
    ("ode", "erp"): _ENGINE,
    ("ode", "fudge_factor"): "it corrects an error of ODE that does not exist in MuJoCo",
    ("ode", "max_force"): "Gazebo does not read it either: joints are driven by plugins",
    ("ode", "max_vel"): "it belongs in <contact>",
    ("ode", "min_depth"): "it belongs in <contact>",
    ("ode", "soft_cfm"): _STIFFNESS,
    ("ode", "soft_erp"): _STIFFNESS,
    ("ode", "suspension"): "only revolute2 joints have a suspension",
    ("ode", "velocity"): "Gazebo does not read it either: joints are driven by plugins",
    ("pbr", "metal"): _SURFACE,
    ("pbr", "specular"): _SURFACE,
    ("physics", "bullet"): _ENGINE,
    ("physics", "dart"): _ENGINE,
    ("physics", "max_contacts"): "all contacts are used",
    ("physics", "ode"): _ENGINE,
    ("physics", "simbody"): _ENGINE,
    ("scene", "fog"): "fog is not rendered",
    ("scene", "grid"): _WINDOW,
    ("scene", "origin_visual"): _WINDOW,
    ("scene", "shadow_caster_material_name"): "shadows are not rendered",
    ("scene", "sky"): "the background has one colour",
    ("state", "iterations"): _TIME,
    ("state", "real_time"): _TIME,
    ("state", "sim_time"): _TIME,
    ("state", "wall_time"): _TIME,
    ("surface", "soft_contact"): _OTHER_ENGINE,
    ("texture", "normal"): _TERRAIN,
    ("texture", "size"): _TERRAIN,
    ("torsional", "ode"): "torsional friction has no slip",
    ("visual", "meta"): "the web interface has no layers",
    ("visual", "visibility_flags"): "every camera sees every visual",
    ("world", "audio"): "audio is not supported",
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
"""By an element's tag and its child's tag, or its attribute's name after an ``@``."""
