//! Grains that fall through a sky of moving stars, eight at a time.
//!
//! Nyström's method of fourth order for `r'' = f(t, r)` (Hairer, Nørsett and Wanner 1993, II.14), with steps that are a
//! binary part of the sky's stretch, no longer than a share of the time in which a grain passes the nearest star. Eight
//! neighbours on the map share their steps; so a grain's bits depend on the map, and not on who computes what.

#![allow(clippy::inline_always, reason = "what a kernel calls must end up in it, or it is not compiled for the instruction set")]
#![allow(clippy::needless_range_loop, reason = "a lane indexes several arrays at once")]

use corpuscle_core::Vector;
use corpuscle_core::instructions::{Kernel, larger};

use super::sky::Sky;

/// Grains in a flock.
pub(super) const LANES: usize = 8;
/// Parts of a stretch: the shortest step is one of them.
const TICKS: u32 = 1 << 12;
/// A step lasts at most this share of `d/v` and of `sqrt(d^3/(G m))`.
const SHARE: f64 = 0.05;

/// What became of a grain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(super) enum Fate {
    /// It came within the capture radius of this star.
    Hit(u8),
    /// It left, faster than it could ever be called back.
    Escaped,
    /// Nothing yet.
    Open,
}

impl Fate {
    pub(super) const ALL: [Self; 5] = [Self::Hit(0), Self::Hit(1), Self::Hit(2), Self::Escaped, Self::Open];

    /// Place in [`ALL`](Self::ALL).
    pub(super) fn index(self) -> usize {
        match self {
            Self::Hit(star) => usize::from(star),
            Self::Escaped => 3,
            Self::Open => 4,
        }
    }
}

/// When a fate is sealed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rules {
    /// Closer than this to a star, a grain has hit it.
    pub(super) capture: f64,
    /// Farther than this from the stars' centre of mass, and receding faster than a parabola, it has escaped.
    pub(super) far: f64,
}

impl Rules {
    /// The fate of a grain among stars of these strengths `G m`.
    #[inline(always)]
    pub(super) fn judge(&self, r: Vector<2>, v: Vector<2>, stars: &[[f64; 2]; 3], sky: (&[f64; 3], f64)) -> Fate {
        for star in 0..3 {
            if (Vector(stars[star]) - r).norm_squared() < self.capture * self.capture {
                return Fate::Hit(star as u8);
            }
        }
        let r2 = r.norm_squared();
        if r2 <= self.far * self.far || r.dot(v) <= 0.0 {
            return Fate::Open;
        }
        let (strength, softening_squared) = sky;
        let depth = (strength[0] + strength[1] + strength[2]) / (r2 + softening_squared).sqrt();
        if 0.5 * v.norm_squared() > depth { Fate::Escaped } else { Fate::Open }
    }
}

/// Eight grains: components first, so that a vector instruction handles all of them.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub(super) struct Flock {
    r: [[f64; LANES]; 2],
    v: [[f64; LANES]; 2],
    pub(super) fate: [Fate; LANES],
    /// When it was sealed.
    pub(super) time: [f64; LANES],
    pub(super) steps: u64,
}

impl Flock {
    /// Grains released at `t = 0` at these places, all with one velocity; of fewer than eight the first one stands for the others.
    pub(super) fn released(
        places: &[[f64; 2]],
        velocity: [f64; 2],
        rules: &Rules,
        stars: &[[f64; 2]; 3],
        strength: &[f64; 3],
    ) -> Self {
        let place = |lane: usize| places.get(lane).copied().unwrap_or(places[0]);
        let r = std::array::from_fn(|axis| std::array::from_fn(|lane| place(lane)[axis]));
        let v = velocity.map(|component| [component; LANES]);
        let fate = std::array::from_fn(|lane| rules.judge(Vector(place(lane)), Vector(velocity), stars, (strength, 0.0)));
        Self { r, v, fate, time: [0.0; LANES], steps: 0 }
    }

    /// Whether any grain is still on its way.
    #[inline(always)]
    pub(super) fn is_open(&self) -> bool {
        self.fate.contains(&Fate::Open)
    }
}

/// A flock's way through one stretch.
pub(super) struct Ride<'a> {
    pub(super) flock: &'a mut Flock,
    pub(super) sky: &'a Sky,
    pub(super) rules: &'a Rules,
}

impl Kernel for Ride<'_> {
    type Output = ();

    #[inline(always)]
    fn run(mut self) {
        let mut tick = 0;
        while tick < TICKS && self.flock.is_open() {
            let ticks = self.step_size(tick);
            self.step(tick, ticks);
            tick += ticks;
        }
    }
}

