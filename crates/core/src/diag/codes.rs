//! Every diagnostic code with its explanation: one entry each, shown by `robotc explain`.
//!
//! R00xx files, R01xx specification syntax and keys, R02xx robot descriptions, R03xx meshes, R04xx robot
//! annotations, R05xx tasks.

/// What `robotc explain CODE` prints.
#[derive(Debug, Clone, Copy)]
pub struct CodeInfo {
    /// The code, such as `R0102`.
    pub code: &'static str,
    /// One line.
    pub title: &'static str,
    /// A paragraph: why this is a finding, and how to mend it.
    pub text: &'static str,
}

/// The entry of a code, or `None` if there is no such code.
pub fn explain(code: &str) -> Option<&'static CodeInfo> {
    CODES.iter().find(|info| info.code.eq_ignore_ascii_case(code))
}

const fn entry(code: &'static str, title: &'static str, text: &'static str) -> CodeInfo {
    CodeInfo { code, title, text }
}

/// All codes, ascending.
pub const CODES: &[CodeInfo] = &[
    entry(
        "R0001",
        "file not found",
        "A file named by a specification or on the command line does not exist. Paths in a specification are relative \
         to the folder of that specification; `package://name/...` is looked up in the folders listed under \
         `packages` and in the folders above the description file.",
    ),
    entry(
        "R0002",
        "file cannot be read",
        "The file exists but the operating system would not read it, or it is not UTF-8 text where text is \
         needed.",
    ),
    entry(
        "R0101",
        "not TOML",
        "The text breaks TOML's syntax at this place: a missing quote or bracket, a key without a value, a key or table \
         defined twice. Other findings of the same file are reported as far as the rest can be read.",
    ),
    entry(
        "R0102",
        "unknown key",
        "No part of robotc reads this key, so it is most likely misspelt or stands in the wrong table. Keys are never \
         ignored. `robotc schema robot` and `robotc schema task` print all keys.",
    ),
    entry(
        "R0103",
        "missing key",
        "A table lacks a key that has no default. The place shown is the table; write the key below its \
         header.",
    ),
    entry(
        "R0104",
        "wrong kind of value",
        "The value is of another kind than the key takes: a text where a number is needed, one value where a list is \
         needed. Numbers are written without quotes, texts with them.",
    ),
    entry(
        "R0105",
        "number out of range",
        "The number is outside of the range that makes sense for this key, or is `nan` or `inf`. Lengths are metres, \
         angles radians, masses kilograms: a value a thousand or 57 times too large is often a matter of units.",
    ),
    entry(
        "R0106",
        "wrong number of values",
        "The list is shorter or longer than this key takes, such as two numbers where x, y and z are needed.",
    ),
    entry(
        "R0107",
        "name used twice",
        "Two things of one kind have the same name, so a reference by name could mean either. Rename one.",
    ),
    entry(
        "R0108",
        "unknown word",
        "The key takes one of a few words, and this is none of them. The words allowed are listed with the \
         finding.",
    ),
    entry(
        "R0109",
        "one of several keys",
        "Of a group of keys exactly one must be written, such as the shape of an object: `mesh`, `box`, `cylinder`, \
         `capsule` or `sphere`. Here there is none, or more than one.",
    ),
    entry(
        "R0110",
        "key without a meaning here",
        "The key is known, but nothing reads it beside what else the table says, such as `units` for an object that is \
         not a mesh. Remove it, or add the key it belongs to.",
    ),
    entry(
        "R0111",
        "malformed text",
        "The text does not have the form that the key asks for. Names consist of letters, digits, `_`, `-` and `.`, because \
         they turn up in commands, file names and reports.",
    ),
    entry(
        "R0113",
        "unknown artefact kind",
        "Tables below `parameters` are named after the kinds of artefacts that the compiler makes; `robotc graph` lists \
         them.",
    ),
    entry(
        "R0114",
        "unknown parameter",
        "The artefact kind has no parameter of this name. `robotc schema robot` prints all parameters of \
         all kinds.",
    ),
    entry(
        "R0115",
        "unknown kind of file",
        "Neither the ending of the name nor the content says what this file is. Robot specifications end in \
         `.robot.toml`, task specifications in `.task.toml`.",
    ),
    entry(
        "R0201",
        "not well-formed XML",
        "The file breaks a rule of XML: a tag that is not closed, a value without quotes, a stray `<` or `&`. \
         The place is where the fault was noticed; the cause may stand a little before. All such faults of a \
         file are listed at once.",
    ),
    entry(
        "R0202",
        "oddity of XML repaired",
        "The file is not strictly XML, but has only one sensible reading, which was taken: for example an XML \
         declaration that is not at the start, or text after the root element. Strict readers will refuse the \
         file, so mend it when you can.",
    ),
    entry(
        "R0203",
        "undeclared namespace prefix",
        "A name such as `sensor:camera` uses a prefix that no `xmlns:` attribute declares. The name is taken \
         as it stands. Strict readers will refuse the file; declare the prefix on the root element.",
    ),
    entry(
        "R0204",
        "unresolved merge conflict",
        "The file holds the markers `<<<<<<<`, `=======` and `>>>>>>>` that a version control system leaves \
         when two changes disagree. Choose one of the two versions and delete the marker lines. The first \
         version is checked further, so that its other faults show up too.",
    ),
    entry(
        "R0205",
        "text is not UTF-8",
        "Some bytes of the file make no character in UTF-8, often because it was saved in another encoding. \
         They are read as a replacement character, which matters only where they are part of a name. Save the \
         file as UTF-8.",
    ),
    entry(
        "R0206",
        "file too large or nested too deep",
        "The file is beyond the bounds that protect this program from hostile input. A robot description is \
         seldom larger than a few megabytes or nested deeper than twenty elements.",
    ),
    entry(
        "R0207",
        "not a robot description",
        "The file is XML, but not a URDF robot: its root element is not `<robot>`, or the robot has no links. \
         Fragments that are meant to be included by another file, and unexpanded xacro, look like this.",
    ),
    entry(
        "R0208",
        "element or attribute missing",
        "URDF requires an element or attribute that is not there, such as the `<child>` of a joint or the \
         name of a link.",
    ),
    entry(
        "R0209",
        "not a number",
        "An attribute that holds numbers holds something else, or not as many numbers as it should. Numbers \
         are separated by spaces and written with a point, such as `0.5 -1 1e-3`; `nan` and `inf` are \
         refused.",
    ),
    entry(
        "R0210",
        "unknown element",
        "An element of the robot has a name that is close to one of URDF, and is ignored as it stands. \
         Elements with altogether different names belong to simulators and are ignored without a word.",
    ),
    entry(
        "R0211",
        "xacro left in a URDF",
        "A plain URDF file holds elements of the xacro macro language, which are ignored. If they matter, \
         give the file the ending `.xacro`, and it will be expanded.",
    ),
    entry(
        "R0212",
        "link is not declared",
        "A joint refers to a link that no `<link>` element declares. If it can only be the root, such as \
         `world`, it is added with a warning; else it is an error, often a misspelt name.",
    ),
    entry(
        "R0213",
        "name defined twice",
        "Two links or two joints of one robot have the same name, so references to it would be ambiguous. \
         Copies that say the same are accepted with a warning. A link and a joint may share a name.",
    ),
    entry(
        "R0214",
        "link with two parents",
        "Two joints have the same child link. URDF describes trees, in which every link has one parent; a \
         closed mechanism must be opened at one joint.",
    ),
    entry(
        "R0215",
        "several roots",
        "The robot falls into pieces that no joint connects, so the pose of one piece in the other is \
         unknown. Join them by fixed joints, or describe them in files of their own.",
    ),
    entry(
        "R0216",
        "joints form a loop",
        "Following a link to its parents leads back to the link. URDF describes trees; open the loop by \
         removing one joint.",
    ),
    entry(
        "R0217",
        "link without joints dropped",
        "A link that no joint refers to has no place on the robot. It is dropped.",
    ),
    entry(
        "R0220",
        "unknown joint type",
        "The type of a joint is one of `fixed`, `revolute`, `continuous`, `prismatic`, `floating` and \
         `planar`.",
    ),
    entry(
        "R0221",
        "floating or planar joint",
        "A joint with several degrees of freedom. At the root it only says that the robot can stand anywhere, \
         and it is taken as fixed: tasks say where a robot stands, robot specifications how its base drives. \
         Elsewhere it is refused; write it as a series of prismatic and revolute joints.",
    ),
    entry(
        "R0222",
        "axis without direction",
        "A moving joint needs an axis, and the one given is zero, so that the direction of motion is unknown. \
         Without any `<axis>` URDF means `1 0 0`.",
    ),
    entry(
        "R0223",
        "axis is not a unit vector",
        "Only the direction of an axis counts, so the joint values of this robot are radians or metres all \
         the same. Other programs may scale the motion by the length; mend the file when you can.",
    ),
    entry(
        "R0224",
        "position limits assumed",
        "A revolute or prismatic joint has no position limits that can be used. Limits of the safety \
         controller are taken if there are any; else half a turn or ten metres to both sides. Plans may then \
         use positions that the real joint does not have: write the limits into the description or the robot \
         specification.",
    ),
    entry(
        "R0225",
        "position limits repaired",
        "The lower limit is not below the upper one. Limits the wrong way round are swapped; equal ones are \
         kept, and the joint cannot move.",
    ),
    entry(
        "R0226",
        "mimic joint without leader",
        "A joint mimics another that does not exist, is fixed, or follows in a circle, so nothing gives it a \
         value.",
    ),
    entry(
        "R0227",
        "velocity limit not positive",
        "A velocity limit of zero or less would forbid all motion. It is taken as not given, and a default is \
         used until the robot specification or a joint limit file gives one.",
    ),
    entry(
        "R0230",
        "mass not positive",
        "A link has a mass of zero or less, which no real body has. Its inertia is ignored; motion planning \
         does not need it, dynamics does.",
    ),
    entry(
        "R0231",
        "shape cannot be used",
        "A visual or collision element has no shape, an unknown shape, or a size that is not positive.",
    ),
    entry(
        "R0250",
        "xacro element used wrongly",
        "An element of the macro language lacks an attribute, a macro is called without a parameter that has \
         no default, or with one that it does not have, or a list of parameters cannot be read.",
    ),
    entry(
        "R0251",
        "xacro expression without value",
        "An expression in `${...}` or `$(...)` cannot be evaluated: a name is not defined, an operand has the \
         wrong kind, or the expression is not complete. Expressions are Python's, as far as descriptions use \
         them.",
    ),
    entry(
        "R0252",
        "unknown macro or block",
        "A macro is called, or a block inserted, that nothing has defined up to this place. The file that \
         defines it may have to be included first.",
    ),
    entry(
        "R0253",
        "included file not found",
        "A file named by `<xacro:include>` does not exist, or it is in a package whose folder is not known. \
         Packages are looked up under `packages` in the robot specification, then in the folders above the \
         description.",
    ),
    entry(
        "R0254",
        "xacro expansion without end",
        "A macro or property uses itself, or the expanded description grows beyond all measure. The expansion \
         was stopped.",
    ),
    entry(
        "R0260",
        "semantic description cannot be used",
        "An element of an SRDF file lacks a name, holds something that is not a joint value, or is defined \
         twice. The rest of the file is used.",
    ),
    entry(
        "R0261",
        "name not on the robot",
        "An SRDF file names a link, joint or group that the robot does not have. The entry has no effect; one \
         SRDF often serves several variants of a robot, so this may be as intended.",
    ),
    entry(
        "R0270",
        "not well-formed YAML",
        "A joint limit file breaks a rule of YAML, so nothing in it could be read. Check indentation, \
         brackets and tabs near the place.",
    ),
    entry(
        "R0271",
        "joint limit cannot be used",
        "An entry of a joint limit file is not what MoveIt's format asks for: `joint_limits:` holds a table \
         for each joint with `max_velocity`, `max_acceleration`, `max_jerk`, `min_position`, `max_position` \
         (numbers), and `has_..._limits` (true or false) that turn them off.",
    ),
    entry(
        "R0272",
        "joint limit without effect",
        "A joint limit file names a joint that the robot does not have, or limits that leave the joint no position. The \
         entry is ignored.",
    ),
    entry(
        "R0290",
        "internal disagreement",
        "The description passed all checks, but reading back what was understood gave something else. This is \
         a fault of robotc and not of the file. Please report it.",
    ),
    entry(
        "R0291",
        "robot refused",
        "Links and joints were understood one by one, but make no robot together.",
    ),
    entry(
        "R0301",
        "visual mesh missing",
        "A mesh that shows what a link looks like was not found. The link is drawn without it. References \
         `package://name/...` are looked up in the packages of the robot specification, then in the folders \
         above the description.",
    ),
    entry(
        "R0302",
        "collision mesh missing",
        "A mesh that says where a link is solid was not found. Without it, motion of the joints named in the \
         message could not be checked for collisions, so the robot is refused. `package://name/...` is looked \
         up in the packages of the robot specification, then in the folders above the description. Where the \
         mesh is not to be had and the link may touch nothing, a bracket say, name the link in the list `shapeless` \
         of the robot specification.",
    ),
    entry(
        "R0303",
        "mesh cannot be read",
        "The mesh file is damaged, holds coordinates that are not finite numbers, has no triangles, or is in \
         a format other than STL, OBJ and COLLADA.",
    ),
    entry(
        "R0304",
        "mesh repaired",
        "Faces of a mesh refer to vertices that the file does not hold. They were dropped, so the surface may \
         have holes; export the mesh again if you can.",
    ),
    entry(
        "R0305",
        "another mesh file used",
        "The mesh file named by the description does not exist, but one of the same name with another ending, \
         or at the end of another path, does. It is used.",
    ),
    entry(
        "R0401",
        "unknown link",
        "The specification names a link that the robot description does not have. Links are named as in the \
         URDF, upper and lower case included.",
    ),
    entry(
        "R0402",
        "unknown joint",
        "The specification names a joint that the robot description does not have. Joints are named as in \
         the URDF, upper and lower case included.",
    ),
    entry(
        "R0403",
        "joint without a value of its own",
        "The joint is fixed, or it mimics another joint, so it cannot be set, weighted or limited by \
         itself. Name the joint that it follows, which moves both.",
    ),
    entry(
        "R0404",
        "no chain between base and tip",
        "An arm is the chain of joints from its base link down to its tip link. The tip must be below the \
         base in the tree of links, at least one joint between them must move, and none of them may mimic a \
         joint outside of the chain.",
    ),
    entry(
        "R0405",
        "unknown gripper",
        "The arm names a gripper for which the specification has no `[[gripper]]` table.",
    ),
    entry(
        "R0406",
        "gripper not fixed to the arm",
        "The palm of an arm's gripper must be joined to the arm's tip by fixed joints only, and the \
         gripper's joints must not be part of the arm: otherwise a pose of the tool does not say where the \
         tip is. Choose the tip just above the palm.",
    ),
    entry(
        "R0407",
        "free joint outside of the chain",
        "The joints of `free` are those of the arm's own chain that are chosen instead of solved for.",
    ),
    entry(
        "R0408",
        "one value for each joint",
        "The list must have one value for each joint it speaks of: for `home` the moving joints from base \
         to tip, for `closing` and `values` the gripper's `joints`.",
    ),
    entry(
        "R0409",
        "value outside of joint limits",
        "The joint cannot take this value: it is outside of the limits that apply. Limits come from \
         `[limits]`, `joint_limits` and the description, in this order. Angles are radians.",
    ),
    entry(
        "R0410",
        "not part of the gripper",
        "Fingers and their joints must hang below the palm, directly or through other links; else they do \
         not move with it.",
    ),
    entry(
        "R0411",
        "link paired with itself",
        "A pair of links to ignore consists of two different links. A link is never tested against itself.",
    ),
    entry(
        "R0412",
        "limits assumed",
        "No file says how fast these joints may move, so cautious values are assumed. Plans are correct but \
         slower than the robot allows, or faster than it likes: write the limits of the maker's data sheet \
         into `[limits]`, or name MoveIt's `joint_limits.yaml`.",
    ),
    entry(
        "R0413",
        "limits out of order",
        "A lower limit must not be above the upper one, and a joint that turns without end needs both or none.",
    ),
    entry(
        "R0414",
        "footprint without area",
        "The corners of the footprint must go round the outline of the base, in metres, and enclose an area.",
    ),
    entry(
        "R0415",
        "robot without arm",
        "A robot needs at least one arm: an `[[arm]]` table, or an SRDF with a group that is a chain. \
         `robotc init` writes a specification with guessed arms.",
    ),
    entry(
        "R0416",
        "gripper that cannot close",
        "Every entry of `closing` is 0, so no joint would close the gripper. Write 1 for a joint that \
         closes by growing, -1 for one that closes by shrinking.",
    ),
    entry(
        "R0418",
        "direction without length",
        "A direction needs a length above zero; its length is otherwise without meaning.",
    ),
    entry(
        "R0419",
        "joints that do not drive",
        "The `joints` of a planar base stand for its driving: one slides along x of the root, one along y, and one turns about z, in \
         this order and without offsets. They let it move sideways, so the base must be holonomic.",
    ),
    entry("R0501", "unknown arm", "The task names an arm that its robot specification does not define."),
    entry(
        "R0502",
        "arm not chosen",
        "The robot has several arms, so the task must say with `arm` which one does it.",
    ),
    entry(
        "R0503",
        "arm without a gripper",
        "Goals move objects, and the arm of the task carries no gripper. Give the arm a `gripper` in the \
         robot specification, or choose another arm.",
    ),
    entry(
        "R0504",
        "unknown object",
        "A goal names something that is not an `[[object]]` of the task, or names one twice. Obstacles stay where they are.",
    ),
    entry(
        "R0505",
        "mesh cannot be used",
        "The mesh of an object or obstacle is not a readable STL, OBJ or COLLADA file, or holds no triangles.",
    ),
    entry(
        "R0506",
        "damaged mesh",
        "A considerable part of the mesh had to be dropped: triangles without area, or corners that do not \
         exist. Check it in the program that wrote it.",
    ),
    entry(
        "R0507",
        "unusual size",
        "The mesh is smaller than 2 mm or larger than 10 m. Most often its unit is not metres; write `units`.",
    ),
    entry(
        "R0508",
        "handle does not move",
        "The handle of an `[[article]]` has to move with the joint that opens it, or pulling at it opens nothing.",
    ),
    entry(
        "R0509",
        "open surface",
        "The triangles of the mesh do not close a surface, so it has no definite inside. Collision checks and grasps take the          convex parts that cover it instead, and so does its centre of mass. Close it in the program that wrote it if that matters.",
    ),
    entry(
        "R0510",
        "unknown article",
        "A goal opens something that is not an `[[article]]` of the task: only doors, drawers and levers have a joint to move.",
    ),
    entry(
        "R0511",
        "measurements cannot be used",
        "The file of a point cloud or of a height field is in no format that is read, is cut off, or what it holds is no cloud or no \
         height field: no points, places farther out than 10 km, fewer than two rows. Points are read from PLY, PCD, NPY and text \
         files, heights from grey PNG, NPY and text files.",
    ),
    entry(
        "R0512",
        "shades and heights",
        "The shades of an image are heights only once it is said how high black and white are, with `range`. Other files hold \
         heights themselves; they have `units` and no `range`.",
    ),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_unique_ascending_and_explained() {
        for pair in CODES.windows(2) {
            assert!(pair[0].code < pair[1].code, "{} before {}", pair[0].code, pair[1].code);
        }
        for info in CODES {
            assert!(info.text.len() > 40 && !info.title.is_empty(), "{}", info.code);
        }
    }
}
