//! Galton's board: balls fall through rows of pegs, and each peg turns them left or right.
//!
//! Were deflections fair and independent, as Galton had it (Natural Inheritance, 1889, p. 63), the bin behind `n` rows would have the
//! binomial probability `C(n, k)/2^n`, of variance `n/4`. Fair they are, by the mirror symmetry of the board. Independent they are not:
//! smooth pegs and a ball that keeps a part of its speed make a dynamical system, in which a deflection remembers the one before. With
//! correlations `rho_l` of deflections `l` rows apart the variance is `(n/4)(1 + 2 sum (1 - l/n) rho_l)` (Taylor 1921,
//! doi:10.1112/plms/s2-20.1.196), and for a memory of one deflection the bins are those of a persistent walk (Goldstein 1951,
//! doi:10.1093/qjmam/4.2.129), drawn beside the binomial. What is judged is what follows from the laws: that the board is fair, that
//! deflections far apart are independent, and that each ball's energy is accounted for. A ball that loses nothing climbs again and again (Chernov and Dolgopyat 2009,
//! doi:10.1090/S0894-0347-08-00626-7), so that every board loses some.

mod board;
mod picture;
mod walk;

use corpuscle_checkpoint::{Resume, resume};
use corpuscle_core::{Failure, Invalid};
use corpuscle_observe::chart::{Axis, Scale, Series, Style};
use corpuscle_observe::{Chart, Check, Estimate};
use corpuscle_scene::Scene;

use crate::replicas::{Replicas, honesty};
use crate::{Action, Experiment, Frame, Honesty, Kind, Parameter, Settings, Simulation, Table, ensemble, peek};
use board::{Board, Landed, Set};
use walk::{Walk, binomial};

/// The registry's entry.
pub(crate) static EXPERIMENT: Experiment = Experiment {
    name: "galton",
    title: "Galton's board",
    summary: "Balls fall through pegs into bins: the bell of chance, from mechanics without any. How fair and how forgetful are pegs?",
    dimensions: &[2],
    engines: &["event-driven"],
    parameters: PARAMETERS,
    start,
};

static PARAMETERS: &[Parameter] = &[
    Parameter { name: "rows", unit: "", help: "Rows of pegs.", kind: Kind::Whole { default: 12, least: 2, most: 60 } },
    Parameter {
        name: "balls",
        unit: "",
        help: "Balls let go on each board, one after the other.",
        kind: Kind::Whole { default: 300, least: 10, most: 100_000 },
    },
    Parameter {
        name: "restitution",
        unit: "",
        help: "Part of the normal speed that a peg leaves. Lively balls forget; tired ones roll on.",
        kind: Kind::Real { default: 0.8, least: 0.2, most: 0.9 },
    },
    Parameter {
        name: "ball_radius",
        unit: "",
        help: "Radius of a ball, in distances of pegs.",
        kind: Kind::Real { default: 0.1, least: 0.01, most: 0.4 },
    },
    Parameter {
        name: "peg_radius",
        unit: "",
        help: "Radius of a peg, in distances of pegs.",
        kind: Kind::Real { default: 0.3, least: 0.01, most: 0.4 },
    },
    Parameter {
        name: "replicas",
        unit: "",
        help: "Independent boards; their scatter gives the error bars. The first is on show.",
        kind: Kind::Whole { default: 24, least: 3, most: 10_000 },
    },
];

/// Time between samples.
const SAMPLING: f64 = 4.0;
/// Rows over which deflections may know of each other.
const MEMORY: usize = 4;
/// Correlations told on the chart.
const LONGEST: usize = 8;
/// Balls from which on the boards are judged.
const ENOUGH: usize = 400;
/// Boards whose memory is known to be that short: lively balls that just pass between two pegs.
const LIVELY: f64 = 0.74;
const TIGHT: [f64; 2] = [0.39, 0.415];

fn start(settings: &Settings) -> Result<Box<dyn Simulation>, Invalid> {
    Ok(Box::new(Galton::new(settings)?))
}

/// The running experiment.
struct Galton {
    set: Set,
    end: f64,
    boards: Replicas<Board>,
}

resume!(Galton { values: [], parts: [boards], set_up: [set, end] });

impl Galton {
    fn new(settings: &Settings) -> Result<Self, Invalid> {
        let set = Set::new(settings)?;
        let streams: Vec<u64> = (0..settings.whole("replicas") as u64).collect();
        let members = ensemble::build(&streams, |&stream| Board::new(&set, stream))?;
        // Between two samples: whether the last one is taken does not hang on a rounding.
        let end = ((set.end() / SAMPLING).ceil() + 0.5) * SAMPLING;
        Ok(Self { end, boards: Replicas::new(SAMPLING, members), set })
    }

