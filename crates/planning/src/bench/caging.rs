//! From where an arm can open a door: with a firm grasp, and with grasps that change within a cage (thesis tables 3.1 and 3.2).

use robotc_core::ids::Idx;
use robotc_core::rng::Rng;
use robotc_core::task::Article;
use robotc_core::{BodyIdx, DofIdx, Pose, Seed};
use serde::Serialize;

use crate::budget::{Budget, Interrupt};
use crate::caging::{Cage, CageGrasp, CagedObject, FixedGrasp, discrete_search, restarted_search};
use crate::manipulation::{
    Manipulation, ManipulationOptions, article_steps, finger_space, gripper_links, with_fingers_space,
};
use crate::mechanism::Mechanism;
use crate::scene::{MovingArticle, RobotChecker, Rules, Scene};

/// Where the article is put, and how hard it is tried to open it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CagingBenchOptions {
    /// Places along each side of the square around the robot, at the height that the article has in the task.
    pub places: usize,
    /// Headings at each place: facing the robot, then turned away from that to either side.
    pub headings: usize,
    /// Between two headings, radians.
    pub turn: f64,
    /// Most loose grips that are used, drawn at random.
    pub grips: usize,
    /// Seconds for each search.
    pub seconds: f64,
    /// Names the random streams.
    pub seed: u64,
}

impl Default for CagingBenchOptions {
    fn default() -> Self {
        Self { places: 7, headings: 1, turn: 0.5, grips: 80, seconds: 5.0, seed: 1 }
    }
}

/// One search.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Attempt {
    /// Whether the article came to its goal.
    pub opened: bool,
    /// Whether the time was over before that was decided.
    pub stopped: bool,
    /// How long it took.
    pub seconds: f64,
}

/// What became of one place.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CagingPlace {
    /// The root of the article in the frame of the robot's root, metres.
    pub x: f64,
    /// See `x`.
    pub y: f64,
    /// Its heading, radians.
    pub yaw: f64,
    /// Every grip in contact tried, none changed; the time is that until the first one does.
    pub firm: Attempt,
    /// The grips that do, as positions in the set that is used.
    pub firm_grips: Vec<usize>,
    /// The exhaustive search; for arms without free joints.
    pub discrete: Option<Attempt>,
    /// The search in stages: one grip kept, all of them, then at random.
    pub randomized: Attempt,
}

/// The figures of an arm and an article.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CagingReport {
    /// The article.
    pub article: String,
    /// Joints of the arm.
    pub joints: usize,
    /// Loose grips used.
    pub grips: usize,
    /// Where the joint of the article goes to from where it is, radians or metres.
    pub opening: [f64; 2],
    /// Places where the article stands clear of the robot.
    pub places: Vec<CagingPlace>,
    /// How many of them one and the same firm grip opens, the best one there is.
    pub opened_by_one: usize,
    /// How many can be opened in some firm grip, by the exhaustive search, and by the one in stages.
    pub opened: [usize; 3],
    /// Of the places that can be opened at all, the share that the search in stages opened within two seconds.
    pub within_two_seconds: f64,
    /// Median and 95th percentile of the seconds of its successes.
    pub seconds: [f64; 2],
}

/// Puts the article of a goal all around the robot, nothing else in the way, and tries to move it to `to`.
///
/// `now` gives seconds; `done` is told the number of places done and of all.
pub fn measure_caging(
    problem: &Manipulation<'_>,
    planner: &ManipulationOptions,
    (number, to): (usize, f64),
    options: &CagingBenchOptions,
    now: &dyn Fn() -> f64,
    done: &mut dyn FnMut(usize, usize),
) -> Option<CagingReport> {
    let task = problem.task;
    let article = &task.articles[number];
    let from = article.value();
    let mut rng = Seed::new(options.seed).rng();
    let mut cages: Vec<Cage> =
        problem.cages[number].iter().filter(|cage| cage.hold.moves(to > from)).cloned().collect();
    thin_out(&mut cages, options.grips, &mut rng);
    let mut report = CagingReport {
        article: article.name.clone(),
        joints: problem.arm.dofs().len(),
        grips: cages.len(),
        opening: [from, to],
        places: vec![],
        opened_by_one: 0,
        opened: [0; 3],
        within_two_seconds: 0.0,
        seconds: [0.0; 2],
    };
    let wanted = grid(problem, article, options);
    for (k, &(x, y, yaw)) in wanted.iter().enumerate() {
        if let Some(place) = try_place(problem, planner, number, to, &cages, (x, y, yaw), options, now) {
            report.places.push(place);
        }
        done(k + 1, wanted.len());
    }
    report.summarise();
    (!report.places.is_empty()).then_some(report)
}

