//! How long force closure, epsilon and volume of random grasps take: `cargo run --release -p robotc-planning --example
//! closure_speed`.

use std::hint::black_box;
use std::time::Instant;

use nalgebra::{Point3, Unit};
use robotc_core::Seed;
use robotc_core::robot::Hold;
use robotc_planning::grasp::{Contact, ContactModel, closes, epsilon, volume, wrenches};

#[expect(clippy::print_stdout, reason = "a program")]
fn main() {
    const GRASPS: u64 = 40;
    let model = ContactModel {
        friction: 0.5,
        cone_edges: 8,
        centre: Point3::origin(),
        length: 1.0,
        hold: Hold::Close,
    };
    println!("| contacts | closing | wrenches, us | yes or no, us | epsilon, us | volume, us |");
    println!("|---|---|---|---|---|---|");
    for count in [3, 4, 6, 8, 12, 16] {
        let grasps: Vec<Vec<Contact>> = (0..GRASPS)
            .map(|trial| {
                let mut rng = Seed::new(count).at(trial).rng();
                let mut one = || {
                    let out = rng.direction().into_inner();
                    let tilt = rng.direction().into_inner() * 0.4;
                    Contact {
                        point_in_object: Point3::from(out),
                        normal_in_object: Unit::new_normalize(tilt - out),
                    }
                };
                (0..count).map(|_| one()).collect()
            })
            .collect();
        let sets: Vec<_> = grasps.iter().map(|g| wrenches(g, &model)).collect();
        let closing: Vec<_> = sets.iter().filter(|w| closes(w)).collect();
        let making = micros(&grasps, 50, |g| _ = black_box(wrenches(g, &model)));
        let asking = micros(&sets, 50, |w| _ = black_box(closes(w)));
        let measuring = micros(&closing, 5, |w| _ = black_box(epsilon(w)));
        let filling = micros(&closing, 1, |w| _ = black_box(volume(w)));
        let share = closing.len();
        println!(
            "| {count} | {share} of {GRASPS} | {making:.2} | {asking:.2} | {measuring:.0} | {filling:.0} |"
        );
    }
}

/// Microseconds for one item.
fn micros<T>(items: &[T], rounds: u32, mut work: impl FnMut(&T)) -> f64 {
    let start = Instant::now();
    for _ in 0..rounds {
        items.iter().for_each(&mut work);
    }
    start.elapsed().as_secs_f64() * 1e6 / (f64::from(rounds) * items.len() as f64)
}
