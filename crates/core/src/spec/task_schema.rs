//! The keys of `*.task.toml`.

use super::schema::{Key, Kind, Length, POSE, Range, Rule, TableSchema, Text};

const SIZE: Kind = Kind::List(&Kind::Number(Range::POSITIVE), Length::Exactly(3));
const SHAPES: Rule = Rule::ExactlyOne(&["mesh", "box", "cylinder", "capsule", "sphere"]);
const OBSTACLE_SHAPES: Rule =
    Rule::ExactlyOne(&["mesh", "box", "cylinder", "capsule", "sphere", "cloud", "heights"]);
const MESH_ONLY: Rule = Rule::OnlyWith { keys: &["units", "up", "scale"], with: "mesh" };

const NAME: Key =
    Key::required("name", Kind::Text(Text::Name), "Name, unique among objects, obstacles and articles.");
const MESH: Key =
    Key::optional("mesh", Kind::Text(Text::Path), "STL, OBJ or COLLADA file, relative to this file.");
const UNITS: Key = Key::optional(
    "units",
    Kind::Choice(&["m", "cm", "mm", "inch"]),
    "Unit of the numbers in the mesh file. Default: metres, or what a COLLADA file says.",
);
const FILE_UNITS: Key = Key::optional(
    "units",
    Kind::Choice(&["m", "cm", "mm", "inch"]),
    "Unit of the numbers in the file. Default: metres.",
);
const UP: Key = Key::optional(
    "up",
    Kind::Choice(&["y", "z"]),
    "Which axis of the mesh file points up; it becomes z. Default: z, or what a COLLADA file says.",
);
const SCALE: Key =
    Key::optional("scale", Kind::Number(Range::POSITIVE), "Factor beside `units`.").default("1.0");
const BOX: Key = Key::optional("box", SIZE, "Box: full edge lengths along x, y, z, centred.").unit("m");
const CYLINDER: Key = Key::optional("cylinder", Kind::Table(&ROUND), "Cylinder along z, centred.");
const CAPSULE: Key =
    Key::optional("capsule", Kind::Table(&ROUND), "Cylinder along z with half spheres at its ends, centred.");
const SPHERE: Key =
    Key::optional("sphere", Kind::Number(Range::POSITIVE), "Sphere of this radius, centred.").unit("m");
const COLOUR: Key =
    Key::optional("colour", Kind::Text(Text::Colour), "Colour in pictures, as `\"#rrggbb\"`.");
const WORLD_POSE: Key =
    Key::optional("pose", Kind::Table(&POSE), "Where it stands in the world. Default: at the origin.");

/// A task specification.
pub(super) static TASK: TableSchema = TableSchema {
    doc: "A task: what stands where, and what the robot shall do.",
    keys: &[
        Key::required("format", Kind::Integer(1, 1), "Version of this file format."),
        Key::required("name", Kind::Text(Text::Name), "Name of the task in reports and artefacts."),
        Key::required("robot", Kind::Text(Text::Path), "The robot specification, relative to this file."),
        Key::optional("arm", Kind::Text(Text::Arm), "The arm that does it. Needed when the robot has several."),
        Key::optional("seed", Kind::Integer(0, i64::MAX), "Root of all randomness.").default("0"),
        Key::optional("robot_pose", Kind::Table(&POSE), "Where the robot's root stands. Default: at the origin."),
        Key::optional(
            "start",
            Kind::Map(Text::Joint, &Kind::Number(Range::ANY)),
            "Joint values at the start. Joints not named: the arms' `home`, the grippers' first preshape, else zero.",
        )
        .unit("rad or m"),
        Key::optional("object", Kind::Tables(&OBJECT, Some("name")), "Something that can be grasped and moved."),
        Key::optional("obstacle", Kind::Tables(&OBSTACLE, Some("name")), "Something that stays where it is."),
        Key::optional(
            "article",
            Kind::Tables(&ARTICLE, Some("name")),
            "Something with a joint of its own: a door, a drawer, a lever.",
        ),
        Key::required("goal", Kind::Tables(&GOAL, None), "What shall happen; several goals happen in order."),
        Key::optional(
            "parameters",
            Kind::Parameters,
            "Parameters of artefact kinds for this task; they override the robot's one by one.",
        ),
    ],
    rules: &[],
};

static ROUND: TableSchema = TableSchema {
    doc: "A round shape along z.",
    keys: &[
        Key::required("radius", Kind::Number(Range::POSITIVE), "Radius.").unit("m"),
        Key::required("length", Kind::Number(Range::POSITIVE), "Length along z, without half spheres.")
            .unit("m"),
    ],
    rules: &[],
};

static OBJECT: TableSchema = TableSchema {
    doc: "Something that can be grasped and moved. Its z axis points up when it stands.",
    keys: &[
        NAME,
        MESH,
        UNITS,
        UP,
        SCALE,
        BOX,
        CYLINDER,
        CAPSULE,
        SPHERE,
        Key::required("mass", Kind::Number(Range::POSITIVE), "Mass.").unit("kg"),
        Key::optional(
            "friction",
            Kind::Number(Range::between(0.0, 10.0)),
            "Coulomb friction between object and fingers.",
        )
        .default("0.5"),
        COLOUR,
        WORLD_POSE,
    ],
    rules: &[SHAPES, MESH_ONLY],
};