    /// Balls that were down at the last sample: of the board on show there may be more.
    fn balls<'a>(&self, board: &'a Board) -> &'a [Landed] {
        let landed = board.landed();
        &landed[..landed.partition_point(|ball| ball.time <= self.boards.sampled())]
    }

    /// Balls of all boards that were down at the last sample.
    fn down(&self) -> impl Iterator<Item = &Landed> {
        self.boards.members.iter().flat_map(|board| self.balls(board))
    }

    /// The mean of one number over the balls of each board that has some.
    fn mean(&self, number: impl Fn(&Landed) -> f64) -> Estimate {
        let of_board = |board: &Board| {
            let balls = self.balls(board);
            (!balls.is_empty()).then(|| balls.iter().map(&number).sum::<f64>() / balls.len() as f64)
        };
        Estimate::from_replicas(&self.boards.members.iter().filter_map(of_board).collect::<Vec<_>>())
    }

    /// Mean product of deflections `lag` rows apart.
    fn correlation(&self, lag: usize) -> Estimate {
        let pairs = self.set.rows.saturating_sub(lag);
        self.mean(|ball| {
            let product = |row: usize| f64::from(ball.deflection(row) * ball.deflection(row + lag));
            (1..=pairs).map(product).sum::<f64>() / pairs as f64
        })
    }

    /// The walk that remembers one deflection, as the boards count it.
    fn walk(&self) -> Option<Walk> {
        let rows = self.set.rows;
        let paths: Vec<Vec<i32>> = self.down().map(|ball| (1..=rows).map(|row| ball.deflection(row)).collect()).collect();
        Walk::counted(paths.iter().map(Vec::as_slice))
    }

    fn is_lively(&self) -> bool {
        let size = self.set.ball + self.set.peg;
        self.set.restitution >= LIVELY && (TIGHT[0]..=TIGHT[1]).contains(&size)
    }

    /// Gaps behind the last row, by halves from the middle, and the share of balls in each.
    fn bins(&self) -> Vec<(i32, Estimate)> {
        let rows = self.set.rows as i32;
        let reach = self.set.width() as i32 - 1;
        let gaps = (-reach..=reach).filter(|gap| (gap - rows) % 2 == 0);
        gaps.map(|gap| (gap, self.mean(|ball| f64::from(u8::from(ball.gap(self.set.rows) == gap))))).collect()
    }

    fn bin_chart(&self) -> Chart {
        let rows = self.set.rows;
        let bins = self.bins();
        let measured = bins.iter().map(|(gap, share)| (0.5 * f64::from(*gap), share.mean, share.standard_error));
        let fair = bins.iter().map(|&(gap, _)| (0.5 * f64::from(gap), binomial(rows, gap)));
        let mut chart = Chart::new(
            "bins",
            "Where the balls end",
            Axis::linear("bin, counted from the middle", ""),
            Axis::linear("share of the balls", ""),
        )
        .with(Series::with_errors("measured", Style::Bars, measured))
        .with(Series::new("binomial: fair and forgetful", Style::Theory, fair));
        if let Some(walk) = self.walk() {
            let ends = walk.ends();
            let place = |gap: i32| i32::midpoint(gap, 3 * rows as i32);
            let walk = bins.iter().filter_map(|&(gap, _)| Some((0.5 * f64::from(gap), *ends.get(place(gap) as usize)?)));
            chart = chart.with(Series::new("remembering one deflection", Style::Theory, walk));
        }
        chart.noting("No chance is at work but in how balls are let go.")
    }

    fn memory_chart(&self) -> Chart {
        let longest = LONGEST.min(self.set.rows - 1);
        let whole = self.correlation(0).mean;
        let measured = (0..=longest).map(|lag| {
            let correlation = self.correlation(lag);
            (lag as f64, correlation.mean / whole, correlation.standard_error / whole)
        });
        let last = self.correlation(1).mean / whole;
        Chart::new(
            "memory",
            "What a deflection knows of an earlier one",
            Axis::linear("rows apart", ""),
            Axis::linear("correlation", ""),
        )
        .with(Series::theory("independent", 1.0, longest as f64, 2, Scale::Linear, |_| 0.0))
        .with(Series::theory("remembering one deflection", 0.0, longest as f64, 60, Scale::Linear, |lag| {
            libm::pow(last.abs(), lag) * if last < 0.0 { libm::cos(std::f64::consts::PI * lag) } else { 1.0 }
        }))
        .with(Series::with_errors("measured", Style::Points, measured))
        .noting("Above zero a ball likes to go on the way it went: the heap is wider than the binomial. Below zero it is narrower.")
    }

    fn width_chart(&self) -> Chart {
        let rows = self.set.rows;
        let measured = (1..=rows).map(|row| {
            let variance = self.mean(|ball| 0.25 * f64::from(ball.gap(row) * ball.gap(row)));
            (row as f64, variance.mean, variance.standard_error)
        });
        Chart::new("width", "How the stream widens", Axis::linear("row", ""), Axis::linear("variance of the bin", ""))
            .with(Series::theory("binomial, a quarter a row", 0.0, rows as f64, 2, Scale::Linear, |row| 0.25 * row))
            .with(Series::with_errors("measured", Style::Points, measured))
            .noting("A straight line in the long run, as of any walk that forgets; its slope is a matter of memory and of leaps.")
    }
}

