//! A board with its pegs, and the balls that fall through it.

use corpuscle_checkpoint::resume;
use corpuscle_core::{Axis, Boundary, Contact, Engine, Failure, Invalid, Meeting, Obstacle, Particles, Random, Vector};
use corpuscle_event::{EventDriven, Restitution, Rules};

use corpuscle_observe::Schedule;

use crate::Settings;
use crate::replicas::{Member, Watch};

/// Distance of rows, in distances of neighbouring pegs.
const PITCH: f64 = 0.7;
/// Columns beside the outermost bins of a board without leaps, on either side.
const MARGIN: usize = 2;
/// Largest radius of ball and peg together that leaves a gap.
const WIDEST: f64 = 0.48;
/// How far beside the middle and how fast sideways balls are let go at most: as from a funnel that shakes, lest the first
/// contacts be alike.
const AIM: f64 = 0.3;
const SHAKE: f64 = 0.6;
/// Slowest contact that loses energy: a ball that comes to rest on a peg slides off it by small hops.
const HOP: f64 = 0.03;
/// Time from the release of one ball to that of the next, in `sqrt(spacing/g)`.
const INTERVAL: f64 = 0.5;
/// Time allowed a row, of which a ball takes about three.
const PATIENCE: f64 = 16.0;

/// What all boards have in common. Lengths are in distances of neighbouring pegs, `g = 1`, and the mass of a ball is 1.
#[derive(Clone)]
pub(super) struct Set {
    seed: u64,
    pub(super) rows: usize,
    pub(super) balls: usize,
    pub(super) ball: f64,
    pub(super) peg: f64,
    pub(super) restitution: f64,
    boundary: Boundary<2>,
}

impl Set {
    pub(super) fn new(settings: &Settings) -> Result<Self, Invalid> {
        let (rows, ball, peg) = (settings.whole("rows"), settings.real("ball_radius"), settings.real("peg_radius"));
        if ball + peg > WIDEST {
            let expected = format!("at most {:.3}: a ball has to pass between two pegs", WIDEST - peg);
            return Err(settings.invalid("ball_radius", expected));
        }
        let width = (rows + 2 * MARGIN) as f64;
        let set = Self {
            seed: settings.seed,
            rows,
            balls: settings.whole("balls"),
            ball,
            peg,
            restitution: settings.real("restitution"),
            boundary: Boundary::new([0.0; 2], [width, (rows + 1) as f64 * PITCH], Axis::Walls),
        };
        let obstacle = |centre| Obstacle { centre, radius: ball + peg };
        let obstacles = (1..=rows).flat_map(|row| set.pegs(row)).map(obstacle).collect();
        Ok(Self { boundary: Boundary { obstacles, ..set.boundary.clone() }, ..set })
    }

    /// Places of the pegs of a row. In the engine a ball is a point, and a peg as large as both: balls do not meet each other.
    pub(super) fn pegs(&self, row: usize) -> impl Iterator<Item = Vector<2>> + '_ {
        let width = self.boundary.upper[0];
        let first = (0.5 * (width + 1.0 + row as f64)).rem_euclid(1.0);
        (0..=width as usize).map(move |k| first + k as f64).filter(move |&x| x <= width).map(move |x| Vector([x, self.level(row)]))
    }

    /// Height of a row of pegs, the first on top, above the floor, where balls are counted.
    pub(super) fn level(&self, row: usize) -> f64 {
        ((self.rows - row) as f64 + 0.5) * PITCH
    }

    /// The middle of the board, above which balls are let go.
    pub(super) fn middle(&self) -> f64 {
        0.5 * self.width()
    }

    /// Height from which balls fall.
    pub(super) fn top(&self) -> f64 {
        self.level(1) + PITCH
    }

    pub(super) fn width(&self) -> f64 {
        self.boundary.upper[0]
    }

    /// Where and how fast a ball is let go: about above the peg in the middle.
    fn release(&self, stream: u64, ball: usize) -> [Vector<2>; 2] {
        let mut random = Random::at(self.seed, stream, 0, ball as u64);
        let mut either = |most: f64| most * (2.0 * random.uniform() - 1.0);
        [Vector([self.middle() + either(AIM), self.top()]), Vector([either(SHAKE), 0.0])]
    }

    /// Time at which the last ball is down.
    pub(super) fn end(&self) -> f64 {
        self.balls as f64 * INTERVAL + (PATIENCE * self.rows as f64).ceil()
    }

    /// Distances of pegs by halves, from the middle to the gap passed at `x` in a row: even in even rows, odd in odd ones.
    fn gap(&self, row: usize, x: f64) -> i32 {
        let (halves, parity) = (2.0 * x - self.width(), (row % 2) as f64);
        (2.0 * (0.5 * (halves - parity)).round() + parity) as i32
    }
}

/// A ball under way.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
struct Fall {
    /// When and where it left the last peg, and how fast.
    time: f64,
    position: Vector<2>,
    velocity: Vector<2>,
    /// Kinetic energy at the start, and what contacts have taken.
    start: f64,
    lost: f64,
    /// Gap through which it passed each row, the last time; the 0th entry is the release.
    gaps: Vec<i32>,
    landed: bool,
}

impl Fall {
    fn new(time: f64, [position, velocity]: [Vector<2>; 2], rows: usize) -> Self {
        Self { time, position, velocity, start: 0.5 * velocity.norm_squared(), lost: 0.0, gaps: vec![0; rows + 1], landed: false }
    }

