//! Decoders of all kinds under hostile bytes: any bytes give an artefact or an error.

mod support;

use std::sync::Arc;

use robotc_core::Seed;
use robotc_kb::kinds::{GraspSet, GraspShake, Reachability, Shaken};
use robotc_kb::{Graph, Kind, Store, codec, compile, kinds};

#[test]
fn decoders_are_total_and_canonical() {
    let folder = tempfile::tempdir().expect("a folder");
    let graph = Arc::new(Graph::plan(&support::spec_with_door().project()).expect("a graph"));
    let store = Arc::new(Store::open(folder.path()).expect("a store"));
    assert!(compile(&graph, &store, &()).expect("it works").complete());
    let listed = store.list().expect("a list");
    for kind in kinds::ALL {
        let info = kind.info();
        let mut contents: Vec<Vec<u8>> = listed
            .iter()
            .filter(|artefact| artefact.kind == info.name)
            .map(|artefact| store.read(&artefact.content).expect("it is whole"))
            .collect();
        if info.name == GraspShake::NAME {
            // Computed on request, and not in every build.
            contents.push(GraspShake::encode(&Shaken { pulls: 14, withstood: vec![3, 14, 0] }));
        }
        assert!(!contents.is_empty(), "the test project has no {}", info.name);
        let mut rng = Seed::new(1).split(info.name).rng();
        for bytes in &contents {
            assert!(kind.recode(bytes).as_ref() == Ok(bytes), "{} is not canonical", info.name);
            kind.summary(bytes).expect("it decodes");
            for _ in 0..400 {
                let bad = mutated(bytes, &mut rng);
                if let Ok(again) = kind.recode(&bad) {
                    // What is accepted has one stored form from then on.
                    assert!(kind.recode(&again).as_ref() == Ok(&again), "{}", info.name);
                }
            }
        }
    }
}

/// Stored forms that are right but for one number.
#[test]
fn numbers_that_are_none_are_refused() {
    let grasp = |w: f64| {
        let (approach, contacts) = ([0.0, 0.0, 1.0], Vec::<[f64; 6]>::new());
        let more = (None::<f64>, Some([0.01, 1.0]));
        let grasp = (0_u32, [0.0; 3], [0.0, 0.0, 0.0, w], approach, 0.1, vec![0.0], contacts, 0.5, more, 0.5);
        GraspSet::decode(&codec::encode(&vec![grasp])).is_ok()
    };
    assert!(grasp(1.0) && !grasp(f64::NAN) && !grasp(0.5));
    let witnessed = |step: f64, w: f64, part: u32, witnesses: usize| {
        // 144 cells: one that is reached in part, and the others not.
        let (grid, kinds) = (
            ([0.0; 3], [0.0, 0.0, 0.0, w], step, 1_u32, 0_u32, true),
            vec![(0_u32, 0_u32, 0_u8), (1, part, 3)],
        );
        let runs = vec![1_u32, 1, 0, 143];
        Reachability::decode(&codec::encode(&(grid, 8_u8, kinds, runs, vec![7_u8; witnesses]))).is_ok()
    };
    let map = |step: f64, w: f64, part: u32| witnessed(step, w, part, 0);
    assert!(map(0.1, 1.0, 3));
    assert!(!map(f64::NAN, 1.0, 3) && !map(0.0, 1.0, 3) && !map(0.1, f64::INFINITY, 3) && !map(0.1, 0.5, 3));
    assert!(!map(0.1, 1.0, 2), "what is reached as a whole is reached in part");
    assert!(witnessed(0.1, 1.0, 3, 1) && !witnessed(0.1, 1.0, 3, 2), "one witness for each cell in part");
}

/// The bytes with a few of them changed, inserted, removed or cut off.
fn mutated(bytes: &[u8], rng: &mut robotc_core::rng::Rng) -> Vec<u8> {
    let mut bad = bytes.to_vec();
    for _ in 0..=rng.below(4) {
        let at = rng.below(bad.len() + 1);
        let byte = [0, 1, 0x7f, 0x80, 0xff, rng.bits() as u8][rng.below(6)];
        match rng.below(4) {
            0 if at < bad.len() => bad[at] = byte,
            1 => bad.insert(at, byte),
            2 if at < bad.len() => drop(bad.remove(at)),
            _ => bad.truncate(at),
        }
    }
    bad
}