impl Simulation for Galton {
    fn state(&self) -> Option<&dyn Resume> {
        Some(self)
    }

    fn state_mut(&mut self) -> Option<&mut dyn Resume> {
        Some(self)
    }

    fn time(&self) -> f64 {
        self.boards.time()
    }

    fn end(&self) -> f64 {
        self.end
    }

    fn advance(&mut self, to: f64) -> Result<(), Failure> {
        self.boards.advance(to)
    }

    fn draw(&self, scene: &mut Scene) {
        picture::draw(&self.set, &self.boards.members[0], scene);
        scene.title = EXPERIMENT.title.into();
        let landed = self.boards.members[0].landed();
        let square = |ball: &Landed| 0.25 * f64::from(ball.gap(self.set.rows)).powi(2);
        let variance = landed.iter().map(square).sum::<f64>() / landed.len().max(1) as f64;
        scene.caption = match landed.len() {
            0..=9 => "line: what fair and forgetful pegs would make".into(),
            down => format!("{down} balls down: variance {variance:.2} (binomial {:.2})", 0.25 * self.set.rows as f64),
        };
    }

    fn frame(&self) -> Option<Frame> {
        Some(Frame::of_hard(&self.boards.members[0].engine, 0.0, &["balls"]))
    }

    fn charts(&self) -> Vec<Chart> {
        if self.boards.members.iter().filter(|board| !self.balls(board).is_empty()).count() < 2 {
            return vec![];
        }
        vec![self.bin_chart(), self.memory_chart(), self.width_chart()]
    }

    fn checks(&self) -> Vec<Check> {
        let mut checks = vec![];
        let rows = self.set.rows;
        if self.down().count() >= ENOUGH {
            let mean = self.mean(|ball| 0.5 * f64::from(ball.gap(rows)));
            checks.push(mean.check("mean bin, from the middle", 0.0, "left and right are the same board in a mirror"));
            let first = self.mean(|ball| f64::from(u8::from(ball.deflection(1) > 0)));
            checks.push(first.check("share of balls that the first peg turns to the right", 0.5, "the same"));
            if self.is_lively() && rows > MEMORY + 1 {
                let far = self.mean(|ball| {
                    let products = (1..=rows).flat_map(|row| {
                        (row + MEMORY + 1..=rows).map(move |later| f64::from(ball.deflection(row) * ball.deflection(later)))
                    });
                    products.sum()
                });
                let reference = "mixing: so far apart they are independent (Taylor 1921, doi:10.1112/plms/s2-20.1.196)";
                checks.push(far.check("sum of correlations of deflections more than four rows apart", 0.0, reference));
            }
        }
        if self.boards.sampled() > self.end - SAMPLING {
            let missing: usize = self.boards.members.iter().map(Board::missing).sum();
            checks.push(Check::at_most("balls not down at the end", missing as f64, 0.0, "all but those that rest on a peg fall"));
        }
        let imbalance = self.boards.members.iter().map(Board::imbalance).fold(0.0, f64::max);
        let reference = "height, speed and what contacts took, of each ball: rounding";
        checks.push(Check::at_most("relative error of the energy balance", imbalance, 1e-11, reference));
        checks
    }

    fn honesty(&self) -> Honesty {
        honesty(self.boards.members.iter().map(|board| (&board.engine, None)))
    }

    fn tables(&self) -> Vec<Table> {
        let row = |(gap, share): (i32, Estimate)| {
            vec![0.5 * f64::from(gap), share.mean, share.standard_error, binomial(self.set.rows, gap)]
        };
        vec![Table {
            name: "bins".into(),
            columns: ["bin", "share", "share_error", "binomial"].map(String::from).to_vec(),
            rows: self.bins().into_iter().map(row).collect(),
        }]
    }

    fn moments(&self) -> Vec<f64> {
        vec![0.1 * self.end, 0.4 * self.end]
    }

    fn next_event(&self) -> Option<f64> {
        peek::next_contact(&self.boards.members[0].engine, 1.5 * self.end)
    }

    fn refusal(&self, _: Action) -> Option<&'static str> {
        Some("a board whose balls nobody counts: each of these is one draw of the chance that is measured")
    }
}
