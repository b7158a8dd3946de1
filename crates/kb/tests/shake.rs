//! Shaken grasps: the simulation gives the same with any number of threads, and ranks.
#![cfg(feature = "shake")]

mod support;

use std::sync::Arc;

use robotc_core::spec::ParameterValue;
use robotc_kb::kind::{AnyKind, Entry};
use robotc_kb::kinds::{GraspSet, GraspShake, ranked_grasps};
use robotc_kb::project::OfGripperAndObject;
use robotc_kb::{Graph, Store, compile};

#[test]
fn shaken_grasps_repeat_with_any_number_of_threads() {
    let mut spec = support::spec();
    spec.given.set("grasp_shake", "grasps", ParameterValue::Integer(4));
    spec.given.set("grasp_shake", "tries", ParameterValue::Integer(1));
    let shaken = |threads: usize| {
        let folder = tempfile::tempdir().expect("a folder");
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        static SHAKEN: Entry<GraspShake> = Entry::new();
        let kinds = [&SHAKEN as &'static dyn AnyKind];
        let graph = Arc::new(Graph::plan_kinds(&spec.project(), &kinds).expect("a graph"));
        let store = Arc::new(Store::open(folder.path()).expect("a store"));
        let report = pool.install(|| compile(&graph, &store, &()).expect("it works"));
        let subject = OfGripperAndObject { gripper: 0, object: 0 };
        let shaken = report.knowledge.load::<GraspShake>(&subject).expect("it is computed");
        let ranked = ranked_grasps(&report.knowledge, &subject).expect("they are computed");
        assert!(ranked.windows(2).all(|pair| pair[0].score >= pair[1].score));
        let known = report.knowledge.load::<GraspSet>(&subject).expect("it is computed");
        assert_eq!(ranked.len(), known.len());
        (*shaken).clone()
    };
    let one = shaken(1);
    assert_eq!(one, shaken(2));
    // Two frictions, seven pulls.
    assert_eq!((one.pulls, one.withstood.len()), (14, 4));
    assert!(one.withstood.iter().any(|&count| count > 7), "{one:?}");
}