impl CagingReport {
    fn summarise(&mut self) {
        let count = |opened: &dyn Fn(&CagingPlace) -> bool| self.places.iter().filter(|p| opened(p)).count();
        let discrete = |p: &CagingPlace| p.discrete.is_some_and(|a| a.opened);
        self.opened = [count(&|p| p.firm.opened), count(&discrete), count(&|p| p.randomized.opened)];
        let grips = self.places.iter().flat_map(|p| p.firm_grips.iter().copied());
        let mut of_grip = vec![0; self.grips];
        grips.for_each(|grip| of_grip[grip] += 1);
        self.opened_by_one = of_grip.into_iter().max().unwrap_or(0);
        let can = count(&|p| p.firm.opened || discrete(p) || p.randomized.opened);
        let soon = count(&|p| p.randomized.opened && p.randomized.seconds <= 2.0);
        self.within_two_seconds = soon as f64 / can.max(1) as f64;
        let opened = self.places.iter().filter(|p| p.randomized.opened);
        let mut seconds: Vec<f64> = opened.map(|p| p.randomized.seconds).collect();
        seconds.sort_by(f64::total_cmp);
        let at =
            |share: f64| seconds.get(((seconds.len() as f64 * share) as usize).min(seconds.len().max(1) - 1));
        self.seconds = [0.5, 0.95].map(|share| at(share).copied().unwrap_or(0.0));
    }
}

/// Keeps some, of each kind of hold and contact in proportion.
fn thin_out(cages: &mut Vec<Cage>, most: usize, rng: &mut Rng) {
    rng.shuffle(cages);
    cages.truncate(most);
    cages.sort_by_key(|cage| (cage.hold, !cage.grasp.contact));
}

/// Places in the frame of the robot's root.
fn grid(problem: &Manipulation<'_>, article: &Article, options: &CagingBenchOptions) -> Vec<(f64, f64, f64)> {
    let reach = problem.arm.reach();
    let root_from_article = problem.task.world_from_robot.inv_mul(&article.world_from_root);
    // What faces the robot from where it stands in the task is what faces it elsewhere.
    let ahead = root_from_article.rotation * nalgebra::Vector3::x();
    let at = root_from_article.translation.vector;
    let own = libm::atan2(ahead.y, ahead.x) - libm::atan2(-at.y, -at.x);
    let toward = (2.0 * own / std::f64::consts::PI).round() * 0.5 * std::f64::consts::PI;
    let side = |k: usize| reach * (2.0 * (k as f64 + 0.5) / options.places as f64 - 1.0);
    let mut all = Vec::new();
    for i in 0..options.places {
        for j in 0..options.places {
            for k in 0..options.headings {
                let (x, y) = (side(i), side(j));
                let away = (k as f64 - 0.5 * (options.headings as f64 - 1.0)) * options.turn;
                all.push((x, y, libm::atan2(-y, -x) + toward + away));
            }
        }
    }
    all
}

