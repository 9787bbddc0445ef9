"""CW201 to CW299: links, joints, masses and wheels."""

from cartwheel.errors import Code

DUPLICATE_NAME = Code(
    "CW201", "duplicate-name", "error", "two links, or two joints, have the same name"
)
NAME_MISSING = Code("CW202", "name-missing", "error", "a link, joint or sensor has no name")
JOINT_LINK_UNKNOWN = Code(
    "CW203",
    "joint-link-unknown",
    "error",
    "the parent or child of a joint is not a link of the robot",
)
WHEEL_SEPARATION_MISMATCH = Code(
    "CW204",
    "wheel-separation-mismatch",
    "warning",
    "a drive's wheel separation differs from the distance between its wheels",
)
JOINT_TYPE_UNKNOWN = Code(
    "CW205", "joint-type-unknown", "error", "a joint has a type that URDF does not define"
)
MULTIPLE_PARENTS = Code(
    "CW206", "multiple-parents", "error", "a link is the child of more than one joint"
)
KINEMATIC_LOOP = Code("CW207", "kinematic-loop", "error", "joints connect links in a loop")
MULTIPLE_ROOTS = Code(
    "CW208", "multiple-roots", "error", "a link is not connected to the rest of the robot"
)
MIMIC_UNKNOWN = Code(
    "CW209",
    "mimic-unknown",
    "error",
    "a joint mimics itself, or a joint that does not exist or has no position",
)
REFERENCE_UNKNOWN = Code(
    "CW210",
    "reference-unknown",
    "warning",
    "a <gazebo reference> refers to neither a link nor a joint",
)
LIMIT_MISSING = Code(
    "CW211", "limit-missing", "error", "a revolute or prismatic joint has no <limit>"
)
LIMIT_INCOMPLETE = Code(
    "CW212", "limit-incomplete", "error", "a <limit> has no effort or no velocity"
)
LIMIT_REVERSED = Code(
    "CW213", "limit-reversed", "error", "the lower limit of a joint is above its upper limit"
)
LIMIT_ZERO = Code(
    "CW214", "limit-zero", "warning", "the limits of a joint are equal, so it cannot move"
)
LIMIT_IN_DEGREES = Code(
    "CW215", "limit-in-degrees", "warning", "the limits of a joint are probably in degrees"
)
EFFORT_ZERO = Code(
    "CW216", "effort-zero", "warning", "the effort or velocity limit of a driven joint is zero"
)
AXIS_ZERO = Code("CW217", "axis-zero", "error", "the axis of a joint has length 0")
AXIS_NOT_NORMALIZED = Code(
    "CW218", "axis-not-normalized", "warning", "the axis of a joint is not a unit vector"
)
INERTIA_MISSING = Code(
    "CW219",
    "inertia-missing",
    "warning",
    "a moving link has no <inertial>, so Gazebo ignores the link",
)
INERTIA_IMPOSSIBLE = Code(
    "CW220", "inertia-impossible", "warning", "no rigid body can have this inertia"
)
INERTIA_GEOMETRY_MISMATCH = Code(
    "CW221",
    "inertia-geometry-mismatch",
    "warning",
    "an inertia does not fit the geometry of its link",
)
MASS_NOT_POSITIVE = Code(
    "CW222", "mass-not-positive", "error", "the mass of a moving link is zero or negative"
)
CENTER_OF_MASS_OUTSIDE = Code(
    "CW223",
    "center-of-mass-outside",
    "warning",
    "a centre of mass is far outside the geometry of its link",
)
MASS_IN_GRAMS = Code(
    "CW224", "mass-in-grams", "warning", "a link is denser than any metal; its mass may be in grams"
)
MASS_IMPLAUSIBLE = Code("CW225", "mass-implausible", "warning", "a link weighs more than 100 t")
DRIVE_JOINT_UNKNOWN = Code(
    "CW226", "drive-joint-unknown", "error", "a drive plugin refers to a joint that does not exist"
)
DRIVE_JOINT_NOT_CONTINUOUS = Code(
    "CW227",
    "drive-joint-not-continuous",
    "warning",
    "the joint of a driven wheel is not continuous",
)
WHEELS_SWAPPED = Code(
    "CW228", "wheels-swapped", "warning", "the left wheel of a drive is on the right"
)
WHEEL_AXIS_MISALIGNED = Code(
    "CW229",
    "wheel-axis-misaligned",
    "warning",
    "the axis of a driven wheel points to the right, or is not parallel to the axle",
)
WHEEL_NOT_ROUND = Code(
    "CW230", "wheel-not-round", "warning", "the collision shape of a driven wheel is not round"
)
WHEEL_BASE_MISMATCH = Code(
    "CW231",
    "wheel-base-mismatch",
    "warning",
    "a specified wheel base differs from the distance between the axles",
)
WHEEL_DIAMETER_MISMATCH = Code(
    "CW232",
    "wheel-diameter-mismatch",
    "warning",
    "a specified wheel diameter or radius differs from the size of the wheel",
)
WHEEL_FRICTIONLESS = Code(
    "CW233", "wheel-frictionless", "warning", "a driven wheel has almost no friction"
)
CASTER_FRICTION = Code(
    "CW234", "caster-friction", "info", "a caster slides, and its friction is high"
)
WHEEL_WITHOUT_COLLISION = Code(
    "CW235", "wheel-without-collision", "error", "a driven wheel has no <collision>"
)
BASE_WITHOUT_COLLISION = Code(
    "CW236",
    "base-without-collision",
    "warning",
    "the base of a robot has visuals but no <collision>",
)
WHEELS_OFF_GROUND = Code(
    "CW237",
    "wheels-off-ground",
    "warning",
    "the robot stands on other links, so driven wheels do not touch the ground",
)
OVERLAPPING_COLLISIONS = Code(
    "CW238",
    "overlapping-collisions",
    "warning",
    "two links that can collide overlap when all joints are at 0",
)
SHAPE_OUT_OF_SCALE = Code(
    "CW239",
    "shape-out-of-scale",
    "warning",
    "a shape is far larger or smaller than the rest of the robot",
)
ANGLE_IN_DEGREES = Code(
    "CW240", "angle-in-degrees", "warning", "roll, pitch and yaw are probably in degrees"
)
POSITION_IN_MILLIMETRES = Code(
    "CW241", "position-in-millimetres", "warning", "a position is probably in millimetres"
)
SKID_STEERING = Code(
    "CW242",
    "skid-steering",
    "info",
    "the wheels slide in turns, so the robot does not turn as fast as commanded",
)
UNBALANCED = Code(
    "CW243",
    "unbalanced",
    "info",
    "the centre of mass is not above the points where the robot touches the ground",
)
JOINTS_UNDRIVEN = Code(
    "CW244",
    "joints-undriven",
    "info",
    "no plugin drives the joints of a robot, so they move freely",
)
BODY_ON_GROUND = Code(
    "CW245",
    "body-on-ground",
    "warning",
    "the body of a robot touches the ground as well as its driven wheels",
)
STEERING_REVERSED = Code(
    "CW246",
    "steering-reversed",
    "warning",
    "the axis of a steering joint steers the robot to the wrong side",
)
PLANAR_FRICTION = Code(
    "CW248",
    "planar-friction",
    "info",
    "a robot that a plugin moves over the ground is braked by friction",
)
LIMIT_UNREACHABLE = Code(
    "CW247",
    "limit-unreachable",
    "error",
    "a joint starts far outside its limits, which it cannot reach",
)
WHEELS_TOED = Code(
    "CW249", "wheels-toed", "info", "steered wheels do not point ahead while they are not steered"
)
ROOT_NOT_HELD = Code(
    "CW250", "root-not-held", "warning", "motors push against a light root link that nothing holds"
)
DAMPING_TOO_HIGH = Code(
    "CW252",
    "damping-too-high",
    "warning",
    "the effort limit of a joint hardly moves it against its damping",
)
DRIVES_APART = Code(
    "CW251",
    "drives-apart",
    "info",
    "drives with topics of their own move the same robot, and brake each other",
)
WHEEL_SPEED_LIMITED = Code(
    "CW253",
    "wheel-speed-limited",
    "warning",
    "the velocity limit of a wheel's joint lets the robot hardly drive",
)
BASE_FIXED = Code(
    "CW254", "base-fixed", "warning", "a robot that wheels should drive is fixed to the world"
)
WHEELS_BRAKED = Code(
    "CW255",
    "wheels-braked",
    "warning",
    "wheels without motors brake a robot more than its driven wheels can push it",
)
WHEEL_FRICTION_OBLIQUE = Code(
    "CW256",
    "wheel-friction-oblique",
    "warning",
    "the friction of a driven wheel is oblique to its rolling direction",
)
MIMIC_OUT_OF_LIMITS = Code(
    "CW257",
    "mimic-out-of-limits",
    "warning",
    "a joint mimics another one to positions that its own limits exclude",
)
START_OUTSIDE_LIMITS = Code(
    "CW258", "start-outside-limits", "info", "a joint starts outside its limits"
)
SINKS_IN_WATER = Code(
    "CW259",
    "sinks-in-water",
    "warning",
    "a vehicle in water is much heavier than the water that it displaces",
)
