//! The keys of `*.robot.toml`.

use super::schema::{Key, Kind, Length, POSE, Range, Rule, TableSchema, Text, VECTOR};

const JOINTS: Kind = Kind::List(&Kind::Text(Text::Joint), Length::AtLeast(1));
const NUMBERS: Kind = Kind::List(&Kind::Number(Range::ANY), Length::AtLeast(1));

/// A robot specification.
pub(super) static ROBOT: TableSchema = TableSchema {
    doc: "A robot: its description file, and what each part of it is for.",
    keys: &[
        Key::required("format", Kind::Integer(1, 1), "Version of this file format."),
        Key::required("name", Kind::Text(Text::Name), "Name of the robot in reports and artefacts."),
        Key::required("description", Kind::Text(Text::Path), "URDF or xacro file, relative to this file."),
        Key::optional(
            "srdf",
            Kind::Text(Text::Path),
            "SRDF file. Its disabled pairs join `self_collision.ignore`; if no `[[arm]]` is written, its chain groups \
             become the arms.",
        ),
        Key::optional(
            "joint_limits",
            Kind::Text(Text::Path),
            "MoveIt's `joint_limits.yaml`. Overrides the limits of the description; `[limits]` overrides it.",
        ),
        Key::optional(
            "packages",
            Kind::Map(Text::Package, &Kind::Text(Text::Path)),
            "Folder of each ROS package that mesh paths `package://NAME/...` name. Packages not listed are looked for \
             beside and above the description.",
        ),
        Key::optional(
            "shapeless",
            Kind::List(&Kind::Text(Text::Link), Length::AtLeast(1)),
            "Links whose missing collision meshes are accepted: what those meshes would show touches nothing.",
        ),
        Key::optional(
            "arguments",
            Kind::Map(Text::Argument, &Kind::Text(Text::Any)),
            "Values of the arguments (`$(arg NAME)`) of a xacro description; they override its defaults.",
        ),
        Key::optional("base", Kind::Table(&BASE), "How the robot stands.").default("{ kind = \"fixed\" }"),
        Key::optional(
            "arm",
            Kind::Tables(&ARM, Some("name")),
            "A serial manipulator. At least one, unless an SRDF supplies them.",
        ),
        Key::optional("gripper", Kind::Tables(&GRIPPER, Some("name")), "A gripper or hand."),
        Key::optional("camera", Kind::Tables(&CAMERA, Some("name")), "A camera fixed to a link."),
        Key::optional("self_collision", Kind::Table(&SELF_COLLISION), "What the robot may touch of itself."),
        Key::optional(
            "limits",
            Kind::Table(&LIMITS),
            "Limits of joints that its files leave open or get wrong.",
        ),
        Key::optional(
            "weights",
            Kind::Map(Text::Joint, &Kind::Number(Range::POSITIVE)),
            "Weight of a joint in the distance between configurations. Joints not named get a computed weight.",
        ),
        Key::optional(
            "parameters",
            Kind::Parameters,
            "Parameters of artefact kinds for this robot; the defaults follow the model's size.",
        ),
    ],
    rules: &[],
};

static BASE: TableSchema = TableSchema {
    doc: "How the robot stands.",
    keys: &[
        Key::required(
            "kind",
            Kind::Choice(&["fixed", "planar"]),
            "`fixed`: bolted down. `planar`: drives on a plane.",
        ),
        Key::optional(
            "footprint",
            Kind::List(&Kind::List(&Kind::Number(Range::ANY), Length::Exactly(2)), Length::AtLeast(3)),
            "Corners of the outline on the ground, in the root frame.",
        )
        .unit("m"),
        Key::optional("holonomic", Kind::Bool, "Whether it can move sideways.").default("false"),
        Key::optional(
            "joints",
            Kind::List(&Kind::Text(Text::Joint), Length::Exactly(3)),
            "Joints of the description that stand for its driving: along x and along y of the root, then about z. With them a \
             task drives to where it can reach what it has to.",
        ),
    ],
    rules: &[
        Rule::Goes { key: "kind", value: "planar", then: "footprint" },
        Rule::OnlyWith { keys: &["holonomic", "joints"], with: "footprint" },
    ],
};

static ARM: TableSchema = TableSchema {
    doc: "A serial manipulator: the chain of joints from one link to another.",
    keys: &[
        Key::required("name", Kind::Text(Text::Name), "Name of the arm."),
        Key::required("base", Kind::Text(Text::Link), "Link where the chain starts."),
        Key::required(
            "tip",
            Kind::Text(Text::Link),
            "Link where the chain ends: inverse kinematics places it.",
        ),
        Key::optional("gripper", Kind::Text(Text::Gripper), "The gripper it carries."),
        Key::optional(
            "free",
            JOINTS,
            "Joints whose value is chosen, not solved for, when the chain has more joints than needed. Default: \
             the compiler's choice.",
        ),
        Key::optional("home", NUMBERS, "A resting position: a value for each moving joint, base to tip.")
            .unit("rad or m"),
    ],
    rules: &[],
};