impl Ride<'_> {
    /// The longest step allowed from here: a binary part of the stretch that begins at a multiple of itself.
    #[inline(always)]
    fn step_size(&self, tick: u32) -> u32 {
        let share = f64::from(tick) / f64::from(TICKS);
        let (stars, speeds) = (self.sky.positions(share), self.sky.velocities(share));
        let Flock { r, v, fate, .. } = &*self.flock;
        let mut rates = [0.0f64; LANES];
        for star in 0..3 {
            for lane in 0..LANES {
                let (x, y) = (stars[star][0] - r[0][lane], stars[star][1] - r[1][lane]);
                let (u, w) = (speeds[star][0] - v[0][lane], speeds[star][1] - v[1][lane]);
                let d2 = x * x + y * y + self.sky.softening_squared;
                rates[lane] = larger((u * u + w * w + self.sky.strength[star] / d2.sqrt()) / d2, rates[lane]);
            }
        }
        let mut fastest = 0.0f64;
        for lane in 0..LANES {
            if fate[lane] == Fate::Open && rates[lane] > fastest {
                fastest = rates[lane];
            }
        }
        let mut ticks = TICKS;
        while ticks > 1 {
            let h = self.sky.length * f64::from(ticks) / f64::from(TICKS);
            if tick.is_multiple_of(ticks) && h * h * fastest <= SHARE * SHARE {
                break;
            }
            ticks /= 2;
        }
        ticks
    }

    #[inline(always)]
    fn step(&mut self, tick: u32, ticks: u32) {
        let share = |part: f64| (f64::from(tick) + part * f64::from(ticks)) / f64::from(TICKS);
        let h = self.sky.length * f64::from(ticks) / f64::from(TICKS);
        let end = self.sky.positions(share(1.0));
        let Flock { r, v, .. } = self.flock.clone();
        let a = self.pull(&r, &self.sky.positions(share(0.0)));
        let b = self.pull(&moved(&r, &v, 0.5 * h, &a, 0.125 * h * h), &self.sky.positions(share(0.5)));
        let c = self.pull(&moved(&r, &v, h, &b, 0.5 * h * h), &end);
        let (mut place, mut speed) = (r, v);
        for axis in 0..2 {
            for lane in 0..LANES {
                let (a, b, c) = (a[axis][lane], b[axis][lane], c[axis][lane]);
                place[axis][lane] += h * v[axis][lane] + h * h / 6.0 * (a + 2.0 * b);
                speed[axis][lane] += h / 6.0 * (a + 4.0 * b + c);
            }
        }
        let now = self.sky.from + self.sky.length * share(1.0);
        self.flock.steps += 1;
        for lane in 0..LANES {
            // Whose fate is sealed stays where that happened.
            if self.flock.fate[lane] == Fate::Open {
                for axis in 0..2 {
                    (self.flock.r[axis][lane], self.flock.v[axis][lane]) = (place[axis][lane], speed[axis][lane]);
                }
                let (r, v) = (Vector([place[0][lane], place[1][lane]]), Vector([speed[0][lane], speed[1][lane]]));
                self.flock.fate[lane] = self.rules.judge(r, v, &end, (&self.sky.strength, self.sky.softening_squared));
                self.flock.time[lane] = now;
            }
        }
    }

    /// Accelerations `sum_k G m_k (r_k - r)/(|r_k - r|^2 + s^2)^(3/2)`.
    #[inline(always)]
    fn pull(&self, r: &[[f64; LANES]; 2], stars: &[[f64; 2]; 3]) -> [[f64; LANES]; 2] {
        let mut acceleration = [[0.0; LANES]; 2];
        for star in 0..3 {
            for lane in 0..LANES {
                let (x, y) = (stars[star][0] - r[0][lane], stars[star][1] - r[1][lane]);
                let d2 = x * x + y * y + self.sky.softening_squared;
                let weight = self.sky.strength[star] / (d2 * d2.sqrt());
                acceleration[0][lane] += weight * x;
                acceleration[1][lane] += weight * y;
            }
        }
        acceleration
    }
}

/// `r + h v + w a`.
#[inline(always)]
fn moved(r: &[[f64; LANES]; 2], v: &[[f64; LANES]; 2], h: f64, a: &[[f64; LANES]; 2], w: f64) -> [[f64; LANES]; 2] {
    let mut moved = *r;
    for axis in 0..2 {
        for lane in 0..LANES {
            moved[axis][lane] += h * v[axis][lane] + w * a[axis][lane];
        }
    }
    moved
}