/// `None` when the article does not stand clear of the robot.
fn try_place(
    problem: &Manipulation<'_>,
    planner: &ManipulationOptions,
    number: usize,
    to: f64,
    cages: &[Cage],
    (x, y, yaw): (f64, f64, f64),
    options: &CagingBenchOptions,
    now: &dyn Fn() -> f64,
) -> Option<CagingPlace> {
    let task = problem.task;
    let from = task.articles[number].value();
    let (article, scene) = moved(problem, number, (x, y, yaw));
    let mechanism = Mechanism::of_article(&article)?;
    let gripper = task.robot.arms[task.arm].gripper?;
    let fingers = finger_space(&task.robot, gripper);
    let joints = with_fingers_space(problem.arm.space(), &fingers);
    let dofs: Vec<DofIdx> = [problem.arm.dofs(), &task.robot.grippers[gripper].dofs].concat();
    let handle = article.bodies.iter().find(|(link, _)| *link == article.handle)?.1;
    let rules = Rules {
        margin: planner.fine_margin(),
        target: Some(BodyIdx::new(task.objects.len() + handle)),
        give: Some(planner.give),
        gripper: gripper_links(&task.robot, gripper),
        ..Rules::default()
    };
    let grasps: Vec<CageGrasp> = cages.iter().map(|cage| cage.grasp.clone()).collect();
    let mut moving = MovingArticle::new(&scene, &article, task.objects.len());
    // Where the arm is at first does not matter, but its base must not be in the article.
    moving.stands_clear(&scene, &task.start, &dofs, from).then_some(())?;
    let space = moving.space(&joints);
    let checker = RobotChecker::with_article(
        &scene,
        &space,
        (&dofs, moving),
        &task.start,
        rules,
        planner.fine_resolution,
    );
    let steps = article_steps(&mechanism, from, to, planner.caging.shift, &grasps);
    let rest = task.start.select(problem.arm.dofs());
    let caged = CagedObject::new(problem.arm, &grasps, steps, checker, &rest, planner.caging).ok()?;
    let mut caged = caged.with_fingers(cages.iter().map(|cage| cage.loose.clone()).collect());
    let timed = |search: &mut dyn FnMut(&Budget<'_>) -> bool| {
        let start = now();
        let interrupt = || (now() - start > options.seconds).then_some(Interrupt::TimeUp);
        let opened = search(&Budget::new(&interrupt));
        let seconds = now() - start;
        Attempt { opened, stopped: !opened && seconds > options.seconds, seconds }
    };
    let seed = Seed::new(options.seed);
    let randomized =
        timed(&mut |budget| restarted_search(&mut caged, &planner.caging_search, budget, seed).is_ok());
    let redundant = !problem.arm.free_variables().is_empty();
    let (start, mut first, mut firm_grips) = (now(), None, Vec::new());
    let firm = timed(&mut |budget| {
        for grip in (0..cages.len()).filter(|&grip| cages[grip].grasp.contact) {
            let firm = &mut FixedGrasp::one(&mut caged, grip);
            // Of a redundant arm the steps of its free joints may be too coarse.
            let opened = discrete_search(firm, budget).is_ok()
                || (redundant && restarted_search(firm, &planner.caging_search, budget, seed).is_ok());
            if opened {
                first.get_or_insert(now() - start);
                firm_grips.push(grip);
            }
        }
        first.is_some()
    });
    let firm = Attempt { seconds: first.unwrap_or(firm.seconds), ..firm };
    let discrete = (!redundant).then(|| timed(&mut |budget| discrete_search(&mut caged, budget).is_ok()));
    Some(CagingPlace { x, y, yaw, firm, firm_grips, discrete, randomized })
}

/// The article elsewhere, and everything but it and the robot far away.
fn moved(problem: &Manipulation<'_>, number: usize, (x, y, yaw): (f64, f64, f64)) -> (Article, Scene) {
    let task = problem.task;
    let old = &task.articles[number];
    let height = task.world_from_robot.inv_mul(&old.world_from_root).translation.z;
    let turn = nalgebra::UnitQuaternion::from_axis_angle(&nalgebra::Vector3::z_axis(), yaw);
    let world_from_root =
        task.world_from_robot * Pose::from_parts(nalgebra::Translation3::new(x, y, height), turn);
    let new_from_old = world_from_root * old.world_from_root.inverse();
    let mut scene = problem.scene.clone();
    for body in 0..task.objects.len() + task.obstacles.len() {
        let index = BodyIdx::new(body);
        let own = body.checked_sub(task.objects.len());
        let belongs = own.is_some_and(|obstacle| old.bodies.iter().any(|&(_, b)| b == obstacle));
        let place = *scene.world_from_body(index);
        scene.place(index, if belongs { new_from_old * place } else { Pose::translation(0.0, 0.0, -1e3) });
    }
    (Article { world_from_root, ..old.clone() }, scene)
}
