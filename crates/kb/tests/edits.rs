//! What an edit rebuilds: a table of edits against the exact set of artefacts they rebuild.

mod support;

use std::sync::Arc;

use robotc_core::Pose;
use robotc_core::model::{DynamicLimits, Geometry, Shape};
use robotc_core::spec::ParameterValue;
use robotc_kb::{Graph, LockFile, Locked, Store, compile};
use support::Spec;

/// An edit of the specification, and the artefacts that it rebuilds, as `kind subject`.
struct Edit {
    name: &'static str,
    apply: fn(&mut Spec),
    rebuilt: &'static [&'static str],
    /// What `explain` says about the first of them.
    because: &'static str,
}

const EDITS: &[Edit] = &[
    Edit { name: "nothing", apply: |_| {}, rebuilt: &[], because: "" },
    Edit { name: "mass of a link", apply: |s| s.links[3].mass = 2.5, rebuilt: &[], because: "" },
    Edit {
        name: "colour of a link",
        apply: |s| s.links[3].collision.colour = Some([1.0, 0.0, 0.0, 1.0]),
        rebuilt: &[],
        because: "",
    },
    Edit {
        name: "visual shape of a link",
        apply: |s| s.links[3].visual = support::cuboid([0.5, 0.5, 0.5], [0.0; 3]),
        rebuilt: &[],
        because: "",
    },
    Edit {
        name: "speed of a joint",
        apply: |s| {
            joint(s, 2).dynamics = DynamicLimits { velocity: 3.0, given: [true; 3], ..DynamicLimits::DEFAULT }
        },
        rebuilt: &[],
        because: "",
    },
    Edit {
        name: "limit of a joint",
        apply: |s| joint(s, 2).limits.1 = 1.5,
        rebuilt: &[
            "arm_pairs arm/main",
            "link_statistics arm",
            "reachability arm/main",
            "self_collision_pairs arm",
        ],
        because: "changed: self_collision_pairs of arm",
    },
    Edit {
        name: "length of a link",
        apply: |s| joint(s, 3).origin.xyz[2] = 0.45,
        rebuilt: &[
            "arm_pairs arm/main",
            "chain_reach arm/main",
            "ik_solver arm/main",
            "link_statistics arm",
            "reachability arm/main",
            "self_collision_pairs arm",
        ],
        because: "changed: self_collision_pairs of arm",
    },
    Edit {
        name: "a finger's joint",
        apply: |s| joint(s, 7).origin.xyz[2] = 0.115,
        rebuilt: &[
            "arm_pairs arm/main",
            "camera_view arm/eye",
            "grasp_set arm/jaws+tidy/mug",
            "link_statistics arm",
            "self_collision_pairs arm",
        ],
        because: "changed: self_collision_pairs of arm",
    },
    Edit {
        name: "collision shape of a finger",
        apply: |s| s.links[7].collision = support::cuboid([0.02, 0.012, 0.05], [0.0, 0.006, 0.025]),
        rebuilt: &[
            "arm_pairs arm/main",
            "camera_view arm/eye",
            "convex_parts arm/left",
            "grasp_set arm/jaws+tidy/mug",
            "link_statistics arm",
            "self_collision_pairs arm",
            "sphere_cover arm/left",
        ],
        because: "changed: self_collision_pairs of arm",
    },
    Edit {
        name: "collision shape of a link",
        apply: |s| s.links[3].collision = support::cuboid([0.06, 0.06, 0.2], [0.0, 0.0, 0.1]),
        rebuilt: &[
            "arm_pairs arm/main",
            "convex_parts arm/fore",
            "link_statistics arm",
            "reachability arm/main",
            "self_collision_pairs arm",
            "sphere_cover arm/fore",
        ],
        because: "changed: self_collision_pairs of arm",
    },
    Edit {
        name: "collision shape that gives the same convex parts",
        apply: |s| {
            let collision = &mut s.links[3].collision;
            *collision = Geometry { shape: mesh_of_box([0.07, 0.07, 0.2]), ..collision.clone() };
        },
        rebuilt: &["convex_parts arm/fore"],
        because: "changed: shape of arm/fore",
    },
    Edit {
        name: "shape of the object",
        apply: |s| {
            s.object.geometry = Arc::new(vec![support::cuboid([0.05, 0.05, 0.1], [0.0; 3])]);
        },
        rebuilt: &["convex_parts tidy/mug", "grasp_set arm/jaws+tidy/mug", "sphere_cover tidy/mug"],
        because: "changed: shape of tidy/mug",
    },
    Edit {
        name: "friction of the object",
        apply: |s| s.object.friction = 0.8,
        rebuilt: &["grasp_set arm/jaws+tidy/mug"],
        because: "changed: friction of tidy/mug 0.5 -> 0.8",
    },
    Edit {
        name: "grasp parameter",
        apply: |s| s.given.set("grasp_set", "rolls", ParameterValue::Integer(4)),
        rebuilt: &["grasp_set arm/jaws+tidy/mug"],
        because: "changed: parameter rolls 8 -> 4",
    },
    #[cfg(feature = "shake")]
    Edit {
        name: "shaking asked for",
        apply: |s| s.given.set("grasp_shake", "grasps", ParameterValue::Integer(1)),
        rebuilt: &["grasp_shake arm/jaws+tidy/mug"],
        because: "never computed for this subject",
    },
    Edit {
        name: "place of the camera",
        apply: |s| s.eye.xyz[0] = 0.06,
        rebuilt: &["camera_view arm/eye"],
        because: "changed: camera",
    },
    Edit { name: "mass of the object", apply: |s| s.object.mass = 1.0, rebuilt: &[], because: "" },
    Edit {
        name: "place of the object",
        apply: |s| s.object.world_from_object = Pose::translation(0.3, 0.1, 0.3),
        rebuilt: &[],
        because: "",
    },
    Edit {
        name: "place of the table",
        apply: |s| s.obstacle.world_from_obstacle = Pose::translation(0.7, 0.0, 0.2),
        rebuilt: &[],
        because: "",
    },
    Edit { name: "name of a link", apply: |s| s.links[2].name = "humerus".into(), rebuilt: &[], because: "" },
    Edit { name: "name of the robot", apply: |s| s.robot_name = "other".into(), rebuilt: &[], because: "" },
    Edit {
        name: "parameter",
        apply: |s| s.given.set("convex_parts", "max_vertices", ParameterValue::Integer(16)),
        rebuilt: &[
            "convex_parts arm/base",
            "convex_parts arm/fore",
            "convex_parts arm/hand",
            "convex_parts arm/left",
            "convex_parts arm/right",
            "convex_parts arm/shoulder",
            "convex_parts arm/upper",
            "convex_parts arm/wrist_bend",
            "convex_parts arm/wrist_roll",
            "convex_parts tidy/mug",
            "convex_parts tidy/table",
        ],
        because: "changed: parameter max_vertices 32 -> 16",
    },
    Edit {
        name: "parameter set to its default",
        apply: |s| s.given.set("convex_parts", "max_vertices", ParameterValue::Integer(32)),
        rebuilt: &[],
        because: "",
    },
];

