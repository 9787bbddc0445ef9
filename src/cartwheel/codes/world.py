"""CW601 to CW699: world and physics."""

from cartwheel.errors import Code

UNKNOWN_MODEL = Code(
    "CW601", "unknown-model", "error", "the world does not have a model with this name"
)
UNKNOWN_JOINT = Code(
    "CW602", "unknown-joint", "error", "the model does not have a movable joint with this name"
)
NUMBER_OUT_OF_RANGE = Code(
    "CW603", "number-out-of-range", "error", "a number is not finite or is too large"
)
REAL_TIME_FACTOR_INVALID = Code(
    "CW604", "real-time-factor-invalid", "error", "the real-time factor is out of range"
)
STEP_COUNT_INVALID = Code(
    "CW605", "step-count-invalid", "error", "the number of simulation steps is out of range"
)
MODEL_NAME_INVALID = Code(
    "CW606",
    "model-name-invalid",
    "error",
    "the name of a model is empty or contains ::",
)
MODEL_NAME_TAKEN = Code(
    "CW607", "model-name-taken", "error", "a model with this name is already in the world"
)
JOINT_DRIVEN_BY_PLUGIN = Code(
    "CW608", "joint-driven-by-plugin", "error", "a plugin drives the joint by effort or position"
)
SIMULATION_CLOSED = Code("CW609", "simulation-closed", "error", "the simulation is closed")
SIMULATION_DIVERGED = Code(
    "CW610", "simulation-diverged", "error", "positions or speeds grew without bound"
)
SIMULATION_RECOVERED = Code(
    "CW611",
    "simulation-recovered",
    "warning",
    "the simulation diverged, and all models are back where they were spawned",
)
TOO_MANY_CONTACTS = Code(
    "CW612", "too-many-contacts", "error", "the models have more contacts than can be simulated"
)
PHYSICS_WARNING = Code("CW613", "physics-warning", "warning", "MuJoCo reports a warning")
FRICTION_DIRECTION_UNSUPPORTED = Code(
    "CW614",
    "friction-direction-unsupported",
    "warning",
    "anisotropic friction is not available with this MuJoCo version",
)
MODELS_OVERLAP = Code("CW615", "models-overlap", "warning", "a model overlaps another model")
CHAIN_TOO_LONG = Code(
    "CW616", "chain-too-long", "error", "a chain of links is too long to simulate"
)
LOOP_WITHOUT_ROOT = Code(
    "CW617", "loop-without-root", "error", "a link is part of a loop of joints without a root"
)
PLANE_NOT_STATIC = Code(
    "CW618", "plane-not-static", "error", "an infinite plane is part of a link that can move"
)
MODEL_NOT_BUILT = Code("CW619", "model-not-built", "error", "the physics engine rejects a model")
PHYSICS_SETTING_IGNORED = Code(
    "CW620", "physics-setting-ignored", "info", "a physical property is not simulated"
)
OPENGL_MISSING = Code(
    "CW621", "opengl-missing", "warning", "cameras require OpenGL, which is not available"
)
OPENGL_FORKED = Code(
    "CW622",
    "opengl-forked",
    "error",
    "cameras cannot render because the process was forked after OpenGL was opened",
)
CALLBACK_FAILED = Code(
    "CW623", "callback-failed", "error", "a callback or command raised an exception"
)
WORLD_FORKED = Code(
    "CW624",
    "world-forked",
    "error",
    "a forked process uses a world that its parent connected to other programs",
)
RUN_NESTED = Code("CW625", "run-nested", "error", "a callback runs the world that called it")
CHAIN_DRAG = Code(
    "CW626", "chain-drag", "info", "drag acts on the hinges of a chain, such as a robot arm"
)
TYRES_ROUNDED = Code("CW627", "tyres-rounded", "info", "wheels collide as ellipsoids")
SLIDING_SOFTENED = Code(
    "CW628", "sliding-softened", "info", "friction of a sliding body is softer than its contacts"
)
INERTIA_RAISED = Code(
    "CW629", "inertia-raised", "info", "a moment of inertia is raised to a positive value"
)
FRICTION_LIMITED = Code(
    "CW630",
    "friction-limited",
    "info",
    "the friction of a part that a base must slide on the ground is limited",
)
FIXED_TO_WORLD = Code(
    "CW631",
    "fixed-to-world",
    "error",
    "a model or link cannot be pushed or get a velocity, because it is fixed to the world",
)
VALUE_INVALID = Code(
    "CW632",
    "property-value-invalid",
    "error",
    "a property of a model or link cannot have this value",
)
WAIT_TIMED_OUT = Code(
    "CW633",
    "wait-timed-out",
    "error",
    "a condition, message or result did not come within the simulation time allowed",
)
CONDITION_INVALID = Code(
    "CW634", "condition-invalid", "error", "the condition of a run is not a function"
)
STATE_MISMATCH = Code(
    "CW635", "state-mismatch", "error", "a saved state does not fit the world that restores it"
)
PROPERTY_ABSENT = Code(
    "CW636", "property-absent", "error", "a link or joint does not have the property to set"
)
EMBREE_MISSING = Code(
    "CW637", "embree-missing", "info", "the rays of lidars are computed without Embree"
)
BATCH_INVALID = Code(
    "CW638", "batch-invalid", "error", "an argument of a batch of worlds is invalid"
)
BATCH_PROCESS_ENDED = Code(
    "CW639", "batch-process-ended", "error", "a process with worlds of a batch has ended"
)
BATCH_CLOSED = Code("CW640", "batch-closed", "error", "a batch of worlds is used after its end")
SWEEP_INVALID = Code("CW641", "sweep-invalid", "error", "an argument of a sweep is invalid")
CLUSTER_UNUSABLE = Code(
    "CW642", "cluster-unusable", "error", "a Ray cluster cannot run the cases of a sweep"
)
DATASET_INVALID = Code("CW643", "dataset-invalid", "error", "an argument of a dataset is invalid")
WARP_MISSING = Code("CW644", "warp-missing", "error", "MuJoCo Warp is not installed")
WARP_DEVICE_UNUSABLE = Code(
    "CW645", "warp-device-unusable", "error", "the device of a Warp batch does not exist"
)
WARP_UNSUPPORTED = Code(
    "CW646", "warp-unsupported", "error", "a Warp batch cannot simulate a world"
)
STEP_SHORTENED = Code(
    "CW647", "step-shortened", "info", "a controller needs a shorter time step than the default"
)
HULLS_APART = Code(
    "CW648", "hulls-apart", "info", "links with overlapping convex hulls do not collide"
)