static OBSTACLE: TableSchema = TableSchema {
    doc: "Something that stays where it is.",
    keys: &[
        NAME,
        MESH,
        UNITS,
        UP,
        SCALE,
        BOX,
        CYLINDER,
        CAPSULE,
        SPHERE,
        Key::optional("cloud", Kind::Table(&CLOUD), "Measured points, in the frame of the file."),
        Key::optional(
            "heights",
            Kind::Table(&HEIGHTS),
            "Measured heights on a grid, solid below; the origin is at the first sample.",
        ),
        COLOUR,
        WORLD_POSE,
    ],
    rules: &[OBSTACLE_SHAPES, MESH_ONLY],
};

static CLOUD: TableSchema = TableSchema {
    doc: "Measured points, each with a ball about it.",
    keys: &[
        Key::required(
            "file",
            Kind::Text(Text::Path),
            "PLY, PCD, NPY or text file with points, relative to this file. Points that are no numbers are left out.",
        ),
        Key::required(
            "radius",
            Kind::Number(Range::POSITIVE),
            "Radius of each ball. With half the distance of neighbours or more, surfaces have no holes.",
        )
        .unit("m"),
        FILE_UNITS,
        Key::optional(
            "without_robot",
            Kind::Number(Range::between(0.0, 1.0)),
            "Points this near to the robot where it starts are its own and left out. Default: all points count.",
        )
        .unit("m"),
    ],
    rules: &[],
};

static HEIGHTS: TableSchema = TableSchema {
    doc: "Measured heights on a regular grid: x grows along a row, y from row to row, the first row being that at the top of an image or text.",
    keys: &[
        Key::required(
            "file",
            Kind::Text(Text::Path),
            "Grey PNG, NPY or text file with heights, relative to this file. Where it has no number, or a transparent place, there is a hole.",
        ),
        Key::required(
            "spacing",
            Kind::List(&Kind::Number(Range::POSITIVE), Length::Exactly(2)),
            "Distance of neighbours along x and y.",
        )
        .unit("m"),
        Key::optional(
            "range",
            Kind::List(&Kind::Number(Range::ANY), Length::Exactly(2)),
            "Heights of black and of white. Needed for images.",
        )
        .unit("m"),
        FILE_UNITS,
        Key::optional(
            "missing",
            Kind::Number(Range::ANY),
            "A number of the file that says that nothing was measured. Default: none does.",
        ),
        Key::optional(
            "floor",
            Kind::Number(Range::ANY),
            "z down to which it is solid. Default: one spacing below the lowest height.",
        )
        .unit("m"),
    ],
    rules: &[],
};

static ARTICLE: TableSchema = TableSchema {
    doc: "Something with a joint of its own. Its links are obstacles where they stand; caging grasps are computed for it.",
    keys: &[
        NAME,
        Key::required(
            "description",
            Kind::Text(Text::Path),
            "URDF or xacro file of it, relative to this file.",
        ),
        Key::required("joint", Kind::Text(Text::Joint), "The joint that opens it."),
        Key::optional(
            "handle",
            Kind::Text(Text::Link),
            "The link that a gripper takes it by. Default: the one that the joint moves.",
        ),
        Key::optional(
            "value",
            Kind::Number(Range::ANY),
            "Where the joint stands at the start. Default: zero, or what is nearest to it within the limits.",
        )
        .unit("rad or m"),
        Key::optional(
            "friction",
            Kind::Number(Range::between(0.0, 10.0)),
            "Coulomb friction between handle and fingers.",
        )
        .default("0.5"),
        WORLD_POSE,
    ],
    rules: &[],
};

static GOAL: TableSchema = TableSchema {
    doc: "Something that shall happen.",
    keys: &[
        Key::optional("place", Kind::Text(Text::Object), "Pick this object up and put it down."),
        Key::optional(
            "or",
            Kind::List(&Kind::Text(Text::Object), Length::AtLeast(1)),
            "Other objects of which any one does as well: grasps of all of them are tried, the most promising first.",
        ),
        Key::optional("at", Kind::Table(&POSE), "Where its frame shall end up in the world."),
        Key::optional(
            "any_yaw",
            Kind::Bool,
            "Whether any turn about the vertical is as good as that of `at`.",
        )
        .default("false"),
        Key::optional("region", Kind::Table(&REGION), "A rectangle on a surface to put it down in, upright."),
        Key::optional(
            "keep_upright",
            Kind::Number(Range::HALF_TURN),
            "Largest tilt of the object's z axis while it is carried. Default: no limit.",
        )
        .unit("rad"),
        Key::optional(
            "open",
            Kind::Text(Text::Name),
            "Move the joint of this article, with a loose grip on its handle.",
        ),
        Key::optional(
            "to",
            Kind::Number(Range::ANY),
            "Value of the joint to end up at. Default: its upper limit.",
        )
        .unit("rad or m"),
    ],
    rules: &[
        Rule::ExactlyOne(&["place", "open"]),
        Rule::OneWith { keys: &["at", "region"], with: "place" },
        Rule::OnlyWith { keys: &["any_yaw"], with: "at" },
        Rule::OnlyWith { keys: &["or", "keep_upright"], with: "place" },
        Rule::OnlyWith { keys: &["to"], with: "open" },
    ],
};

static REGION: TableSchema = TableSchema {
    doc: "A rectangle on a surface.",
    keys: &[
        Key::required(
            "pose",
            Kind::Table(&POSE),
            "Its centre in the world; its z is the height of the surface.",
        ),
        Key::required(
            "size",
            Kind::List(&Kind::Number(Range::POSITIVE), Length::Exactly(2)),
            "Full edge lengths along its x and y.",
        )
        .unit("m"),
    ],
    rules: &[],
};