    /// Notes the gaps passed on the parabola since the last contact, down to the height of this one.
    fn pass(&mut self, set: &Set, height: f64) {
        let (r, v) = (self.position, self.velocity);
        let apex = r[1] + 0.5 * v[1].max(0.0) * v[1].max(0.0);
        for row in 1..=set.rows {
            let drop = r[1] - set.level(row);
            if height <= set.level(row) && set.level(row) < apex {
                // The later of the two crossings, downwards.
                let time = v[1] + (v[1] * v[1] + 2.0 * drop).max(0.0).sqrt();
                self.gaps[row] = set.gap(row, r[0] + v[0] * time);
            }
        }
    }
}

/// A ball that is down.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub(super) struct Landed {
    pub(super) time: f64,
    /// Gap through which it passed each row; the 0th entry is the release.
    gaps: Vec<i32>,
}

impl Landed {
    /// Gap passed in a row, in halves of the distance of pegs from the middle.
    pub(super) fn gap(&self, row: usize) -> i32 {
        self.gaps[row]
    }

    /// How far it was turned aside in a row: 1 to the right of a peg, -1 to the left, more in a leap over several.
    pub(super) fn deflection(&self, row: usize) -> i32 {
        self.gaps[row] - self.gaps[row - 1]
    }
}

/// Balls in flight and those that are down.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
struct Falls {
    flying: Vec<Fall>,
    landed: Vec<Landed>,
    /// Largest error of the energy of a ball, over what it started with.
    imbalance: f64,
}

impl Falls {
    fn meet(&mut self, set: &Set, contact: &Contact<2>) {
        let (party, fall) = (contact.first, &mut self.flying[contact.first.index]);
        if fall.landed {
            return;
        }
        fall.pass(set, party.position[1]);
        if contact.with == (Meeting::Face { axis: 1, upper: false }) {
            let left = set.top() + fall.start - fall.lost - 0.5 * party.before.norm_squared();
            self.imbalance = self.imbalance.max((left / set.top()).abs());
            self.landed.push(Landed { time: contact.time, gaps: fall.gaps.clone() });
            fall.landed = true;
        } else {
            fall.lost += 0.5 * (party.before.norm_squared() - party.after.norm_squared());
            (fall.time, fall.position, fall.velocity) = (contact.time, party.position, party.after);
        }
    }
}

/// A board under way.
pub(super) struct Board {
    pub(super) engine: EventDriven<2>,
    falls: Falls,
    released: usize,
    schedule: Schedule,
    stream: u64,
    set: Set,
}

resume!(Board { values: [engine, falls, released, schedule], set_up: [stream, set] });

impl Board {
    /// # Errors
    /// [`Invalid`] of the engine.
    pub(super) fn new(set: &Set, stream: u64) -> Result<Self, Invalid> {
        let rules = Rules {
            field: Vector([0.0, -1.0]),
            restitution: Restitution::Constant(set.restitution),
            elastic_below: HOP,
            ..Rules::default()
        };
        let mut falls = Falls::default();
        let [position, velocity] = set.release(stream, 0);
        falls.flying.push(Fall::new(0.0, [position, velocity], set.rows));
        let mut particles = Particles::new();
        particles.push(position, velocity, 1.0, 0.0, 0);
        let engine = EventDriven::new(set.boundary.clone(), particles, rules)?;
        Ok(Self { engine, falls, released: 1, schedule: Schedule::new(INTERVAL).after_start(), stream, set: set.clone() })
    }

    /// Takes away the balls that are down, and lets the next one go.
    fn release(&mut self) -> Result<(), Failure> {
        let now = self.engine.snapshot();
        let mut particles = Particles::new();
        for i in self.flying() {
            particles.push(now.position[i], now.velocity[i], 1.0, 0.0, 0);
        }
        self.falls.flying.retain(|fall| !fall.landed);
        let [position, velocity] = self.set.release(self.stream, self.released);
        particles.push(position, velocity, 1.0, 0.0, 0);
        self.falls.flying.push(Fall::new(self.engine.time(), [position, velocity], self.set.rows));
        self.released += 1;
        let time = self.engine.time();
        self.engine.set_particles(&particles).map_err(|invalid| Failure { time, particle: None, cause: invalid.to_string() })
    }

    fn fly(&mut self, to: f64) -> Result<(), Failure> {
        let Self { engine, falls, set, .. } = self;
        engine.advance(to, &mut Watch(&mut |contact| falls.meet(set, contact)))
    }

    /// Balls on their way, by their numbers in the engine.
    pub(super) fn flying(&self) -> impl Iterator<Item = usize> + '_ {
        self.falls.flying.iter().enumerate().filter(|(_, fall)| !fall.landed).map(|(ball, _)| ball)
    }

    pub(super) fn landed(&self) -> &[Landed] {
        &self.falls.landed
    }

    /// Balls that are not down, those yet to be let go included.
    pub(super) fn missing(&self) -> usize {
        self.set.balls - self.falls.landed.len()
    }

    /// Largest error of the energy of a ball, over what it started with.
    pub(super) fn imbalance(&self) -> f64 {
        self.falls.imbalance
    }
}

impl Member for Board {
    fn advance(&mut self, time: f64) -> Result<(), Failure> {
        while self.released < self.set.balls
            && let Some(due) = self.schedule.due(time)
        {
            self.fly(due)?;
            self.release()?;
        }
        self.fly(time)
    }

    /// Balls tell their own times.
    fn sample(&mut self) {}

    fn time(&self) -> f64 {
        self.engine.time()
    }
}