static GRIPPER: TableSchema = TableSchema {
    doc: "A gripper: parallel jaws, fingers, or tips that attract: magnets, suction cups.",
    keys: &[
        Key::required("name", Kind::Text(Text::Name), "Name of the gripper."),
        Key::required(
            "palm",
            Kind::Text(Text::Link),
            "The link that the fingers hang on. It must be rigidly fixed to the arm's tip.",
        ),
        Key::required(
            "tool",
            Kind::Table(&POSE),
            "The tool frame in the palm frame: grasps are given for it. Its origin lies between the closed fingers.",
        ),
        Key::optional("approach", VECTOR, "Direction of approach, in the tool frame; any length.")
            .default("[0.0, 0.0, 1.0]"),
        Key::optional(
            "hold",
            Kind::Choice(&["close", "attract"]),
            "`close`: the fingers close on what is grasped. `attract`: they are magnets or suction cups, which touch it.",
        )
        .default("\"close\""),
        Key::optional("joints", JOINTS, "The joints that move the fingers; joints that mimic are not named."),
        Key::optional(
            "closing",
            Kind::List(&Kind::Number(Range::between(-1.0, 1.0)), Length::AtLeast(1)),
            "For each of `joints`: 1 or -1 when it closes by growing or shrinking, 0 when it only shapes the hand.",
        ),
        Key::required(
            "fingers",
            Kind::List(&Kind::Text(Text::Link), Length::AtLeast(1)),
            "The links that may touch what is grasped.",
        ),
        Key::optional(
            "preshape",
            Kind::Tables(&PRESHAPE, Some("name")),
            "A position of the fingers to approach with. Default: one, `open`, with every closing joint at the limit it \
             opens to.",
        ),
    ],
    rules: &[Rule::Unless {
        key: "hold",
        value: "attract",
        needed: &["joints", "closing"],
        allowed: &["preshape"],
    }],
};

static PRESHAPE: TableSchema = TableSchema {
    doc: "A position of the fingers before a grasp.",
    keys: &[
        Key::required("name", Kind::Text(Text::Name), "Name of the preshape."),
        Key::required("values", NUMBERS, "A value for each of the gripper's `joints`.").unit("rad or m"),
    ],
    rules: &[],
};

static CAMERA: TableSchema = TableSchema {
    doc: "A camera fixed to a link.",
    keys: &[
        Key::required("name", Kind::Text(Text::Name), "Name of the camera."),
        Key::required("link", Kind::Text(Text::Link), "The link it is fixed to."),
        Key::optional(
            "pose",
            Kind::Table(&POSE),
            "The optical frame in the link frame: z looks out, x points right in the image. Default: the link frame.",
        ),
        Key::required(
            "size",
            Kind::List(&Kind::Integer(1, 1 << 20), Length::Exactly(2)),
            "Width and height of the image.",
        )
        .unit("px"),
        Key::required(
            "intrinsics",
            Kind::List(&Kind::Number(Range::POSITIVE), Length::Exactly(4)),
            "Focal lengths and principal point: fx, fy, cx, cy.",
        )
        .unit("px"),
    ],
    rules: &[],
};

static SELF_COLLISION: TableSchema = TableSchema {
    doc: "What the robot may touch of itself.",
    keys: &[Key::optional(
        "ignore",
        Kind::List(&Kind::List(&Kind::Text(Text::Link), Length::Exactly(2)), Length::Any),
        "Pairs of links that are never tested against each other. Pairs that cannot touch are found without this.",
    )],
    rules: &[],
};

static LIMITS: TableSchema = TableSchema {
    doc: "Limits of joints. The first that is given counts: `joints` here, `joint_limits`, the description, `default` \
          here, and last a careful default with a warning.",
    keys: &[
        Key::optional("default", Kind::Table(&DEFAULT_LIMITS), "For whatever the files leave open."),
        Key::optional(
            "joints",
            Kind::Map(Text::Joint, &Kind::Table(&JOINT_LIMITS)),
            "For one joint; overrides all files.",
        ),
    ],
    rules: &[],
};

const VELOCITY: Key =
    Key::optional("velocity", Kind::Number(Range::POSITIVE), "Largest speed.").unit("rad/s or m/s");
const ACCELERATION: Key =
    Key::optional("acceleration", Kind::Number(Range::POSITIVE), "Largest acceleration.")
        .unit("rad/s^2 or m/s^2");
const JERK: Key =
    Key::optional("jerk", Kind::Number(Range::POSITIVE), "Largest jerk.").unit("rad/s^3 or m/s^3");

static DEFAULT_LIMITS: TableSchema = TableSchema {
    doc: "For whatever the files leave open.",
    keys: &[VELOCITY, ACCELERATION, JERK],
    rules: &[],
};

static JOINT_LIMITS: TableSchema = TableSchema {
    doc: "Limits of one joint.",
    keys: &[
        Key::optional("lower", Kind::Number(Range::ANY), "Smallest value.").unit("rad or m"),
        Key::optional("upper", Kind::Number(Range::ANY), "Largest value.").unit("rad or m"),
        VELOCITY,
        ACCELERATION,
        JERK,
    ],
    rules: &[],
};