fn joint(spec: &mut Spec, link: usize) -> &mut support::JointSpec {
    spec.links[link].joint.as_mut().expect("the link moves")
}

/// The box as a mesh, whose convex parts are those of the primitive.
fn mesh_of_box(size: [f64; 3]) -> Shape {
    let part = robotc_core::geom::box_part(size.into());
    Shape::Mesh { mesh: Arc::new(part.mesh()), uri: "file:///somewhere/box.stl".into() }
}

#[test]
fn edits_rebuild_exactly_what_reads_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let base = folder.path().join("base");
    let graph = Arc::new(Graph::plan(&support::spec().project()).expect("a graph"));
    let store = Arc::new(Store::open(&base).expect("a store"));
    assert!(compile(&graph, &store, &()).expect("it works").complete());
    drop(store);
    let mut wrong = Vec::new();
    for edit in EDITS {
        let own = folder.path().join(edit.name.replace(' ', "_"));
        copy(&base, &own);
        let mut spec = support::spec();
        (edit.apply)(&mut spec);
        let graph = Arc::new(Graph::plan(&spec.project()).expect("a graph"));
        let store = Arc::new(Store::open(&own).expect("a store"));
        let report = compile(&graph, &store, &()).expect("it works");
        assert!(report.complete(), "{}", edit.name);
        let mut rebuilt: Vec<(String, String)> = report
            .built()
            .map(|(node, reason)| {
                let node = graph.node(node);
                (format!("{} {}", node.kind_name(), node.subjects[0]), reason.to_string())
            })
            .collect();
        rebuilt.sort();
        let titles: Vec<&str> = rebuilt.iter().map(|(title, _)| title.as_str()).collect();
        let because = rebuilt.first().map_or("", |(_, reason)| reason);
        if titles != edit.rebuilt || because != edit.because {
            wrong.push(format!("{}: {titles:#?} because {because}", edit.name));
        }
        // And back: everything is still there.
        let graph = Arc::new(Graph::plan(&support::spec().project()).expect("a graph"));
        assert_eq!(compile(&graph, &store, &()).expect("it works").built().count(), 0, "{}", edit.name);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

fn copy(from: &std::path::Path, to: &std::path::Path) {
    std::fs::create_dir_all(to).expect("a folder");
    for entry in std::fs::read_dir(from).expect("a folder") {
        let entry = entry.expect("an entry");
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &target);
        } else {
            std::fs::copy(entry.path(), target).expect("a copy");
        }
    }
}

#[test]
fn artefacts_repeat_with_any_number_of_threads_in_any_folder() {
    let lock = |threads: usize| {
        let folder = tempfile::tempdir().expect("a folder");
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        let graph = Arc::new(Graph::plan(&support::spec_with_door().project()).expect("a graph"));
        let store = Arc::new(Store::open(folder.path()).expect("a store"));
        let report = pool.install(|| compile(&graph, &store, &()).expect("it works"));
        assert!(report.complete());
        let mut lock = LockFile::default();
        lock.set("tidy.task.toml", Locked::of(&report.knowledge));
        lock.to_text()
    };
    let one = lock(1);
    assert_eq!(one, lock(2));
    assert_eq!(one, lock(3));
    support::golden("artefacts.lock", &one);
}

#[test]
fn recipes_are_known_before_anything_is_built_and_reach_through_inputs() {
    let plan = |edit: fn(&mut Spec)| {
        let mut spec = support::spec();
        edit(&mut spec);
        Graph::plan(&spec.project()).expect("a graph")
    };
    let before = plan(|_| {});
    let after = plan(|s| s.links[3].collision = support::cuboid([0.01; 3], [0.0; 3]));
    let changed: Vec<String> = before
        .nodes()
        .iter()
        .zip(after.nodes())
        .filter(|(a, b)| a.recipe != b.recipe)
        .map(|(a, _)| a.title())
        .collect();
    let expected = [
        "convex_parts of arm/fore",
        "sphere_cover of arm/fore",
        "link_statistics of arm",
        "self_collision_pairs of arm",
        "arm_pairs of arm/main",
        "reachability of arm/main",
    ];
    assert_eq!(changed, expected);
    let dot = before.to_dot();
    assert_eq!(dot.matches("label=").count(), before.nodes().len());
    assert!(dot.contains(" -> "));
}
